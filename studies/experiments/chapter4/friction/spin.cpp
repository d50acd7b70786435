// SPDX-License-Identifier: GPL-3.0-or-later
/// Bodies spinning on a plane about the contact normal (Fang 2022, Secs. 4.4.5, 4.4.6.2). Fig. 4.15:
/// empirical spinning resistance. Fig. 4.16: spinning resistance of a Hertzian contact patch. Fig. 4.18:
/// upright and flat ellipsoid, and Table 4.7.
///
/// Closed form: with the kinetic torque M_k, a body with moment of inertia I stops at t = omega_0 I / M_k.

#include "studies/experiments/chapter4/friction/experiment.hpp"

#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"
#include "dae/model.hpp"

#include <fmt/format.h>

#include <numbers>

namespace hilda::studies::friction {

namespace {

constexpr double omega_0 = 1, mu_s = 0.25, mu_k = 0.2, g = 9.8, h = 1e-4, pi = std::numbers::pi;

/// A body on the plane, with its centre at `height` [m]
struct Spinner {
    contact::Inertia inertia = {};
    contact::Shape shape;
    double height = 0;
    lie::Mat3 A = lie::Mat3::Identity();
    double I = 0;  ///< moment of inertia about the vertical axis [kg m²]
};

Series spin(const Spinner& body, const contact::FrictionParameters& p, double end, Frames* frames)
{
    contact::Scene scene;
    scene.gravity = {0, 0, -g};
    contact::Motion start = at({0, 0, body.height});
    start.A = body.A;
    start.omega_bar = body.A.transpose() * lie::Vec3(0, 0, omega_0);
    const int b = scene.add(body.inertia, start), plane = scene.add(contact::Inertia{}, {});
    scene.add("spinner", b, body.shape, plane, shape<contact::Plane>(),
              std::make_shared<contact::GivenForce>(body.inertia.m * g), law(p));
    // No scene.check(h): for K_E >= 1e7 N/m the step is above the stability limit of the sliding springs, but
    // the sliding springs are not excited here.
    double angle = 0;
    return sample(scene, h, end, frames, {"t", "omega", "Psi", "T", "T_E", "angle", "slips"},
                  [&](Series& s, const std::vector<contact::Motion>& bodies) {
                      const contact::Scene::Pair& pair = scene.pair[0];
                      const double omega = (bodies[b].A * bodies[b].omega_bar).z();
                      if (s.rows() > 0) angle += h * omega;
                      s.add({scene.t, omega, pair.history.deflections.Psi, pair.wrench.T_spin,
                             pair.wrench.T_spin_E, angle, pair.history.deflections.spin.slipping ? 1. : 0.});
                  });
}

/// Time of the first zero of omega [s], by linear interpolation. Afterwards the spring causes a small reverse
/// rotation.
double first_stop(const Series& s)
{
    for (size_t k = 1; k < s.rows(); ++k)
        if (s.at(k, "omega") <= 0) {
            const double a = s.at(k - 1, "omega"), b = s.at(k, "omega");
            return s.at(k - 1, 0) + (s.at(k, 0) - s.at(k - 1, 0)) * a / (a - b);
        }
    return std::nan("");
}

/// K_E as text in the format of the columns of published tables, for example 5e6
std::string exponent_text(double K_E)
{
    const int exponent = static_cast<int>(std::floor(std::log10(K_E) + 1e-9));
    return fmt::format("{:.0f}e{}", K_E / std::pow(10, exponent), exponent);
}

// Fig. 4.15

const std::vector<double> etas = {0.012, 0.010, 0.008, 0.006};

Spinner big_sphere()
{
    const double m = 5, R = 0.2;
    return {
        .inertia = solid_sphere(m, R), .shape = shape<contact::Sphere>(R), .height = R, .I = 0.4 * m * R * R};
}

std::vector<ExperimentRun> empirical()
{
    std::vector<ExperimentRun> all;
    for (const std::string& name : presets)
        for (const double eta : etas)
            all.push_back({.name = fmt::format("{}-eta{:.3f}", name, eta), .compute = [=](Frames* frames) {
                               return spin(
                                   big_sphere(),
                                   preset(name, {.mu_s = mu_s, .mu_k = mu_k, .K_E = 1e5, .eta_psi = eta}), 8,
                                   frames);
                           }});
    return all;
}

void check_empirical(const Results& results, std::vector<Check>& out)
{
    const Spinner ball = big_sphere();
    const double published[] = {3.3029, 3.9736, 4.9811, 6.6628};
    for (size_t k = 0; k < etas.size(); ++k) {
        const double M = etas[k] * 0.2 * mu_k * ball.inertia.m * g, stop = omega_0 * ball.I / M;
        if (const Series* s = results.find(fmt::format("balanced-eta{:.3f}", etas[k]))) {
            out.push_back({fmt::format("stop time, eta_psi {:.3f}, balanced [s]", etas[k]), first_stop(*s),
                           stop, 2e-4, "rigid"});
            out.push_back({fmt::format("angle, eta_psi {:.3f}, balanced [rad]", etas[k]), s->last("angle"),
                           0.5 * stop, 2e-3 * stop, "rigid"});
        }
        if (const Series* s = results.find(fmt::format("dissertation-eta{:.3f}", etas[k])))
            out.push_back({fmt::format("stop time, eta_psi {:.3f}, dissertation [s]", etas[k]),
                           first_stop(*s), published[k], 1e-4, "independent code"});
    }
}

const bool spinning = register_experiment({.name = "spin",
                                           .figure = "4.15",
                                           .what = "spinning sphere, empirical spinning resistance",
                                           .runs = empirical,
                                           .checks = check_empirical,
                                           .has_frames = true});

// Fig. 4.16

struct BallMaterial {
    const char* name;
    double R, rho, E, nu, stop;
};
const std::vector<BallMaterial> balls = {{"steel-20mm", 0.02, 8e3, 2e11, 0.3, 2.776},
                                         {"steel-40mm", 0.04, 8e3, 2e11, 0.3, 4.308},
                                         {"glass-20mm", 0.02, 2.5e3, 5e10, 0.2, 2.582}};

Spinner ball_of(const BallMaterial& material)
{
    const double m = 4. / 3 * pi * material.R * material.R * material.R * material.rho;
    return {.inertia = solid_sphere(m, material.R),
            .shape = shape<contact::Sphere>(material.R),
            .height = material.R,
            .I = 0.4 * m * material.R * material.R};
}

/// Hertzian contact with a rigid plane, as in the published runs
contact::FrictionParameters hertzian(const std::string& preset_name, double E, double nu, double K_E)
{
    return preset(preset_name, {.mu_s = mu_s, .mu_k = mu_k, .K_E = K_E, .E_star = E / (1 - nu * nu)});
}

std::vector<ExperimentRun> hertz()
{
    std::vector<ExperimentRun> all;
    for (const std::string& name : presets)
        for (const BallMaterial& material : balls)
            for (const double K_E : {5e5, 1e6, 5e6, 1e7})
                all.push_back({.name = fmt::format("{}-{}-KE{}", name, material.name, exponent_text(K_E)),
                               .compute = [=](Frames* frames) {
                                   return spin(ball_of(material),
                                               hertzian(name, material.E, material.nu, K_E), 6, frames);
                               }});
    return all;
}

void check_hertz(const Results& results, std::vector<Check>& out)
{
    const double rigid[] = {2.89531, 4.59602, 2.64027};
    for (size_t k = 0; k < balls.size(); ++k) {
        if (const Series* s = results.find(fmt::format("balanced-{}-KE1e7", balls[k].name)))
            out.push_back({fmt::format("stop time, {}, balanced [s]", balls[k].name), first_stop(*s),
                           rigid[k], 1e-3, "rigid"});
        if (const Series* s = results.find(fmt::format("dissertation-{}-KE1e7", balls[k].name)))
            out.push_back({fmt::format("stop time, {}, dissertation [s]", balls[k].name), first_stop(*s),
                           balls[k].stop, 1e-3, "independent code"});
    }
}

const bool spinning_hertz =
    register_experiment({.name = "spin-hertz",
                         .figure = "4.16",
                         .what = "spinning steel and glass balls, Hertzian contact patch",
                         .runs = hertz,
                         .checks = check_hertz});

// Fig. 4.18, Table 4.7

constexpr double a = 0.02, c = 0.05, steel_m = 4. / 3 * pi * a * a * c * 8e3;
// The published figure uses the moment of inertia of a sphere of radius a, 0.4 · 0.268 kg · a², instead of
// that of the ellipsoid.
constexpr double published_I = 0.4 * (4. / 3 * pi * a * a * a * 8e3) * a * a;

Spinner ellipsoid(bool upright, bool published)
{
    Spinner e{.shape = shape<contact::Ellipsoid>(lie::Vec3(a, a, c)), .height = upright ? c : a, .I = 0};
    const double I_c = 0.4 * steel_m * a * a, I_a = 0.2 * steel_m * (a * a + c * c);
    e.inertia = {steel_m, published ? lie::Mat3(published_I * lie::Mat3::Identity())
                                    : lie::Mat3(lie::Vec3(I_a, I_a, I_c).asDiagonal())};
    if (!upright) e.A = lie::exp(lie::Vec3(pi / 2, 0, 0));
    e.I = published ? published_I : upright ? I_c : I_a;
    return e;
}

std::vector<ExperimentRun> ellipsoids()
{
    std::vector<ExperimentRun> all;
    for (const bool published : {false, true})
        for (const bool upright : {true, false})
            for (const double K_E : {5e6, 1e7, 5e7, 1e8}) {
                const std::string preset_name = published ? "dissertation" : "balanced";
                all.push_back({.name = fmt::format("{}-{}-KE{}", preset_name, upright ? "upright" : "flat",
                                                   exponent_text(K_E)),
                               .compute = [=](Frames* frames) {
                                   return spin(ellipsoid(upright, published),
                                               hertzian(preset_name, 2e11, 0.3, K_E),
                                               published ? 2
                                               : upright ? 4
                                                         : 8,
                                               frames);
                               }});
            }
    return all;
}

void check_ellipsoids(const Results& results, std::vector<Check>& out)
{
    for (const auto& [pose, stop] : {std::pair("upright", 2.8953), std::pair("flat", 6.4491)})
        if (const Series* s = results.find(fmt::format("balanced-{}-KE1e8", pose)))
            out.push_back({fmt::format("stop time, {}, true inertia [s]", pose), first_stop(*s), stop,
                           0.02 * stop, "rigid"});
    // Table 4.7 at K_E = 5e6: curvature, stiffness, static micro-deflection, static torque
    struct TableRow {
        const char* body;
        double kappa;               // mean curvature at the contact point [1/m]
        double K, K_psi, S_s, T_s;  // published
    };
    const double K_E = 5e6, N = steel_m * g;
    const contact::Ellipsoid surface(lie::Vec3(a, a, c));
    const double sphere_R = std::cbrt(a * a * c);
    for (const TableRow& row :
         {TableRow{"sphere", 1 / sphere_R, 36.84, 1.795e-2, 3.876e-3, 6.957e-5},
          TableRow{"flat", surface.mean_curvature({a, 0, 0}), 29, 2.10546e-2, 3.5785e-3, 7.53438e-5},
          TableRow{"upright", surface.mean_curvature({0, 0, c}), 125, 7.94947e-3, 5.82379e-3, 4.6296e-5}}) {
        const double kappa = row.kappa;
        contact::ContactState now;
        now.contact_point.n = now.slip.n = lie::Vec3::UnitZ();
        now.slip.u = lie::Vec3::UnitX();
        now.contact_point.K_i = lie::Vec3(kappa, kappa, 0).asDiagonal();
        now.contact_point.K_j.setZero();
        now.N = N;
        now.I_spin = 1;
        const auto model = law(hertzian("balanced", 2e11, 0.3, K_E));
        const double K_psi = model->springs(now).K_spin;
        contact::Deflections history;
        now.slip.ds = now.slip.q_i = now.slip.q_j = now.slip.p_i = now.slip.p_j = lie::Vec3::Zero();
        now.slip.psi = 1;  // far above the static bound
        model->advance(now, history);
        const auto check = [&](const char* what, double measured, double required) {
            out.push_back({fmt::format("Table 4.7, {}: {}", row.body, what), measured, required,
                           5e-4 * required, "published table"});
        };
        check("K [1/m]", kappa, row.K);
        check("K_psi [N m/rad]", K_psi, row.K_psi);
        check("S_psi, static [rad]", history.Psi, row.S_s);
        check("torque, static [N m]", K_psi * history.Psi, row.T_s);
    }
}

const bool spinning_ellipsoid =
    register_experiment({.name = "spin-ellipsoid",
                         .figure = "4.18",
                         .what = "spinning steel ellipsoid, upright and flat; Table 4.7",
                         .runs = ellipsoids,
                         .checks = check_ellipsoids,
                         .has_frames = true});

}  // namespace

}  // namespace hilda::studies::friction
