// SPDX-License-Identifier: GPL-3.0-or-later
/// Metamorphic tests of evolving contacts: equivalent descriptions of a scene give the same motion.

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/solver/linear_solver.hpp"
#include "tests/support/evolving.hpp"
#include "tests/support/no_allocation.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::contact;
using namespace hilda::tests;

namespace {

/// The same surface with its function multiplied by `factor`; a negative factor reverses the gradient
class Multiplied final : public Surface {
public:
    Multiplied(std::shared_ptr<const Surface> surface, double factor)
        : surface(std::move(surface)), factor(factor)
    {}
    std::string name() const override { return "multiplied " + surface->name(); }
    double value(const Vec3& a) const override { return factor * surface->value(a); }
    Vec3 gradient(const Vec3& a) const override { return factor * surface->gradient(a); }
    Mat3 hessian(const Vec3& a) const override { return factor * surface->hessian(a); }
    double sigma() const override { return std::copysign(surface->sigma(), factor * surface->sigma()); }
    Vec3 project(const Vec3& a) const override { return surface->project(a); }
    double size() const override { return surface->size(); }

private:
    const std::shared_ptr<const Surface> surface;
    const double factor;
};

/// Description of the scene: frame, order and units
struct Description {
    Mat3 turn = Mat3::Identity();            ///< rotation of the whole scene
    Vec3 shift = Vec3::Zero();               ///< translation of the whole scene [m]
    bool swapped = false, reversed = false;  ///< order of the bodies of each contact; order of the contacts
    double factor_egg = 1, factor_bowl = 1;  ///< of the surface functions G
    double length = 1, mass = 1, time = 1;   ///< units
    lie::LinearSolver solver = lie::LinearSolver::automatic;
};

struct Result {
    Vec3 egg, ball;
    Mat3 A;
    std::array<double, 3> F_N;
};

/// An ellipsoid and a ball slide in a bowl in contact with each other: three contacts, 0.2 s. The result is
/// converted to the frame and units of the default description.
Result sliding(const Description& w, double h = 2e-3, double t_end = 0.2)
{
    const double l = w.length;
    ContactModel scene;
    scene.model.gravity = w.turn * Vec3(0, 0, -9.81 * l / (w.time * w.time));
    const Vec3 axes(0.5, 0.4, 0.3);
    Motion egg, ball;
    egg.A = lie::exp(Vec3(0.2, -0.1, 0.3));
    egg.r = Vec3(-0.5, 0.3, -1.6);
    ball.r = Vec3(0.5, 0.3, -1.6);
    for (Motion* b : {&egg, &ball}) {
        b->r = w.shift + l * (w.turn * b->r);
        b->A = w.turn * b->A;
    }
    egg.omega_bar = Vec3(0.3, 0.5, -0.4) / w.time;
    ball.rdot = w.turn * Vec3(0, 0.4, 0) * l / w.time;
    const double inertial = w.mass * l * l;
    scene.add("egg", 1.2 * w.mass, inertial * inertia(1.2, axes), egg);
    scene.add("ball", w.mass, inertial * 0.4 * 0.09 * Mat3::Identity(), ball);
    const auto multiplied = [](const Shape& shape, double factor) {
        return factor == 1 ? shape : Shape{std::make_shared<Multiplied>(shape.surface, factor)};
    };
    const Shape of_egg = multiplied(shape<Ellipsoid>(l * axes), w.factor_egg),
                of_ball = shape<Sphere>(0.3 * l);
    Shape bowl = multiplied(shape<Ellipsoid>(l * bowl_axes, true), w.factor_bowl);
    bowl.position = w.shift, bowl.orientation = w.turn;
    const auto add = [&](const std::string& name, int i, const Shape& shape_i, int j, const Shape& shape_j) {
        if (w.swapped)
            scene.add_contact(name, j, shape_j, i, shape_i);
        else
            scene.add_contact(name, i, shape_i, j, shape_j);
    };
    const std::array<std::function<void()>, 3> contacts{
        [&] { add("egg in bowl", 0, of_egg, dae::ground, bowl); },
        [&] { add("ball in bowl", 1, of_ball, dae::ground, bowl); },
        [&] { add("egg and ball", 0, of_egg, 1, of_ball); }};
    for (size_t k = 0; k < 3; ++k) contacts[w.reversed ? 2 - k : k]();
    scene.start(true);
    const auto integrator = lie::scheme("rA-half-1-momentum")
                                .make(scene.model, {.tolerance = 1e-15 * l, .linear_solver = w.solver});
    const lie::State x =
        lie::march(scene.x, *integrator, lie::TimeGrid::over(t_end * w.time, h * w.time, t_end * w.time))
            .row.back();
    Result result;
    result.egg = w.turn.transpose() * (x.body[0].r - w.shift) / l;
    result.ball = w.turn.transpose() * (x.body[1].r - w.shift) / l;
    result.A = w.turn.transpose() * x.body[0].A;
    for (size_t k = 0; k < 3; ++k)
        result.F_N[w.reversed ? 2 - k : k] =
            multipliers(scene.model, x, k).F_N * w.time * w.time / (w.mass * l);
    return result;
}

void check_same(const Result& a, const Result& b, double tolerance)
{
    CHECK((a.egg - b.egg).norm() < tolerance);
    CHECK((a.ball - b.ball).norm() < tolerance);
    CHECK((a.A - b.A).norm() < 10 * tolerance);
    // the rounding error of a multiplier is that of a position times m/h²
    for (int k = 0; k < 3; ++k) CHECK(std::abs(a.F_N[k] - b.F_N[k]) < 1e6 * tolerance);
}

}  // namespace

TEST_CASE("evolving contacts do not depend on frame, order and units (long)", "[contact][evolving]")
{
    const Result plain = sliding({});
    CHECK((plain.ball - Vec3(0.5, 0.3, -1.6)).norm() > 0.05);  // the ball has moved
    INFO("F_N " << plain.F_N[0] << ", " << plain.F_N[1] << ", " << plain.F_N[2]);
    constexpr double rounding = 3e-13;
    SECTION("a rotated frame")
    {
        check_same(plain, sliding({.turn = lie::exp(Vec3(0.7, -1.1, 0.4))}), rounding);
        check_same(plain, sliding({.turn = lie::exp(Vec3(1.5707963267948966, 0, 0))}), rounding);
    }
    SECTION("a translated frame") { check_same(plain, sliding({.shift = Vec3(3, -5, 8)}), 10 * rounding); }
    SECTION("bodies of each contact swapped") { check_same(plain, sliding({.swapped = true}), rounding); }
    SECTION("contacts in another order") { check_same(plain, sliding({.reversed = true}), rounding); }
    SECTION("surface functions multiplied by a factor")
    {
        check_same(plain, sliding({.factor_egg = 7, .factor_bowl = 0.2}), rounding);
    }
    SECTION("gradients reversed")
    {
        check_same(plain, sliding({.factor_egg = -1, .factor_bowl = -3}), rounding);
    }
    SECTION("units of length, mass and time")
    {
        check_same(plain, sliding({.length = 1e3}), rounding);
        check_same(plain, sliding({.length = 1e-3}), rounding);
        check_same(plain, sliding({.mass = 1e4}), rounding);
        check_same(plain, sliding({.time = 60}), rounding);
    }
    SECTION("the linear solver")
    {
        check_same(plain, sliding({.solver = lie::LinearSolver::klu}), rounding);
        check_same(plain, sliding({.solver = lie::LinearSolver::condensed}), rounding);
    }
}

TEST_CASE("four times the gravity at half the step gives the same motion bit for bit (long)",
          "[contact][evolving]")
{
    for (const char* scheme : {"rA-half-1", "rA-half-1-kick", "rA-half-1-momentum"}) {
        const auto run_with = [&](double g, double h) {
            BallInBowl scene(Vec3(0.93073643551905849, 1.3152971613841562, -1.1988698851259592));
            scene.model.gravity.z() = -g;
            scene.start();
            return run(scene, scheme, h, 200 * h);
        };
        const lie::State slow = run_with(9.81, 1.0 / 128), fast = run_with(4 * 9.81, 1.0 / 256);
        INFO(scheme);
        CHECK(slow.body[0].r == fast.body[0].r);
        CHECK(slow.alpha == fast.alpha);
        CHECK(2 * slow.body[0].rdot == fast.body[0].rdot);
        CHECK(4 * slow.lambda == fast.lambda);
    }
}

TEST_CASE("both linear solvers give the same motion of evolving contacts", "[contact][evolving][condensed]")
{
    for (const lie::Scheme& s : lie::schemes()) {
        if (!s.supports.contains(lie::Feature::algebraic)) continue;
        for (const Friction friction : {Friction::none, Friction::rolling}) {
            if (friction == Friction::rolling && !s.supports.contains(lie::Feature::nonholonomic)) continue;
            const auto at_end = [&](lie::LinearSolver solver) {
                BallInBowl scene(Vec3(0.93073643551905849, 1.3152971613841562, -1.1988698851259592),
                                 friction);
                return run(
                    scene, s.name.c_str(), 5e-3, 0.3, [](const lie::State&, long) {}, solver);
            };
            const lie::State a = at_end(lie::LinearSolver::klu), b = at_end(lie::LinearSolver::condensed);
            INFO(s.name);
            CHECK((a.body[0].r - b.body[0].r).norm() < 1e-12);
            CHECK((a.alpha - b.alpha).norm() < 1e-12);
            CHECK((a.lambda - b.lambda).norm() < 1e-7 * a.lambda.norm());
        }
    }
}

TEST_CASE("a step with evolving contacts does not allocate", "[contact][evolving][allocation]")
{
    if (!counts_allocations) {
        WARN("allocations are not counted under a sanitizer");
        return;
    }
    for (const lie::Scheme& s : lie::schemes())
        for (const lie::LinearSolver solver : {lie::LinearSolver::klu, lie::LinearSolver::condensed})
            for (const Friction friction : {Friction::none, Friction::rolling}) {
                if (!s.supports.contains(lie::Feature::algebraic) ||
                    (friction == Friction::rolling && !s.supports.contains(lie::Feature::nonholonomic)))
                    continue;
                BallInBowl scene(Vec3(0.93073643551905849, 1.3152971613841562, -1.1988698851259592),
                                 friction);
                const auto integrator = s.make(scene.model, {.linear_solver = solver});
                lie::State x = scene.x;
                const auto step = [&] {
                    lie::State before = x;
                    integrator->step(x, 1e-3);
                    return before;
                };
                for (int n = 0; n < 3; ++n) scene.model.accepted(step(), x);
                // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): the copy is measured
                const long of_copy = allocations_during([&] { const lie::State copy = x; });
                const long taken = allocations_during([&] {
                    for (int n = 0; n < 100; ++n) scene.model.accepted(step(), x);
                });
                INFO(s.name);
                CHECK(taken == 100 * of_copy);
            }
}
