// SPDX-License-Identifier: GPL-3.0-or-later
/// Bodies spinning on a plane about the contact normal (Fang 2022, Secs. 4.4.5, 4.4.6.2). Fig. 4.15:
/// empirical spinning resistance. Fig. 4.16: spinning resistance of a Hertzian contact patch. Fig. 4.18:
/// upright and flat ellipsoid, and Table 4.7.
///
/// Closed form: with the kinetic torque M_k, a body with moment of inertia I stops at t = omega_0 I / M_k.

#include "studies/experiments/chapter4/friction/experiment.hpp"

#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/sphere.hpp"
#include "dae/model.hpp"

#include <fmt/format.h>

#include <numbers>

namespace hilda::studies::friction::spin_runs {

namespace {

constexpr double omega_0 = 1, mu_s = 0.25, mu_k = 0.2, g = 9.8, h = 1e-4, pi = std::numbers::pi;

/// A body on the plane, with its centre at `height` [m]
struct Spinner {
    contact::Inertia inertia = {};
    contact::Shape shape;
    double height = 0;
    lie::Mat3 A = lie::Mat3::Identity();
};

BodyOnPlane spin(const Spinner& body, const contact::FrictionParameters& p, double end)
{
    contact::Motion start = at({0, 0, body.height});
    start.A = body.A;
    start.omega_bar = body.A.transpose() * lie::Vec3(0, 0, omega_0);
    return {
        .name = "spinner",
        .inertia = body.inertia,
        .start = start,
        .shape = body.shape,
        .normal = given_force(body.inertia.m * g),
        .friction = p,
        .h = h,
        .end = end,
        // For K_E >= 1e7 N/m the step is above the stability limit of the sliding springs, but the sliding
        // springs are not excited here.
        .above_stability_limit = true,
        .columns = {"t", "omega", "Psi", "T", "T_E", "angle", "slips"},
        .record = [angle = 0.](Curve& c, const Node& n) mutable {
            const double omega = n.omega.z();
            if (c.rows() > 0) angle += h * omega;
            c.add({n.scene.t, omega, n.springs.Psi, n.wrench.T_spin, n.wrench.T_spin_E, angle,
                   n.springs.spin.slipping ? 1. : 0.});
        }};
}

/// Time of the first zero of omega [s]. Afterwards the spring causes a small reverse rotation.
double stop_time(const Curve& c)
{
    const std::vector<double> zeros = c.zero_crossings("omega");
    return zeros.empty() ? std::nan("") : zeros.front();
}

/// K_E as text in the format of the columns of published tables, for example 5e6
std::string exponent_text(double K_E)
{
    const int exponent = static_cast<int>(std::floor(std::log10(K_E) + 1e-9));
    return fmt::format("{:.0f}e{}", K_E / std::pow(10, exponent), exponent);
}

// Fig. 4.15

const std::vector<double> etas = {0.012, 0.010, 0.008, 0.006};

Spinner homogeneous_sphere(double m, double R)
{
    return {.inertia = solid_sphere(m, R), .shape = shape<contact::Sphere>(R), .height = R};
}

std::vector<ExperimentRun> empirical()
{
    std::vector<ExperimentRun> all;
    for (const std::string& name : presets)
        for (const double eta : etas)
            all.push_back({fmt::format("{}-eta{:.3f}", name, eta), [=] {
                               return spin(
                                   homogeneous_sphere(5, 0.2),
                                   preset(name, {.mu_s = mu_s, .mu_k = mu_k, .K_E = 1e5, .eta_psi = eta}), 8);
                           }});
    all[etas.size() - 1].snapshots = {0, 2, 4, 8};  // Fig. 4.14: eta_psi = 0.006, preset dissertation
    return all;
}

std::vector<Expected> expected_empirical()
{
    std::vector<Expected> all;
    const double m = 5, R = 0.2, published[] = {3.3029, 3.9736, 4.9811, 6.6628};
    for (size_t k = 0; k < etas.size(); ++k) {
        const std::string eta = fmt::format("{:.3f}", etas[k]), balanced = "balanced-eta" + eta;
        const double M = etas[k] * 0.2 * mu_k * m * g, stop = omega_0 * (0.4 * m * R * R) / M;
        all.push_back(
            {balanced, "stop time, eta_psi " + eta + ", balanced [s]", stop_time, stop, 2e-4, "rigid"});
        all.push_back({balanced, "angle, eta_psi " + eta + ", balanced [rad]", last("angle"), 0.5 * stop,
                       2e-3 * stop, "rigid"});
        all.push_back({"dissertation-eta" + eta, "stop time, eta_psi " + eta + ", dissertation [s]",
                       stop_time, published[k], 1e-4, "independent code"});
    }
    return all;
}

const bool spinning = register_experiment({.name = "spin",
                                           .figure = "4.15",
                                           .what = "spinning sphere, empirical spinning resistance",
                                           .runs = empirical(),
                                           .expected = expected_empirical(),
                                           .has_frames = true});

// Fig. 4.16

/// Balls with their stop times [s]: that of an independent code with the preset `dissertation`, and the rigid
/// one
struct Ball {
    std::string name;
    double R, rho, E, nu, published, rigid;
};
const std::vector<Ball> balls = {{"steel-20mm", 0.02, 8e3, 2e11, 0.3, 2.776, 2.89531},
                                 {"steel-40mm", 0.04, 8e3, 2e11, 0.3, 4.308, 4.59602},
                                 {"glass-20mm", 0.02, 2.5e3, 5e10, 0.2, 2.582, 2.64027}};

/// Hertzian contact with a rigid plane, as in the published runs
contact::FrictionParameters hertzian(const std::string& preset_name, double E, double nu, double K_E)
{
    return preset(preset_name, {.mu_s = mu_s, .mu_k = mu_k, .K_E = K_E, .E_star = E / (1 - nu * nu)});
}

std::vector<ExperimentRun> hertz()
{
    std::vector<ExperimentRun> all;
    for (const std::string& name : presets)
        for (const Ball& ball : balls)
            for (const double K_E : {5e5, 1e6, 5e6, 1e7})
                all.push_back({fmt::format("{}-{}-KE{}", name, ball.name, exponent_text(K_E)), [=] {
                                   const double m = 4. / 3 * pi * ball.R * ball.R * ball.R * ball.rho;
                                   return spin(homogeneous_sphere(m, ball.R),
                                               hertzian(name, ball.E, ball.nu, K_E), 6);
                               }});
    return all;
}

std::vector<Expected> expected_hertz()
{
    std::vector<Expected> all;
    for (const Ball& ball : balls) {
        all.push_back({"balanced-" + ball.name + "-KE1e7", "stop time, " + ball.name + ", balanced [s]",
                       stop_time, ball.rigid, 1e-3, "rigid"});
        all.push_back({"dissertation-" + ball.name + "-KE1e7",
                       "stop time, " + ball.name + ", dissertation [s]", stop_time, ball.published, 1e-3,
                       "independent code"});
    }
    return all;
}

const bool spinning_hertz =
    register_experiment({.name = "spin-hertz",
                         .figure = "4.16",
                         .what = "spinning steel and glass balls, Hertzian contact patch",
                         .runs = hertz(),
                         .expected = expected_hertz()});

// Fig. 4.18, Table 4.7

constexpr double a = 0.02, c = 0.05, steel_m = 4. / 3 * pi * a * a * c * 8e3;
// The published figure uses the moment of inertia of a sphere of radius a, 0.4 · 0.268 kg · a², instead of
// that of the ellipsoid.
constexpr double published_I = 0.4 * (4. / 3 * pi * a * a * a * 8e3) * a * a;

Spinner ellipsoid(bool upright, bool published)
{
    const double I_c = 0.4 * steel_m * a * a, I_a = 0.2 * steel_m * (a * a + c * c);
    Spinner e{.inertia = {steel_m, published ? lie::Mat3(published_I * lie::Mat3::Identity())
                                             : lie::Mat3(lie::Vec3(I_a, I_a, I_c).asDiagonal())},
              .shape = shape<contact::Ellipsoid>(lie::Vec3(a, a, c)),
              .height = upright ? c : a};
    if (!upright) e.A = lie::exp(lie::Vec3(pi / 2, 0, 0));
    return e;
}

std::vector<ExperimentRun> ellipsoids()
{
    std::vector<ExperimentRun> all;
    for (const std::string& name : {presets[1], presets[0]})
        for (const bool upright : {true, false})
            for (const double K_E : {5e6, 1e7, 5e7, 1e8}) {
                const bool published = name == "dissertation";
                const double end = published ? 2 : upright ? 4 : 8;
                all.push_back(
                    {fmt::format("{}-{}-KE{}", name, upright ? "upright" : "flat", exponent_text(K_E)), [=] {
                         return spin(ellipsoid(upright, published), hertzian(name, 2e11, 0.3, K_E), end);
                     }});
            }
    return all;
}

/// Spinning resistance of the steel ellipsoid at K_E = 5e6 N/m on a contact point with the mean curvature
/// kappa [1/m]: stiffness [N m/rad] and micro-deflection at the static bound [rad]
///     Table 4.7
struct SpinSpring {
    double K = 0, S = 0;
};
SpinSpring spin_spring(double kappa)
{
    contact::ContactState now;
    now.contact_point.n = now.slip.n = lie::Vec3::UnitZ();
    now.slip.u = lie::Vec3::UnitX();
    now.contact_point.K_i = lie::Vec3(kappa, kappa, 0).asDiagonal();
    now.contact_point.K_j.setZero();
    now.N = steel_m * g;
    now.I_spin = 1;
    const auto model = contact::friction_law("slide-roll-spin").make(hertzian("balanced", 2e11, 0.3, 5e6));
    const double K = model->springs(now).K_spin;
    contact::Deflections springs;
    now.slip.ds = now.slip.q_i = now.slip.q_j = now.slip.p_i = now.slip.p_j = lie::Vec3::Zero();
    now.slip.psi = 1;  // far above the static bound
    model->advance(now, springs);
    return {K, springs.Psi};
}

std::vector<Expected> expected_ellipsoids()
{
    std::vector<Expected> all;
    for (const auto& [pose, stop] : {std::pair<std::string, double>("upright", 2.8953), {"flat", 6.4491}})
        all.push_back({"balanced-" + pose + "-KE1e8", "stop time, " + pose + ", true inertia [s]", stop_time,
                       stop, 0.02 * stop, "rigid"});
    struct TableRow {
        std::string body;
        double kappa;               // mean curvature at the contact point [1/m]
        double K, K_psi, S_s, T_s;  // published
    };
    const contact::Ellipsoid surface(lie::Vec3(a, a, c));
    for (const auto& [body, kappa, K, K_psi, S_s, T_s] :
         {TableRow{"sphere", 1 / std::cbrt(a * a * c), 36.84, 1.795e-2, 3.876e-3, 6.957e-5},
          TableRow{"flat", surface.mean_curvature({a, 0, 0}), 29, 2.10546e-2, 3.5785e-3, 7.53438e-5},
          TableRow{"upright", surface.mean_curvature({0, 0, c}), 125, 7.94947e-3, 5.82379e-3, 4.6296e-5}}) {
        const auto expect = [&, of = "Table 4.7, " + body + ": "](const std::string& what, double required,
                                                                  const Measure& measure) {
            all.push_back({"", of + what, measure, required, 5e-4 * required, "published table"});
        };
        const double k = kappa;
        expect("K [1/m]", K, [=](const Curve&) { return k; });
        expect("K_psi [N m/rad]", K_psi, [=](const Curve&) { return spin_spring(k).K; });
        expect("S_psi, static [rad]", S_s, [=](const Curve&) { return spin_spring(k).S; });
        expect("torque, static [N m]", T_s,
               [=](const Curve&) { return spin_spring(k).K * spin_spring(k).S; });
    }
    return all;
}

const bool spinning_ellipsoid =
    register_experiment({.name = "spin-ellipsoid",
                         .figure = "4.18",
                         .what = "spinning steel ellipsoid, upright and flat; Table 4.7",
                         .runs = ellipsoids(),
                         .expected = expected_ellipsoids(),
                         .has_frames = true});

}  // namespace

}  // namespace hilda::studies::friction::spin_runs
