// SPDX-License-Identifier: GPL-3.0-or-later
/// Tests of all registered schemes.

#include "lie/schemes.hpp"
#include "lie/check.hpp"
#include "lie/integrator.hpp"
#include "lie/settings.hpp"
#include "lie/solver/linear_solver.hpp"
#include "lie/system.hpp"
#include "lie/trajectory.hpp"
#include "tests/lie/one_body_state.hpp"
#include "tests/support/no_allocation.hpp"
#include "tests/support/spinning_top.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using lie::Vec3;
using tests::motion;

namespace {

lie::State at_end(const lie::Scheme& scheme, const lie::System& system, const lie::State& start, double h,
                  double t_end)
{
    const auto integrator = scheme.make(system, {.tolerance = 1e-13, .max_iterations = 30});
    return lie::march(start, *integrator, lie::TimeGrid::over(t_end, h, t_end)).row.back();
}

/// A step for which the leading term of the error dominates higher terms and rounding
double step_for(const lie::Scheme& s, bool free)
{
    if (s.order >= 8) return free ? 2.5e-2 : 1.25e-2;
    if (s.order == 6) return free ? 2e-2 : 1e-2;
    if (s.name == "rA-radau-5") return free ? 5e-3 : 1e-2;  // a smaller constant of the error
    if (s.order == 5) return free ? 5e-3 : 1.25e-3;
    return s.order > 2 ? 5e-3 : 5e-5;
}

/// The margin of a measured order. At order 8 the next term of the error is not small where the error is
/// above rounding.
double margin(const lie::Scheme& s) { return s.order >= 8 ? 0.45 : 0.15; }

double order(const Eigen::VectorXd& coarse, const Eigen::VectorXd& middle, const Eigen::VectorXd& fine)
{
    return std::log2((coarse - middle).norm() / (middle - fine).norm());
}

}  // namespace

TEST_CASE("the declared order is the measured order (long)", "[lie][order]")
{
    const tests::SpinningTop top;
    const lie::State start = top.start();
    for (const lie::Scheme& s : lie::schemes()) {
        if (s.adaptive) continue;  // of order in the tolerance
        const double h = step_for(s, false);
        const lie::State a = at_end(s, top, start, 4 * h, 0.4), b = at_end(s, top, start, 2 * h, 0.4),
                         c = at_end(s, top, start, h, 0.4);
        const double of_motion = order(motion(a), motion(b), motion(c)),
                     of_lambda = order(a.lambda, b.lambda, c.lambda);
        INFO(s.name << " declares " << s.order << " and " << s.order_lambda << " for lambda, shows "
                    << of_motion << " and " << of_lambda);
        CHECK(of_motion == Approx(s.order).margin(margin(s)));
        // wider margin: rA-half-2 has an alternating error of O(h) besides a smooth one of O(h²)
        CHECK(of_lambda == Approx(s.order_lambda).margin(0.25));
    }
}

TEST_CASE("the declared order holds for a torque-free body (long)", "[lie][order]")
{
    const tests::SpinningTop top(true);
    const lie::State start = top.start();
    for (const lie::Scheme& s : lie::schemes()) {
        if (s.adaptive) continue;  // of order in the tolerance
        const double h = step_for(s, true);
        const Eigen::VectorXd a = motion(at_end(s, top, start, 4 * h, 0.4)),
                              b = motion(at_end(s, top, start, 2 * h, 0.4)),
                              c = motion(at_end(s, top, start, h, 0.4));
        INFO(s.name << " declares " << s.order << ", shows " << order(a, b, c) << ", error "
                    << (a - c).norm());
        // The errors of composed steps are those of rounding already.
        if (s.order >= 8 && (a - c).norm() < 1e-10) continue;
        CHECK(order(a, b, c) == Approx(s.order).margin(0.15));
    }
}

TEST_CASE("a step does not allocate memory", "[lie][allocation]")
{
    if (!tests::counts_allocations) {
        WARN("skipped: a sanitizer replaces the allocator");
        return;
    }
    const tests::SpinningTop top;
    for (const lie::Scheme& s : lie::schemes()) {
        const auto integrator = s.make(top, {});
        lie::State x = top.start();
        for (int n = 0; n < 3; ++n) integrator->step(x, 1e-3);  // chooses pivots and allocates buffers
        const long taken = tests::allocations_during([&] {
            for (int n = 0; n < 100; ++n) integrator->step(x, 1e-3);
        });
        INFO(s.name);
        CHECK(taken == 0);
    }
}

TEST_CASE("the allocation counter counts", "[lie][allocation]")
{
    if (!tests::counts_allocations) {
        WARN("skipped: a sanitizer replaces the allocator");
        return;
    }
    CHECK(tests::allocations_during([] { delete new int(1); }) >= 0);
    std::vector<double>* v = nullptr;
    CHECK(tests::allocations_during([&] { v = new std::vector<double>(100); }) >= 2);
    delete v;
}

TEST_CASE("a step that fails does not change the state", "[lie][newton]")
{
    const tests::SpinningTop top;
    for (const lie::Scheme& s : lie::schemes()) {
        if (s.needs_tree) continue;  // no iteration that could fail
        const auto integrator = s.make(top, {.tolerance = 1e-300, .max_iterations = 2});
        for (const bool moving : {false, true}) {
            lie::State x = top.start();
            if (moving) s.make(top, {})->step(x, 1e-2);  // with a history, if the scheme has one
            const lie::State before = x;
            INFO(s.name << (moving ? ", second step" : ", first step"));
            // the projection of a method of high order converges in two iterations where its error is small
            CHECK_THROWS_AS(integrator->step(x, s.order > 4 ? 0.1 : 1e-2), lie::NoConvergence);
            CHECK(x.t == before.t);
            CHECK(x.body[0].r == before.body[0].r);
            CHECK(x.body[0].A == before.body[0].A);
            CHECK(x.body[0].rdot == before.body[0].rdot);
            CHECK(x.body[0].omega_bar == before.body[0].omega_bar);
            CHECK(x.body[0].omegadot_bar == before.body[0].omegadot_bar);
            CHECK(x.lambda == before.lambda);
            REQUIRE(x.history.size() == before.history.size());
            CHECK(x.history == before.history);
        }
    }
}

TEST_CASE("constraints are satisfied and A remains a rotation", "[lie][invariants]")
{
    const tests::SpinningTop top;
    for (const lie::Scheme& s : lie::schemes()) {
        struct Worst final : lie::Observer {
            const tests::SpinningTop& top;
            double phi = 0, orthogonality = 0;
            explicit Worst(const tests::SpinningTop& top) : top(top) {}
            void accepted(const lie::State& x, long, int) override
            {
                Eigen::VectorXd value(3);
                top.phi(x, value);
                phi = std::max(phi, value.norm());
                orthogonality = std::max(orthogonality, lie::orthogonality_error(x.body[0].A));
            }
        } worst(top);
        lie::Observer* observers[] = {&worst};
        const auto integrator = s.make(top, {});
        lie::march(top.start(), *integrator, lie::TimeGrid::over(2, 1e-3, 2), observers);
        INFO(s.name << " residual " << worst.phi << ", orthogonality " << worst.orthogonality);
        CHECK(worst.phi < 1e-12);
        CHECK(worst.orthogonality < 1e-14);
    }
}

TEST_CASE("a step has the same result with every linear solver", "[lie][condensed]")
{
    const tests::SpinningTop top;
    for (const lie::Scheme& s : lie::schemes()) {
        lie::State x = top.start(), y = x;
        const auto klu = s.make(top, {.linear_solver = lie::LinearSolver::klu}),
                   condensed = s.make(top, {.linear_solver = lie::LinearSolver::condensed});
        for (int n = 0; n < 50; ++n) {
            INFO(s.name << ", step " << n);
            CHECK(klu->step(x, 5e-3) == condensed->step(y, 5e-3));
        }
        CHECK((motion(x) - motion(y)).norm() < 1e-11);
        CHECK((x.lambda - y.lambda).norm() < 1e-7 * x.lambda.norm());
    }
}

TEST_CASE("the energy error of a variational scheme is bounded for a top", "[lie][invariants]")
{
    // |E - E_0| is bounded for a symplectic scheme and grows with time for others.
    const tests::SpinningTop top;
    const auto drift = [&](const char* scheme, double t_end) {
        const auto integrator = lie::scheme(scheme).make(top, {.tolerance = 1e-12});
        const lie::State x = top.start();
        const lie::Trajectory run = lie::march(x, *integrator, lie::TimeGrid::over(t_end, 2e-3, 0.1));
        double largest = 0;
        for (const lie::State& y : run.row)
            largest = std::max(largest, std::abs(lie::energy(top, y) - lie::energy(top, x)));
        return largest;
    };
    const double after_2 = drift("rA-rattle", 2), after_16 = drift("rA-rattle", 16);
    CHECK(after_16 < 1.2 * after_2);
    CHECK(drift("rA-half-1", 16) > 100 * after_16);
}

TEST_CASE("the stopping criterion does not depend on other bodies or on the distance from the origin",
          "[lie][newton]")
{
    // Two independent tops. A heavy second top, or a large distance from the origin, must not end the
    // iteration early.
    class Two final : public lie::System {
    public:
        Two(double mass, double away) : away(away)
        {
            inertia.m = {2.0, mass};
            inertia.J_bar = {one.mass().J_bar[0], mass / 2 * one.mass().J_bar[0]};
            for (int k = 0; k < 6; ++k) {
                rows_pattern.entry.push_back({.body = k / 3});
                rows_pattern.start.push_back(k + 1);
            }
        }
        const lie::Mass& mass() const override { return inertia; }
        const lie::Rows& pattern() const override { return rows_pattern; }
        void loads(const lie::State&, lie::Loads& out) const override
        {
            for (int b = 0; b < 2; ++b) out.F[b] = Vec3(0, 0, -9.81 * inertia.m[b]), out.n_bar[b].setZero();
        }
        void phi(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override
        {
            for (int b = 0; b < 2; ++b)
                out.segment<3>(3 * b) = x.body[b].r - Vec3(away, 0, 0) + x.body[b].A * one.s_bar;
        }
        void variation(const lie::State& x, lie::Rows& out) const override
        {
            for (int k = 0; k < 6; ++k) {
                out.entry[k].r = Vec3::Unit(k % 3);
                out.entry[k].pi = one.s_bar.cross(x.body[k / 3].A.transpose() * Vec3::Unit(k % 3));
            }
        }
        void nu(const lie::State&, Eigen::Ref<Eigen::VectorXd> out) const override { out.setZero(); }
        void gamma(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override
        {
            for (int b = 0; b < 2; ++b) {
                const Vec3& omega_bar = x.body[b].omega_bar;
                out.segment<3>(3 * b) = -x.body[b].A * omega_bar.cross(omega_bar.cross(one.s_bar));
            }
        }
        lie::State start() const
        {
            lie::State x = one.start();
            x.body.push_back(x.body[0]);
            for (lie::Motion& body : x.body) body.r.x() += away;
            const Eigen::VectorXd lambda = x.lambda;
            x.lambda.resize(6);
            x.lambda << lambda, inertia.m[1] / 2 * lambda;
            return x;
        }

    private:
        const tests::SpinningTop one;
        const double away;
        lie::Mass inertia;
        lie::Rows rows_pattern;
    };
    const tests::SpinningTop alone;
    for (const char* name : {"rA-half-1", "rA-half-1-kick", "rA-half-2", "rA-half-2-bdf2", "rA-full-1",
                             "rA-genalpha", "rA-rattle"}) {
        const auto of_one = lie::scheme(name).make(alone, {});
        lie::State y = alone.start();
        for (int n = 0; n < 20; ++n) of_one->step(y, 2e-3);
        for (const double mass : {2e-6, 2e6, 2e12}) {
            const Two two(mass, 0);
            const auto integrator = lie::scheme(name).make(two, {});
            lie::State x = two.start();
            for (int n = 0; n < 20; ++n) integrator->step(x, 2e-3);
            INFO(name << ", other mass " << mass);
            CHECK(integrator->statistics().iterations_per_step() >=
                  Approx(of_one->statistics().iterations_per_step()).margin(0.1));
            CHECK((motion(x) - motion(y)).norm() < 5e-8);  // velocities: tolerance/h
        }
        const Two far(2, 1e6);
        const auto integrator = lie::scheme(name).make(far, {});
        lie::State x = far.start();
        for (int n = 0; n < 20; ++n) integrator->step(x, 2e-3);
        x.body[0].r.x() -= 1e6;
        INFO(name << ", far away");
        CHECK((x.body[0].r - y.body[0].r).norm() < 1e-8);
    }
}

TEST_CASE("implicit schemes reject a solution with half a turn or more in a step", "[lie][newton]")
{
    const tests::SpinningTop top(true);
    for (const char* name : {"rA-full-1", "rA-full-1-exact", "rA-genalpha"}) {
        lie::State x = top.start();
        const auto integrator = lie::scheme(name).make(top, {});
        x.body[0].omega_bar = Vec3(0, 0, 700);
        CHECK_THROWS_AS(integrator->step(x, 5e-3), lie::NumericalFailure);  // 3.5 rad
        CHECK(x.body[0].omega_bar == Vec3(0, 0, 700));
        CHECK_NOTHROW(integrator->step(x, 1e-3));
    }
}

TEST_CASE("generalised-alpha is of second order for every spectral radius below 1 (long)", "[lie]")
{
    const tests::SpinningTop top;
    CHECK_THROWS_AS(lie::scheme("rA-genalpha").make(top, {.rho_infinity = 1.2}), lie::InvalidInput);
    for (const double rho : {0.0, 0.5, 0.9}) {
        const auto at = [&](double h) {
            const auto integrator =
                lie::scheme("rA-genalpha").make(top, {.tolerance = 1e-13, .rho_infinity = rho});
            return lie::march(top.start(), *integrator, lie::TimeGrid::over(0.4, h, 0.4)).row.back();
        };
        const lie::State a = at(4e-4), b = at(2e-4), c = at(1e-4);
        INFO("rho " << rho);
        CHECK(order(motion(a), motion(b), motion(c)) == Approx(2).margin(0.1));
        CHECK(order(a.lambda, b.lambda, c.lambda) == Approx(2).margin(0.15));
    }
}

TEST_CASE("A remains orthogonal over a million steps", "[lie][invariants]")
{
    const tests::SpinningTop top(true);
    const auto integrator = lie::scheme("rA-half-1").make(top, {});
    lie::State x = top.start();
#ifdef NDEBUG
    const int steps = 1000000;
#else
    const int steps = 20000;
#endif
    double worst = 0;
    for (int n = 0; n < steps; ++n) {
        integrator->step(x, 1e-4);
        if (n % 100 == 0) worst = std::max(worst, lie::orthogonality_error(x.body[0].A));
    }
    CHECK(worst < 1e-14);
}

TEST_CASE("output rows are at multiples of the output interval without drift of time", "[lie][march]")
{
    const tests::SpinningTop top(true);
    const auto integrator = lie::scheme("rA-half-1").make(top, {});
    const lie::Trajectory trajectory =
        lie::march(top.start(), *integrator, lie::TimeGrid::over(1, 1e-3, 0.1));
    REQUIRE(trajectory.row.size() == 11);
    for (int k = 0; k <= 10; ++k) CHECK(trajectory.row[k].t == Approx(0.1 * k).epsilon(1e-15));
    CHECK_THROWS_AS(lie::TimeGrid::over(1, 0), lie::InvalidInput);
    CHECK_THROWS_AS(lie::TimeGrid::over(1, std::nan("")), lie::InvalidInput);
    CHECK_THROWS_AS(lie::TimeGrid::over(-1, 1e-3), lie::InvalidInput);
    CHECK_THROWS_AS(lie::scheme("rA-half-9"), lie::InvalidInput);
}
