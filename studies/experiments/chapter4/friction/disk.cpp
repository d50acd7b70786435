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

#include <fmt/format.h>

#include <numbers>

namespace hilda::studies::friction::disk_runs {

namespace {

constexpr double m = 5, R = 0.2, I = 0.1, mu_s = 0.25, mu_k = 0.2, g = 9.8, N = m * g, v_0 = 0.5, eta_r = 0.1;
const double K_R = 4 * eta_r * 1e5 * R * R, D_critical = 2 * std::sqrt(I * K_R);

contact::FrictionParameters parameters(const std::string& preset_name, double K_E = 1e5)
{
    return preset(preset_name, {.mu_s = mu_s, .mu_k = mu_k, .K_E = K_E, .eta_r = eta_r});
}

/// `saturated`: the springs start slightly above their kinetic bounds.
BodyOnPlane roll(const contact::FrictionParameters& p, double end = 1.5, double h = 1e-4,
                 bool saturated = false, const std::string& law = "slide-roll-spin")
{
    contact::Motion start = at({0, 0, R}, {v_0, 0, 0});
    start.A = lie::exp(lie::Vec3(std::numbers::pi / 2, 0, 0));  // axis along -y
    return {.name = "disk",
            .inertia = {m, I * lie::Mat3::Identity()},
            .start = start,
            .shape = shape<contact::Disk>(R),
            .normal = given_force(N),
            .friction = p,
            .friction_law = law,
            .h = h,
            .end = end,
            .columns = {"t", "x", "theta", "v", "omega", "a", "alpha", "F_E", "F_D", "T_E", "T_D", "S_mm",
                        "Theta_e-3rad", "slips", "rolls"},
            .record = [=, theta = 0., v = v_0, omega = 0.](Curve& c, const Node& node) mutable {
                const contact::SlidingDisplacement& frame = node.pair.contact_state.slip;
                contact::Deflections& springs = node.springs;
                if (saturated && c.rows() == 0) {
                    const double S = (1 + 1e-9) * mu_k * N / p.K_E;
                    springs.S = contact::components({-S, 0, 0}, frame.n, frame.u);
                    springs.Theta_i = contact::components({S / (2 * R), 0, 0}, frame.n, frame.u);
                    springs.slide = springs.roll_i = {.slipping = true, .damped = false};
                }
                const auto along_x = [&](const contact::Vec2& of) {
                    return contact::tangent(of, frame.n, frame.u).x();
                };
                const double v_now = node.body.rdot.x(), omega_now = node.omega.y(),
                             F_E = -node.wrench.F_E.x(), T_E = -node.wrench.T_roll_E.y();
                theta += h * omega_now;
                c.add({node.scene.t, node.body.r.x(), theta, v_now, omega_now, (v_now - v) / h,
                       (omega_now - omega) / h, F_E, -node.wrench.F.x() - F_E, T_E,
                       -node.wrench.T_i.y() - T_E, -1e3 * along_x(springs.S), 1e3 * along_x(springs.Theta_i),
                       springs.slide.slipping ? 1. : 0., springs.roll_i.slipping ? 0. : 1.});
                v = v_now, omega = omega_now;
            }};
}

/// The parameters with these parts of the critical dampings of rolling and sliding; 0: no change
contact::FrictionParameters damped(contact::FrictionParameters p, double roll, double slide)
{
    if (roll > 0) p.D_roll = roll * D_critical;
    if (slide > 0) p.D_slide = slide * 2 * std::sqrt(m * p.K_E);
    return p;
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

const RigidDisk rigid;

const Measure end_of_slip = first(
    "slips", [](double slips) { return slips == 0; }, 0.01);
/// End of kinetic rolling friction; afterwards the rolling spring oscillates about its rest position
const Measure end_of_rolling = first(
    "rolls", [](double rolls) { return rolls != 0; }, 0.5);

const bool disk = register_experiment(
    {.name = "disk",
     .figure = "4.9",
     .what = "disk started without rotation: slip, rolling, rest",
     .runs = {{"dissertation", [] { return roll(damped(parameters("dissertation"), 1.5, 0)); }},
              {"saturated", [] { return roll(parameters("dissertation"), 1.5, 1e-4, true); }},
              {"balanced", [] { return roll(parameters("balanced"), 3); }},
              {"stiff", [] { return roll(parameters("balanced", 1e6), 2, 2e-5); }, true}},
     .expected =
         {{"dissertation", "x at 1.5 s, dissertation [m]", last("x"), 0.2093106, 5e-8, "published run"},
          {"dissertation", "theta at 1.5 s, dissertation [rad]", last("theta"), 0.9512334, 5e-8,
           "published run"},
          {"balanced", "end of slip, balanced [s]", end_of_slip, rigid.t_1, 5e-3 * rigid.t_1, "rigid"},
          {"balanced", "stop time, balanced [s]", end_of_rolling, rigid.t_2, 1e-3 * rigid.t_2, "rigid"},
          {"balanced", "x at rest, balanced [m]", last("x"), rigid.x_2, 3e-3 * rigid.x_2, "rigid"},
          {"balanced", "theta at rest, balanced [rad]", last("theta"), rigid.theta_2, 3e-3 * rigid.theta_2,
           "rigid"},
          {"stiff", "end of slip, stiff [s]", end_of_slip, rigid.t_1, 1e-3 * rigid.t_1, "rigid"},
          {"stiff", "stop time, stiff [s]", end_of_rolling, rigid.t_2, 1e-3 * rigid.t_2, "rigid"},
          {"stiff", "x at rest, stiff [m]", last("x"), rigid.x_2, 1e-3 * rigid.x_2, "rigid"},
          {"stiff", "theta at rest, stiff [rad]", last("theta"), rigid.theta_2, 1e-3 * rigid.theta_2,
           "rigid"},
          {"balanced", "largest |omega| after 2.5 s, balanced [rad/s]",
           [](const Curve& c) { return c.largest("omega", 2.5); }, 0, 1e-8, "comes to rest"}},
     .has_frames = true});

std::vector<ExperimentRun> dampings()
{
    std::vector<ExperimentRun> all;
    for (const double part : {0.5, 1., 1.5, 2.})
        for (const std::string& name : presets)
            all.push_back({fmt::format("{}-{:g}", name, part),
                           [=] { return roll(damped(parameters(name), part, part)); }});
    return all;
}

const bool disk_damping =
    register_experiment({.name = "disk-damping",
                         .figure = "4.10",
                         .what = "disk coming to rest with 0.5, 1, 1.5 and 2 times the critical damping",
                         .runs = dampings()});

ExperimentRun with_law(const std::string& law)
{
    contact::FrictionParameters p = parameters("balanced");
    if (law != "slide-roll-spin") p.mu_r = 2 * eta_r * mu_k;  // the same torque during rolling
    return {law, [=] { return roll(p, 2, 1e-4, false, law); }};
}

/// The largest rolling torque of a law in the last 0.2 s
Expected torque_at_rest(const std::string& law, double required, double tolerance, const std::string& source)
{
    return {law,
            "rolling torque at rest, " + law + " [N m]",
            [](const Curve& c) { return c.largest("T_E", c.last("t") - 0.2); },
            required,
            tolerance,
            source};
}

const bool rolling_models = register_experiment(
    {.name = "rolling-models",
     .figure = "4.11",
     .what = "rolling torque laws with and without history; the torque at rest vanishes only with history",
     .runs = {with_law("slide-roll-spin"), with_law("constant-torque"), with_law("epsd")},
     .expected = {torque_at_rest("slide-roll-spin", 0, 1e-6 * rigid.M, "comes to rest"),
                  torque_at_rest("epsd", 0, 1e-6 * rigid.M, "comes to rest"),
                  torque_at_rest("constant-torque", rigid.M, 1e-9 * rigid.M,
                                 "torque oscillates between its bounds")}});

}  // namespace

}  // namespace hilda::studies::friction::disk_runs
