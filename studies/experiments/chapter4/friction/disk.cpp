// SPDX-License-Identifier: GPL-3.0-or-later
/// Disk on a plane (Fang 2022, Sec. 4.4.3). The disk starts with a velocity and without rotation; it slips,
/// then rolls, then stops.
///
/// Fig. 4.9 consists of two published runs. Displacement, rotation and springs are from a run with 1.5 times
/// the critical rolling damping; velocities and dashpots are from a run whose springs are saturated at the
/// start. Fig. 4.10: other damping ratios. Fig. 4.11: rolling torques without history. The closed form of a
/// rigid disk with kinetic friction has slip until t_1 and then rolls with constant deceleration until t_2.

#include "studies/experiments/chapter4/friction/experiment.hpp"

#include "contact/surfaces/disk.hpp"
#include "contact/surfaces/plane.hpp"

#include <numbers>

namespace hilda::studies::friction {

namespace {

constexpr double m = 5, R = 0.2, I = 0.1, mu_s = 0.25, mu_k = 0.2, g = 9.8, N = m * g, v_0 = 0.5, eta_r = 0.1;
const double K_R = 4 * eta_r * 1e5 * R * R, D_critical = 2 * std::sqrt(I * K_R);

struct DiskSetup {
    contact::FrictionParameters p = {};
    std::string law = "slide-roll-spin";
    bool saturated = false;
    double h = 1e-4, end = 1.5;
};

contact::FrictionParameters parameters(const std::string& preset_name, double K_E = 1e5)
{
    return preset(preset_name, {.mu_s = mu_s, .mu_k = mu_k, .K_E = K_E, .eta_r = eta_r});
}

Series roll(const DiskSetup& setup, Frames* frames)
{
    contact::Scene scene;
    scene.gravity = {0, 0, -g};
    contact::Motion start = at({0, 0, R}, {v_0, 0, 0});
    start.A = lie::exp(lie::Vec3(std::numbers::pi / 2, 0, 0));  // axis along -y
    const int disk = scene.add({m, I * lie::Mat3::Identity()}, start),
              plane = scene.add(contact::Inertia{}, {});
    scene.add("disk", disk, shape<contact::Disk>(R), plane, shape<contact::Plane>(),
              std::make_shared<contact::GivenForce>(N), law(setup.p, setup.law));
    scene.check(setup.h);
    bool saturation_set = false;
    double theta = 0, v = v_0, omega = 0;  // values at the previous node
    return sample(scene, setup.h, setup.end, frames,
                  {"t", "x", "theta", "v", "omega", "a", "alpha", "F_E", "F_D", "T_E", "T_D", "S_mm",
                   "Theta_e-3rad", "slips", "rolls"},
                  [&](Series& s, const std::vector<contact::Motion>& body) {
                      contact::Scene::Pair& pair = scene.pair[0];
                      if (setup.saturated && !saturation_set) {
                          // springs slightly above their kinetic bounds before the first step
                          const lie::Vec3 &n = pair.contact_state.slip.n, &u = pair.contact_state.slip.u;
                          contact::Deflections& history = pair.history.deflections;
                          const double S = (1 + 1e-9) * mu_k * N / setup.p.K_E;
                          history.S = contact::components({-S, 0, 0}, n, u);
                          history.Theta_i = contact::components({S / (2 * R), 0, 0}, n, u);
                          history.slide = history.roll_i = {.slipping = true, .damped = false};
                      }
                      saturation_set = true;
                      const contact::Motion& b = body[disk];
                      const lie::Vec3 omega_now = b.A * b.omega_bar;
                      const contact::Wrench& w = pair.wrench;
                      const contact::Deflections& history = pair.history.deflections;
                      const contact::SlidingDisplacement& frame = pair.contact_state.slip;
                      const auto along_x = [&](const contact::Vec2& of) {
                          return contact::tangent(of, frame.n, frame.u).x();
                      };
                      const double F_E = -w.F_E.x(), T_E = -w.T_roll_E.y();
                      theta += setup.h * omega_now.y();
                      s.add({scene.t, b.r.x(), theta, b.rdot.x(), omega_now.y(), (b.rdot.x() - v) / setup.h,
                             (omega_now.y() - omega) / setup.h, F_E, -w.F.x() - F_E, T_E, -w.T_i.y() - T_E,
                             -1e3 * along_x(history.S), 1e3 * along_x(history.Theta_i),
                             history.slide.slipping ? 1. : 0., history.roll_i.slipping ? 0. : 1.});
                      v = b.rdot.x(), omega = omega_now.y();
                  });
}

DiskSetup published_setup()
{
    DiskSetup setup{.p = parameters("dissertation")};
    setup.p.D_roll = 1.5 * D_critical;
    return setup;
}

std::vector<ExperimentRun> runs()
{
    return {
        {.name = "dissertation", .compute = [](Frames* frames) { return roll(published_setup(), frames); }},
        {.name = "saturated",
         .compute =
             [](Frames* frames) {
                 return roll({.p = parameters("dissertation"), .saturated = true}, frames);
             }},
        {.name = "balanced",
         .compute = [](Frames* frames) { return roll({.p = parameters("balanced"), .end = 3}, frames); }},
        {.name = "stiff",
         .compute =
             [](Frames* frames) {
                 return roll({.p = parameters("balanced", 1e6), .h = 2e-5, .end = 2}, frames);
             },
         .check_only = true}};
}

/// Closed form: rigid disk with kinetic friction
struct RigidDisk {
    // slip: v = v_0 - mu_k g t, omega = (mu_k N R - M) t / I until v = R omega; then both decelerate by M
    double M = 2 * eta_r * R * mu_k * N;
    double alpha = (mu_k * N * R - M) / I;
    double t_1 = v_0 / (mu_k * g + R * alpha), v_1 = v_0 - mu_k * g * t_1;
    double a = M * R / (I + m * R * R);
    double t_2 = t_1 + v_1 / a;
    double x_1 = v_0 * t_1 - 0.5 * mu_k * g * t_1 * t_1, x_2 = x_1 + 0.5 * v_1 * v_1 / a;
    double theta_2 = 0.5 * alpha * t_1 * t_1 + 0.5 * v_1 * v_1 / (a * R);
};

/// Time of the end of slip and of the end of rolling [s]
std::pair<double, double> instants(const Series& s)
{
    const double slip = s.first_time([&](size_t k) { return s.at(k, "slips") == 0; }, 0.01);
    // end of kinetic rolling friction; afterwards the rolling spring oscillates about its rest position
    const auto speed = s.all("omega");
    size_t k = 0;
    while (k + 1 < speed.size() && (s.at(k, 0) < 0.5 || s.at(k, "rolls") == 0)) ++k;
    return {slip, s.at(k, 0)};
}

void checks(const Results& results, std::vector<Check>& out)
{
    const RigidDisk rigid_disk;
    if (const Series* s = results.find("dissertation")) {
        out.push_back({"x at 1.5 s, dissertation [m]", s->last("x"), 0.2093106, 5e-8, "published run"});
        out.push_back(
            {"theta at 1.5 s, dissertation [rad]", s->last("theta"), 0.9512334, 5e-8, "published run"});
    }
    for (const auto& [name, part_1, part] :
         {std::tuple("balanced", 5e-3, 1.), std::tuple("stiff", 1e-3, 0.)}) {
        const Series* s = results.find(name);
        if (s == nullptr) continue;
        const std::string suffix = std::string(", ") + name;
        const auto [slip, stop] = instants(*s);
        const double rest = part > 0 ? 3e-3 : 1e-3;
        out.push_back(
            {"end of slip" + suffix + " [s]", slip, rigid_disk.t_1, part_1 * rigid_disk.t_1, "rigid"});
        out.push_back({"stop time" + suffix + " [s]", stop, rigid_disk.t_2, 1e-3 * rigid_disk.t_2, "rigid"});
        out.push_back(
            {"x at rest" + suffix + " [m]", s->last("x"), rigid_disk.x_2, rest * rigid_disk.x_2, "rigid"});
        out.push_back({"theta at rest" + suffix + " [rad]", s->last("theta"), rigid_disk.theta_2,
                       rest * rigid_disk.theta_2, "rigid"});
    }
    if (const Series* s = results.find("balanced")) {
        double largest = 0;
        for (size_t k = 0; k < s->rows(); ++k)
            if (s->at(k, 0) > 2.5) largest = std::max(largest, std::abs(s->at(k, "omega")));
        out.push_back({"largest |omega| after 2.5 s, balanced [rad/s]", largest, 0, 1e-8, "comes to rest"});
    }
}

const bool disk = register_experiment({.name = "disk",
                                       .figure = "4.9",
                                       .what = "disk started without rotation: slip, rolling, rest",
                                       .runs = runs,
                                       .checks = checks,
                                       .has_frames = true});

std::vector<ExperimentRun> dampings()
{
    std::vector<ExperimentRun> all;
    for (const double part : {0.5, 1., 1.5, 2.})
        for (const std::string& name : presets) {
            DiskSetup setup{.p = parameters(name)};
            setup.p.D_roll = part * D_critical;
            setup.p.D_slide = part * 2 * std::sqrt(m * setup.p.K_E);
            all.push_back({.name = name + (part == 0.5   ? "-0.5"
                                           : part == 1   ? "-1"
                                           : part == 1.5 ? "-1.5"
                                                         : "-2"),
                           .compute = [setup](Frames* frames) { return roll(setup, frames); }});
        }
    return all;
}

void no_checks(const Results&, std::vector<Check>&) {}

const bool disk_damping =
    register_experiment({.name = "disk-damping",
                         .figure = "4.10",
                         .what = "disk coming to rest with 0.5, 1, 1.5 and 2 times the critical damping",
                         .runs = dampings,
                         .checks = no_checks});

std::vector<ExperimentRun> rolling_laws()
{
    std::vector<ExperimentRun> all;
    for (const std::string law : {"slide-roll-spin", "constant-torque", "epsd"}) {
        DiskSetup setup{.p = parameters("balanced"), .law = law, .end = 2};
        if (law != "slide-roll-spin") setup.p.mu_r = 2 * eta_r * mu_k;  // the same torque during rolling
        all.push_back({.name = law, .compute = [setup](Frames* frames) { return roll(setup, frames); }});
    }
    return all;
}

/// Largest absolute value of a column in the last 0.2 s
double largest_at_end(const Series& s, const std::string& column)
{
    double largest = 0;
    for (size_t k = 0; k < s.rows(); ++k)
        if (s.at(k, 0) > s.at(s.rows() - 1, 0) - 0.2) largest = std::max(largest, std::abs(s.at(k, column)));
    return largest;
}

void check_models(const Results& results, std::vector<Check>& out)
{
    const double M = 2 * eta_r * R * mu_k * N;
    if (const Series* s = results.find("slide-roll-spin"))
        out.push_back({"rolling torque at rest, slide-roll-spin [N m]", largest_at_end(*s, "T_E"), 0,
                       1e-6 * M, "comes to rest"});
    if (const Series* s = results.find("epsd"))
        out.push_back(
            {"rolling torque at rest, epsd [N m]", largest_at_end(*s, "T_E"), 0, 1e-6 * M, "comes to rest"});
    if (const Series* s = results.find("constant-torque"))
        out.push_back({"rolling torque at rest, constant-torque [N m]", largest_at_end(*s, "T_E"), M,
                       1e-9 * M, "torque oscillates between its bounds"});
}

const bool rolling_models = register_experiment(
    {.name = "rolling-models",
     .figure = "4.11",
     .what = "rolling torque laws with and without history; the torque at rest vanishes only with history",
     .runs = rolling_laws,
     .checks = check_models});

}  // namespace

}  // namespace hilda::studies::friction
