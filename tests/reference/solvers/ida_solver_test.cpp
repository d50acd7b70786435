// SPDX-License-Identifier: GPL-3.0-or-later
/// IDA on the equations of motion in Euler parameters, compared with reference trajectories.

#include "reference/solvers/ida_solver.hpp"

#include "dae/forces/prescribed.hpp"
#include "dae/forces/torsion_spring.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "reference/solvers/index1.hpp"
#include "tests/reference/chains.hpp"
#include "tests/reference/reference_csv.hpp"
#include "tests/support/spinning_top.hpp"

#include <numbers>

using namespace hilda;
using namespace hilda::reference;
using lie::Vec3;

namespace {

constexpr double weight = 9.81;  // [m/s²]

struct ReferenceModel {
    const char* name;
    const char* file;
    void (*build)(dae::Model&, lie::State&);
};

const ReferenceModel reference_models[] = {
    {"double pendulum", "double_pendulum.csv",
     [](dae::Model& model, lie::State& x) { tests::DoublePendulum{}.build(model, x); }},
    {"double pendulum, moving", "x_double_pendulum_moving.csv",
     [](dae::Model& model, lie::State& x) {
         tests::DoublePendulum{.w = 0.1, .thetadot_1 = 1, .thetadot_2 = -2}.build(model, x);
     }},
    {"two spinning bars", "x_n_pendulum_2_spin.csv",
     [](dae::Model& model, lie::State& x) {
         tests::ball_chain(2, model, x, [](lie::State& start) {
             start.body[0].rdot = Vec3(-0.5, -1, 0), start.body[0].omega_bar = Vec3(3, 0.5, -1);
             start.body[1].rdot = Vec3(-2, 0, 0), start.body[1].omega_bar = Vec3(-4, 1, 2);
         });
     }},
    {"slider-crank", "slider_crank.csv",
     [](dae::Model& model, lie::State& x) {
         tests::slider_crank(model, x);
         dae::start(model, x);
     }},
    {"four-link", "four_link.csv",
     [](dae::Model& model, lie::State& x) {
         tests::four_link(model, x);
         dae::start(model, x);
     }},
};

struct Result {
    tests::Deviation d;
    double Q = 0, position = 0, velocity = 0;
    lie::Statistics cost;
};

Result measure(const ReferenceModel& c, double rtol, RpForm form = RpForm::ggl, double to = 3,
               double atol = 0)
{
    dae::Model model;
    lie::State x;
    c.build(model, x);
    auto reference = tests::references(c.file);
    std::erase_if(reference, [&](const tests::Reference& row) { return row.x.t > to + 1e-9; });
    IdaSolver solver(model, {.rtol = rtol, .atol = atol}, form);
    Result result;
    std::vector<lie::State> run;
    std::vector<std::vector<dae::Reaction>> loads;
    for (const tests::Reference& row : reference) {
        if (row.x.t > x.t) solver.advance(x, row.x.t);
        run.push_back(x);
        loads.push_back(dae::reactions(model, x));
        result.position = std::max(result.position, model.largest_residual(x).value);
        result.velocity = std::max(result.velocity, model.largest_velocity_residual(x).value);
    }
    result.d = tests::deviation(run, reference);
    result.Q = tests::reaction_deviation(loads, reference);
    result.cost = solver.statistics();
    return result;
}

std::ostream& operator<<(std::ostream& out, const Result& r)
{
    return out << r.d << "; loads " << r.Q << ", drift " << r.position << ", of velocities " << r.velocity
               << "; " << r.cost.steps << " steps, " << r.cost.iterations << " iterations, "
               << r.cost.factorizations << " factorizations";
}

#ifdef NDEBUG
constexpr double t_end = 3;
#else
constexpr double t_end = 0.3;
#endif

/// Pendulum on a crank that rotates at 1 Hz, driven by a dot-product driver
void crank_and_bob(dae::Model& model, lie::State& x)
{
    const Vec3 X = Vec3::UnitX(), Y = Vec3::UnitY(), Z = Vec3::UnitZ(), O = Vec3::Zero();
    const lie::Mat3 I = lie::Mat3::Identity();
    using std::numbers::pi;
    tests::add_body(model, x, "crank", 1, {0.1, 0.1, 0.1}, O, I, O, {2 * pi, 0, 0});
    tests::add_body(model, x, "bob", 1, {0.02, 0.02, 0.02}, {0, 0.3, -0.5}, I, {0, 0, 0.6 * pi});
    model.constrain("shaft", dae::revolute(dae::ground, O, X, 0, O, X));
    model.constrain("pin", dae::revolute(0, {0, 0.3, 0}, X, 1, {0, 0, 0.5}, X));
    model.constrain("motor", dae::DP1(dae::ground, Z, 0, Y, dae::Driver("sin(2*pi*t)")));
    dae::start(model, x);
}

/// Wheel on an axle with a torsion spring
void wheel(dae::Model& model, lie::State& x)
{
    const Vec3 X = Vec3::UnitX(), O = Vec3::Zero();
    tests::add_body(model, x, "wheel", 1, {0.1, 0.2, 0.2}, O, lie::Mat3::Identity(), O, {30, 0, 0});
    model.constrain("axle", dae::revolute(dae::ground, O, X, 0, O, X));
    model.load(dae::TorsionSpring(dae::ground, X, 0, X, 0.4, 0, 0, x));
    dae::start(model, x);
}

/// Body with a prescribed force along x, an expression of the time
void pushed(const char* force, dae::Model& model, lie::State& x)
{
    tests::add_body(model, x, "block", 1, {1, 1, 1}, Vec3::Zero(), lie::Mat3::Identity());
    model.load(dae::PrescribedForce(
        0, Vec3::Zero(), dae::Frame::global,
        {io::Expression(force, {"t"}), io::Expression("0", {"t"}), io::Expression("0", {"t"})}));
    dae::start(model, x);
}

void check_unchanged(const lie::State& x, const lie::State& y)
{
    CHECK(x.t == y.t);
    CHECK(x.body[0].r == y.body[0].r);
    CHECK(x.body[0].rdot == y.body[0].rdot);
    CHECK(x.lambda == y.lambda);
}

}  // namespace

TEST_CASE("IDA reproduces the reference trajectories", "[reference][ida][acceptance]")
{
    for (const ReferenceModel& c : reference_models) {
        const Result r = measure(c, 1e-12, RpForm::ggl, t_end);
        INFO(c.name << ": " << r);
        CHECK(r.d.r < 1e-9);
        CHECK(r.d.A < 1e-9);
        CHECK(r.d.rdot < 1e-9);
        CHECK(r.d.omega_bar < 2e-9);  // dominated by the bar that spins about its longitudinal axis
        CHECK(r.position < 1e-11);
        CHECK(r.velocity < 1e-11);
        CHECK(r.Q < 1e-7);
    }
}

TEST_CASE("the error of IDA is proportional to its tolerance in every form of the constraints",
          "[reference][ida]")
{
    for (const RpForm form : {RpForm::ggl, RpForm::baumgarte, RpForm::index1}) {
        std::vector<double> error;
        for (const double rtol : {1e-6, 1e-8, 1e-10}) {
            const Result r = measure(reference_models[1], rtol, form, 1);
            INFO("form " << static_cast<int>(form) << ", rtol " << rtol << ": " << r);
            CHECK(r.d.r < 300 * rtol);
            if (form == RpForm::ggl) CHECK(r.position < 10 * rtol);
            error.push_back(r.d.r);
        }
        CHECK(std::log10(error[0] / error[2]) / 4 == Approx(1).margin(0.35));
    }
}

TEST_CASE("IDA passes the singular positions of a driver for any choice of nodes", "[reference][ida]")
{
    dae::Model model;
    lie::State x;
    crank_and_bob(model, x);
    const std::vector<double> instants = {0.25, 0.5,
                                          1};  // one branch of the driver is singular at the first two
    const lie::Trajectory exact = index1(model, x, instants);
    const lie::Trajectory run = ida(model, x, instants, 1e-10);
    const tests::Deviation d = tests::deviation(run.row, exact.row);
    INFO(d);
    CHECK(d.largest() < 1e-6);
    CHECK(run.row[0].discrete_state != run.row[2].discrete_state);

    // also at a loose tolerance, with a drift larger than the tolerance of a change of branch
    const tests::Deviation loose = tests::deviation(ida(model, x, instants, 1e-4).row, exact.row);
    INFO(loose);
    CHECK(loose.r < 1e-2);

    // lie::march changes branches of drivers at its own nodes as well
    const auto integrator = lie::scheme("ida-rp").make(model, {.rtol = 1e-10});
    const lie::Trajectory marched = lie::march(x, *integrator, lie::TimeGrid::over(1, 0.05, 0.25));
    CHECK((marched.row.back().body[1].r - exact.row.back().body[1].r).norm() < 1e-6);
    for (size_t b = 0; b < 2; ++b)
        CHECK((dae::reactions(model, marched.row[1])[b].F - dae::reactions(model, exact.row[0])[b].F).norm() <
              1e-5);
}

TEST_CASE("turns are counted within the steps of IDA without a restart", "[reference][ida]")
{
    dae::Model model;
    lie::State x;
    wheel(model, x);
    IdaSolver solver(model, {.rtol = 1e-10});
    lie::State y = x;
    solver.advance(y, 1);  // closed form: angle 15 sin(2t) rad, at most 9.5 quarter turns
    const double angle = 30 / 2.0 * std::sin(2.0), rate = 30 * std::cos(2.0);
    CHECK((y.body[0].A - lie::exp(Vec3(angle, 0, 0))).norm() < 1e-7);
    CHECK(y.body[0].omega_bar.x() == Approx(rate).epsilon(1e-8));
    CHECK(y.discrete_state[0] == std::lround(angle / 1.57079632679489662));
    INFO(solver.statistics().steps);
    CHECK(solver.statistics().steps < 5000);
}

TEST_CASE("IDA accepts any system and restarts from any state", "[reference][ida]")
{
    for (const bool free : {false, true}) {
        const tests::SpinningTop top(free);
        lie::State x = top.start();
        const double energy = lie::energy(top, x);
        IdaSolver solver(top, {.rtol = 1e-11});
        for (int n = 1; n <= 10; ++n) solver.step(x, 0.03);
        CHECK(lie::energy(top, x) == Approx(energy).epsilon(1e-9));

        // again from a state that is not the one of the last call
        lie::State y = top.start();
        for (int n = 1; n <= 10; ++n) solver.step(y, 0.03);
        CHECK(x.t == y.t);
        CHECK((x.body[0].A - y.body[0].A).norm() < 1e-14);
        CHECK((x.body[0].omega_bar - y.body[0].omega_bar).norm() < 1e-13);
    }
}

TEST_CASE("IDA rejects invalid tolerances and instants", "[reference][ida]")
{
    const tests::SpinningTop top;
    lie::State x = top.start();
    for (const double rtol : {0.0, -1e-6, 1e-15, std::nan("")})
        CHECK_THROWS_AS(IdaSolver(top, {.rtol = rtol}), lie::InvalidInput);
    CHECK_THROWS_AS(IdaSolver(top, {.atol = -1}), lie::InvalidInput);
    CHECK_THROWS_WITH(ida(top, x, {0.2, 0.1}), Catch::Contains("ascend"));
    IdaSolver solver(top);
    CHECK_THROWS_AS(solver.step(x, 0), lie::InvalidInput);
    CHECK_THROWS_AS(solver.step(x, std::nan("")), lie::InvalidInput);
    CHECK(ida(top, x, {0, 0.01}).row[0].body[0].A == x.body[0].A);
}

TEST_CASE("exceptions propagate through IDA and leave the state unchanged", "[reference][ida]")
{
    SECTION("a load that is not finite is reported with its equation and time")
    {
        dae::Model model;
        lie::State x;
        pushed("sqrt(0.05 - t)", model, x);
        const lie::State before = x;
        IdaSolver solver(model, {.rtol = 1e-6});
        CHECK_THROWS_WITH(solver.step(x, 0.1), Catch::Contains("translation of body 'block'") &&
                                                   Catch::Contains("not finite at t = 0.05"));
        check_unchanged(x, before);
        solver.step(x, 0.04);  // the solver can be used again
        CHECK(x.t == Approx(0.04));
    }
    SECTION("a failure of IDA is reported with its message")
    {
        dae::Model model;
        lie::State x;
        pushed("1/(0.05 - t)^2", model, x);
        const lie::State before = x;
        IdaSolver solver(model, {.rtol = 1e-6});
        try {
            solver.step(x, 0.1);
            FAIL("there is no motion past the pole");
        } catch (const lie::NumericalFailure& e) {
            INFO(e.what());
            CHECK(e.status == "ida_failed");
            CHECK_THAT(e.what(), Catch::Contains("IDA") && Catch::Contains("t = 0.0"));
        }
        check_unchanged(x, before);
    }
    SECTION("an exception of the system is rethrown")
    {
        struct Refuses final : lie::System {
            tests::SpinningTop top;
            const lie::Mass& mass() const override { return top.mass(); }
            const lie::Rows& pattern() const override { return top.pattern(); }
            void loads(const lie::State& x, lie::Loads& out) const override
            {
                if (x.t > 0.05) throw std::out_of_range("the table ends here");
                top.loads(x, out);
            }
            void phi(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override { top.phi(x, out); }
            void variation(const lie::State& x, lie::Rows& out) const override { top.variation(x, out); }
            void nu(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override { top.nu(x, out); }
            void gamma(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override
            {
                top.gamma(x, out);
            }
        } const system;
        lie::State x = system.top.start();
        const lie::State before = x;
        IdaSolver solver(system, {.rtol = 1e-6});
        CHECK_THROWS_AS(solver.step(x, 0.1), std::out_of_range);
        check_unchanged(x, before);
    }
}

TEST_CASE("IDA integrates bodies far from the origin, and of any size", "[reference][ida]")
{
    // Two bars of the length L, hinged about x, that start horizontally at `offset`
    const auto end = [](double offset, double L, RpForm form, double gravity = weight) {
        dae::Model model;
        model.gravity = {0, 0, -gravity};
        lie::State x;
        const Vec3 X = Vec3::UnitX(), o(offset, -offset, offset);
        const Vec3 inertia = L * L / 12 * Vec3(1, 0.01, 1);
        tests::add_body(model, x, "a", 1, inertia, o + Vec3(0, L / 2, 0), lie::Mat3::Identity());
        tests::add_body(model, x, "b", 1, inertia, o + Vec3(0, 1.5 * L, 0), lie::Mat3::Identity());
        model.constrain("A", dae::revolute(dae::ground, o, X, 0, {0, -L / 2, 0}, X));
        model.constrain("B", dae::revolute(0, {0, L / 2, 0}, X, 1, {0, -L / 2, 0}, X));
        dae::start(model, x);
        IdaSolver solver(model, {.rtol = 1e-10}, form);
        solver.advance(x, 2 * std::sqrt(L * weight / gravity));
        for (lie::Motion& body : x.body) body.r -= o;
        return x;
    };
    const auto difference = [](const lie::State& x, const lie::State& y, double L, double gravity = weight) {
        const double speed = std::sqrt(L * gravity / weight);
        double most = 0;
        for (size_t b = 0; b < 2; ++b)
            most = std::max({most, (x.body[b].r / L - y.body[b].r).norm(), (x.body[b].A - y.body[b].A).norm(),
                             (x.body[b].rdot / speed - y.body[b].rdot).norm()});
        return most;
    };
    for (const RpForm form : {RpForm::ggl, RpForm::baumgarte, RpForm::index1}) {
        const lie::State at_origin = end(0, 1, form);
        CAPTURE(static_cast<int>(form));
        CHECK(difference(end(1e3, 1, form), at_origin, 1) < 1e-7);
        CHECK(difference(end(1e5, 1, form), at_origin, 1) < 1e-7);
        CHECK(difference(end(1e7, 1, form), at_origin, 1) < 1e-5);
        if (form == RpForm::baumgarte) continue;  // its parameter is a rate
        for (const double L : {1e-6, 1e-4, 1e-3, 0.02, 50., 1e3, 1e6, 1e8}) {
            CAPTURE(L);
            // The absolute tolerance of velocities is relative to a length per second, and these are slow.
            CHECK(difference(end(0, L, form), at_origin, L) < 1e-7 * std::max(1., std::sqrt(L) / 100));
            CHECK(difference(end(0, L, form, weight * L), at_origin, L, weight * L) < 1e-7);
        }
    }
}
