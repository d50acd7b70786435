// SPDX-License-Identifier: GPL-3.0-or-later
/// Two forces that are not in HILDA: a drag that depends on the velocity, and dry friction with an internal
/// state variable. Each is one class derived from dae::Force. A falling ball and a sliding block are compared
/// with closed forms.

#include "dae/force.hpp"
#include "dae/joints.hpp"
#include "dae/model.hpp"
#include "dae/start.hpp"
#include "lie/schemes.hpp"
#include "run/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

using namespace hilda;
using lie::Vec3;

namespace {

/// F = -c |v| v [N] at the centre of mass of one body, c [N s²/m²].
class QuadraticDrag final : public dae::Force {
public:
    QuadraticDrag(int body, double c) : body(body), c(c) {}

    // Adds to out.F [N, global] and out.n_bar [N m, body frame]. It may depend on x and on constants only,
    // because a scheme evaluates it several times in a step; and it must not allocate memory.
    void add(const dae::State& x, lie::Loads& out) const override
    {
        const Vec3& v = x.body[body].rdot;
        // apply_force() applies a force at a point of a body (body frame) and adds its moment; it does
        // nothing for the ground.
        apply_force(body, -c * v.norm() * v, Vec3::Zero(), x, out);
    }

    // The bodies whose motion the force depends on, and on which it acts; implicit schemes differentiate it
    // by these.
    std::array<int, 2> bodies() const override { return {body, dae::ground}; }
    int last_body() const override { return body; }  // the highest number of them

private:
    const int body;
    const double c;
};

/// Dry friction against the ground along the unit vector e, as a spring k [N/m] in series with a slider that
/// moves at F_max [N]:
///
///     F = -k (u - z),   u = e · (r - r_0),   |u - z| <= F_max/k
///
/// z [m], the displacement of the slider, is an internal state variable. It is a part of the State, so that a
/// run can be repeated or resumed from a state alone.
class DryFriction final : public dae::Force {
public:
    DryFriction(int body, const Vec3& e, const Vec3& r_0, double k, double F_max)
        : body(body), e(e), r_0(r_0), k(k), F_max(F_max)
    {}

    void add(const dae::State& x, lie::Loads& out) const override
    {
        apply_force(body, -k * elastic(x) * e, Vec3::Zero(), x, out);
    }

    // How many numbers of State::internal_state belong to this force
    int internal_states() const override { return 1; }
    // Called at the start, when z is 0, and once for each accepted step. Elsewhere z must not change.
    void update_internal_state(dae::State& x) const override
    {
        x.internal_state[first_internal_state] = displacement(x) - elastic(x);
    }
    double z(const dae::State& x) const { return x.internal_state[first_internal_state]; }

    double potential_energy(const dae::State& x) const override
    {
        return 0.5 * k * elastic(x) * elastic(x);  // [J], of the spring
    }
    std::array<int, 2> bodies() const override { return {body, dae::ground}; }
    int last_body() const override { return body; }

private:
    double displacement(const dae::State& x) const { return e.dot(x.body[body].r - r_0); }
    double elastic(const dae::State& x) const
    {
        return std::clamp(displacement(x) - z(x), -F_max / k, F_max / k);
    }

    const int body;
    const Vec3 e, r_0;
    const double k, F_max;
};

}  // namespace

int main()
{
    constexpr double g = 9.81;
    dae::Model model;  // its gravity is (0, 0, -9.81) m/s² by default
    const int ball = model.add({.name = "ball", .m = 0.5, .J_bar = Vec3(1e-3, 1e-3, 1e-3).asDiagonal()});
    const int block = model.add({.name = "block", .m = 2, .J_bar = Vec3(1e-2, 1e-2, 1e-2).asDiagonal()});
    dae::State x;
    x.body.resize(2);
    x.body[block].r = {0, 1, 0};
    x.body[block].rdot = {1, 0, 0};  // 1 m/s along its guide
    model.constrain("guide", dae::translational(dae::ground, x.body[block].r, Vec3::UnitX(), block,
                                                Vec3::Zero(), Vec3::UnitX(), x));

    // load() takes the force by value and keeps it; name appears in messages.
    QuadraticDrag drag(ball, 0.2);
    drag.name = "drag";
    model.load(drag);
    constexpr double k = 200, F_max = 5;
    DryFriction friction(block, Vec3::UnitX(), x.body[block].r, k, F_max);
    friction.name = "friction";
    model.load(friction);
    // The model has a copy of the force; start() sets first_internal_state in it.
    const auto& friction_of_model = dynamic_cast<const DryFriction&>(*model.forces()[1]);

    dae::start(model, x);
    constexpr double t_end = 0.5;
    // The grid from 0 to t_end with the step 1e-4 s; by default every node is a row of the trajectory.
    const lie::TimeGrid grid = lie::TimeGrid::over(t_end, 1e-4);
    run::Simulation simulation(
        {.model = model, .start = x, .scheme = lie::scheme("rA-half-1-kick"), .grid = grid});
    lie::TrajectoryRecorder rows(simulation.grid());
    simulation.observe(rows);
    const run::Outcome outcome = simulation.run();
    if (outcome.failed()) {
        std::printf("FAILED: %s: %s\n", outcome.status.c_str(), outcome.message.c_str());
        return 1;
    }
    const lie::Trajectory& trajectory = rows.trajectory;
    const dae::State& end = trajectory.row.back();

    // Free fall with quadratic drag, v_t = √(m g/c): v = v_t tanh(g t/v_t), z = -v_t²/g ln cosh(g t/v_t)
    const double v_t = std::sqrt(0.5 * g / 0.2);
    const double v_exact = -v_t * std::tanh(g * t_end / v_t),
                 z_exact = -v_t * v_t / g * std::log(std::cosh(g * t_end / v_t));

    // The block loads the spring up to F_max at t_1, slides with the deceleration a up to t_2, and then
    // oscillates with the amplitude F_max/k about z = v_1²/(2 a).
    const double w = std::sqrt(k / 2), a = F_max / 2, most = F_max / k;
    const double t_1 = std::asin(most * w) / w, v_1 = std::cos(w * t_1), t_2 = t_1 + v_1 / a;
    const double slid_exact = v_1 * v_1 / (2 * a), x_exact = slid_exact + most * std::cos(w * (t_end - t_2));

    const double computed[] = {end.body[ball].rdot.z(), end.body[ball].r.z(), end.body[block].r.x(),
                               friction_of_model.z(end)};
    const double exact[] = {v_exact, z_exact, x_exact, slid_exact};
    const char* const what[] = {"speed of the ball [m/s]", "height of the ball [m]",
                                "position of the block [m]", "displacement of its slider [m]"};
    bool passed = true;
    std::printf("%-31s %12s %12s %10s\n", "after 0.5 s", "computed", "exact", "error");
    for (int n = 0; n < 4; ++n) {
        const double error = computed[n] - exact[n];
        std::printf("%-31s %12.7f %12.7f %10.2e\n", what[n], computed[n], exact[n], error);
        passed = passed && std::abs(error) < 2e-4;
    }
    if (!passed) std::printf("FAILED: an error is above 2e-4\n");
    return passed ? 0 : 1;
}
