// SPDX-License-Identifier: GPL-3.0-or-later
/// N-four-bar mechanism: a row of N + 1 cranks on the ground, whose upper ends are connected by N couplers.
/// Benchmark A02 of the library of González, Dopico, González and Cuadrado (2006), after Bayo and Avello
/// (1994).
///
/// All bars are of 1 m and 1 kg. The cranks stand upright at the start, and the upper end of the first one
/// has the velocity -1 m/s along x. The mechanism has one degree of freedom. Where it is flat, N more appear
/// for an instant: the constraints lose rank in this singular configuration. The revolute joints have 5 (3 N
/// + 1) rows in space, of which 3 N (N = 2: 6 of 35) are redundant at all times.

#include "studies/problems/n_four_bar.hpp"

#include "dae/kinematics.hpp"
#include "dae/model_file.hpp"
#include "reference/solvers/ode.hpp"
#include "reference/solvers/reference_solution.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace hilda::studies {

namespace {

const std::string family = "n_four_bar";

std::string revolute(const std::string& name, const std::string& i, const char* at_i, const std::string& j,
                     const char* at_j)
{
    return fmt::format(R"(    {{"name": "{}", "type": "revolute", "body_i": "{}", "s_bar_p_i": {},
     "body_j": "{}", "s_bar_q_j": {}, "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 1]}})",
                       name, i, at_i, j, at_j);
}

/// The mechanism in its angle φ: all cranks have the direction u = (cos φ, sin φ, 0), and the couplers move
/// with their ends without rotation.
///
///     I φ̈ = g · n (Σ m l/2 + Σ m' l),   I = Σ (J + m l²/4) + Σ m' l²,   n = ∂u/∂φ,  l = 1 m
struct Angle {
    double I = 0, moment = 0;  ///< [kg m²], [kg m]
    lie::Vec3 gravity;

    explicit Angle(const dae::Model& model) : gravity(model.gravity)
    {
        for (int b = 0; b < model.bodies(); ++b) {
            const double m = model.mass().m[b];
            I += is_crank(b, model) ? model.mass().J_bar[b](2, 2) + m / 4 : m;
            moment += is_crank(b, model) ? m / 2 : m;
        }
    }

    static bool is_crank(int b, const dae::Model& model) { return b <= model.bodies() / 2; }
    static lie::Vec3 direction(double phi) { return {std::cos(phi), std::sin(phi), 0}; }
    double acceleration(double phi) const
    {
        return moment * gravity.dot(direction(phi + std::numbers::pi / 2)) / I;
    }

    void place(const dae::Model& model, double phi, double phidot, lie::State& x) const
    {
        const lie::Vec3 u = direction(phi), n = direction(phi + std::numbers::pi / 2);
        const double phiddot = acceleration(phi);
        const lie::Vec3 v = phidot * n, a = phiddot * n - phidot * phidot * u;
        for (int b = 0; b < model.bodies(); ++b) {
            const bool crank = is_crank(b, model);
            const double part = crank ? 0.5 : 1;
            lie::Motion& body = x.body[b];
            const int k = crank ? b : b - model.bodies() / 2 - 1;
            body.r = part * u + lie::Vec3(crank ? k : k + 0.5, 0, 0);
            body.rdot = part * v, body.rddot = part * a;
            if (!crank) continue;
            body.A << u.x(), -u.y(), 0, u.y(), u.x(), 0, 0, 0, 1;
            body.omega_bar = {0, 0, phidot}, body.omegadot_bar = {0, 0, phiddot};
        }
    }
};

/// Solution in the angle by rk8pd. Masses, moments of inertia, gravity and the initial angle are those of the
/// model. A model that is not this mechanism, by the balance of loads at the start, has the reference
/// solution of a model file.
lie::Trajectory in_angle(dae::Description& d, const std::vector<double>& instants)
{
    const dae::Model& model = *d.model;
    const Angle angle(model);
    Eigen::VectorXd y(2);
    y << std::atan2(d.x.body[0].A(1, 0), d.x.body[0].A(0, 0)), d.x.body[0].omega_bar.z();
    lie::State x = d.x;
    std::vector<dae::Reaction> unbalanced;
    angle.place(model, y[0], y[1], x);
    dae::inverse_dynamics(model, x, &unbalanced);
    double imbalance = model.largest_residual(x).value + model.largest_velocity_residual(x).value;
    for (size_t b = 0; b < unbalanced.size(); ++b)
        imbalance += unbalanced[b].F.norm() + unbalanced[b].T.norm() + (x.body[b].r - d.x.body[b].r).norm();
    if (!(imbalance < 1e-8)) return reference::reference_solution(model, d.x, instants);

    reference::Ode ode(2, [&](double, const reference::ConstVectorRef& of, reference::VectorRef derivative) {
        derivative << of[1], angle.acceleration(of[0]);
    });
    lie::Trajectory run;
    double t = d.x.t;
    for (const double instant : instants) {
        ode.advance(t, y, instant);
        x.t = instant;
        angle.place(model, y[0], y[1], x);
        x.lambda = dae::inverse_dynamics(model, x);
        run.row.push_back(x);
    }
    return run;
}

}  // namespace

Problem n_four_bar(int N, const std::string& name)
{
    std::string bodies, joints;
    const auto crank = [](int k) { return "crank_" + std::to_string(k); };
    const auto coupler = [](int k) { return "coupler_" + std::to_string(k); };
    constexpr const char* inertia =
        R"("mass": 1, "inertia": [0.0016666666666666668, 0.08333333333333333, 0.08333333333333333])";
    for (int k = 0; k <= N; ++k) {
        bodies += fmt::format(
            R"({}    {{"name": "{}", {}, "r": [{}, 0.5, 0], "A": [[0, -1, 0], [1, 0, 0], [0, 0, 1]],
     "r_dot": [-0.5, 0, 0], "omega": [0, 0, 1]}})",
            k == 0 ? "" : ",\n", crank(k), inertia, k);
        joints +=
            (k == 0 ? "" : ",\n") + revolute(fmt::format("A_{}", k), "ground",
                                             fmt::format("[{}, 0, 0]", k).c_str(), crank(k), "[-0.5, 0, 0]");
    }
    for (int k = 0; k < N; ++k) {
        bodies += fmt::format(R"(,
    {{"name": "{}", {}, "r": [{}, 1, 0], "r_dot": [-1, 0, 0]}})",
                              coupler(k), inertia, k + 0.5);
        joints +=
            ",\n" + revolute(fmt::format("B_{}", k), crank(k), "[0.5, 0, 0]", coupler(k), "[-0.5, 0, 0]") +
            ",\n" + revolute(fmt::format("C_{}", k), coupler(k), "[0.5, 0, 0]", crank(k + 1), "[0.5, 0, 0]");
    }
    return {.name = name,
            .what = (name == family ? std::string("row of 2 four-bar windows (n_four_bar_N: N windows)")
                                    : fmt::format("row of {} four-bar window{}", N, N == 1 ? "" : "s")) +
                    ", singular where it is flat; benchmark A02 of Gonzalez et al. (2006)",
            .model = fmt::format(R"({{"hilda_model": 1, "name": "{}",
  "note": "bars of 1 m and 1 kg; the cranks are upright at the start, and their upper ends move with -1 m/s",
  "gravity": [0, -9.81, 0], "end": 10, "redundant": "keep",
  "bodies": [
{}
  ],
  "constraints": [
{}
  ]
}}
)",
                                 name, bodies, joints),
            .reference_name = "equation of the angle (rk8pd, 1e-13)",
            .reference_solution = in_angle,
            .observable = {.body = "crank_0", .component = "ry"}};
}

namespace {

const bool registered_n_four_bar = io::Registry<Problem>::add(n_four_bar(2, family));
const bool registered_four_bars =
    io::Registry<ProblemFamily>::add({.name = family, .most = most_windows, .member = n_four_bar});

}  // namespace

}  // namespace hilda::studies
