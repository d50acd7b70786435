// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes of rigid bodies with rigid contacts, as a differential variational inequality.
#include "contact/scenes/dvi/dvi_scene.hpp"
#include "contact/scenes/dvi/half_step_momentum.hpp"
#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"
#include "tests/support/no_allocation.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

#include <numbers>

using namespace hilda;
using contact::DviOptions;
using contact::DviScene;
using contact::Inertia;
using contact::Shape;
using lie::Mat3;
using lie::Motion;
using lie::Vec3;
using tests::Random;

namespace {

constexpr double g = 9.81;

Inertia ball(double m, double R) { return {m, 0.4 * m * R * R * Mat3::Identity()}; }
Shape sphere(double R) { return {std::make_shared<contact::Sphere>(R)}; }
const Shape plane{std::make_shared<contact::Plane>()};

Motion at(const Vec3& r, const Vec3& rdot = Vec3::Zero())
{
    Motion m;
    m.r = r;
    m.rdot = rdot;
    return m;
}

/// A ball of 2 kg and radius 0.3 m on a floor
DviScene on_floor(const Vec3& v, double mu, double height = 0)
{
    DviScene scene;
    scene.add(ball(2, 0.3), at({0, 0, 0.3 + height}, v));
    scene.add(Inertia{}, Motion{});
    scene.add("floor", 0, sphere(0.3), 1, plane, {.mu = mu});
    scene.options.sliding = DviOptions::coulomb;
    scene.solver.tolerance = 1e-12;
    return scene;
}

void run(DviScene& scene, double h, double end)
{
    for (int n = 0; n < std::lround(end / h); ++n) scene.step(h);
}

}  // namespace

TEST_CASE("a ball at rest stays at rest and its weight is the normal force", "[contact][dvi][scene]")
{
    DviScene scene = on_floor(Vec3::Zero(), 0.4);
    run(scene, 1e-2, 1);
    CHECK((scene.body[0].r - Vec3(0, 0, 0.3)).norm() < 1e-14);
    CHECK(scene.pair[0].state.N() == Approx(2 * g).epsilon(1e-10));  // error of F: mass times tolerance/h
}

TEST_CASE("a ball that starts to slide ends rolling at five sevenths of its speed", "[contact][dvi][scene]")
{
    const auto sliding = GENERATE(DviOptions::lagged, DviOptions::coulomb);
    const double mu = 0.25, v0 = 2, h = 2e-3;
    DviScene scene = on_floor({v0, 0, 0}, mu);
    scene.options.sliding = sliding;
    run(scene, h, 0.1);  // sliding ends at 2 v0/(7 μ g) = 0.233 s
    const double t_half = 0.1 - 0.5 * h;
    CHECK(scene.body[0].rdot.x() == Approx(v0 - mu * g * t_half).epsilon(1e-4));
    CHECK(scene.body[0].omega_bar.y() == Approx(2.5 * mu * g * t_half / 0.3).epsilon(1e-4));
    CHECK(scene.pair[0].state.F.x() == Approx(-mu * 2 * g).epsilon(1e-4));
    run(scene, h, 0.4);
    CHECK(scene.body[0].rdot.x() == Approx(5. / 7 * v0).epsilon(1e-5));  // sliding ends within a step
    CHECK(0.3 * scene.body[0].omega_bar.y() == Approx(scene.body[0].rdot.x()).epsilon(1e-6));
    CHECK(std::abs(scene.body[0].r.z() - 0.3) < 2e-6);
    CHECK(std::abs(scene.pair[0].state.F.x()) < 1e-6);
}

TEST_CASE("by default a sliding ball stays on the floor", "[contact][dvi][scene]")
{
    const double mu = 0.3, v0 = 3, h = GENERATE(1e-2, 1e-3);
    DviScene scene;
    scene.add(ball(2, 0.3), at({0, 0, 0.3}, {v0, 0, 0}));
    scene.add(Inertia{}, Motion{});
    scene.add("floor", 0, sphere(0.3), 1, plane, {.mu = mu});
    run(scene, h, 0.2);  // sliding ends at 2 v0/(7 μ g) = 0.291 s
    CHECK(std::abs(scene.body[0].r.z() - 0.3) < 1e-7);
    CHECK(scene.body[0].rdot.x() == Approx(v0 - mu * g * (0.2 - 0.5 * h)).margin(1e-5));
}

TEST_CASE("the relaxed law lifts a sliding ball, which ends in the same rolling", "[contact][dvi][scene]")
{
    const double mu = 0.25, v0 = 2, h = 2e-3;
    DviScene scene = on_floor({v0, 0, 0}, mu);
    scene.options.sliding = DviOptions::convex;
    scene.step(h);
    // closed form of one step: b = (v0 - 3.5 μ g h/2)/(1 + 3.5 μ²) is the remaining slip, u_n = μ b
    const double b = (v0 - 3.5 * mu * 0.5 * g * h) / (1 + 3.5 * mu * mu);
    CHECK(scene.body[0].rdot.z() == Approx(mu * b).epsilon(1e-10));
    run(scene, h, 1);
    // friction has no moment about the floor, except by the gap of h μ |u_t| at which it acts
    CHECK(scene.body[0].rdot.x() == Approx(5. / 7 * v0).epsilon(h * mu * v0 / 0.3));
}

TEST_CASE("a ball on an incline rolls if the friction coefficient is sufficient and slides otherwise",
          "[contact][dvi][scene]")
{
    // rolling on an incline requires tan α < 3.5 μ
    const double alpha = 0.3;
    DviScene scene = on_floor(Vec3::Zero(), 0.12);
    scene.gravity = g * Vec3(std::sin(alpha), 0, -std::cos(alpha));
    const double h = 1e-3;
    run(scene, h, 0.5);
    const double a = 5. / 7 * g * std::sin(alpha);
    CHECK(scene.body[0].rdot.x() == Approx(a * (0.5 - h / 2)).epsilon(1e-10));
    CHECK(scene.body[0].r.x() == Approx(0.5 * a * 0.25).epsilon(1e-10));
    CHECK(scene.pair[0].state.F.x() == Approx(-2. / 7 * 2 * g * std::sin(alpha)).epsilon(1e-9));

    DviScene slides = on_floor(Vec3::Zero(), 0.05);
    slides.gravity = scene.gravity;
    run(slides, h, 0.5);
    const double slower = g * (std::sin(alpha) - 0.05 * std::cos(alpha));
    CHECK(slides.body[0].r.x() == Approx(0.5 * slower * 0.25).epsilon(1e-4));
}

TEST_CASE("a ball in a groove has the wall forces of a wedge", "[contact][dvi][scene]")
{
    // walls at 50 degrees: F_N = m g / (2 cos 50°)
    DviScene scene;
    const double beta = 50 * std::numbers::pi / 180, R = 0.5, mu = GENERATE(0., 0.3);
    scene.add(ball(1, R), at({0, 0, R / std::cos(beta)}));
    scene.add(Inertia{}, Motion{});
    for (const int side : {-1, 1}) {
        Shape wall = plane;
        wall.orientation = lie::exp(Vec3(side * beta, 0, 0));
        scene.add(side < 0 ? "left" : "right", 0, sphere(R), 1, wall, {.mu = mu});
    }
    scene.options.sliding = DviOptions::convex;  // nothing slides
    scene.solver.tolerance = 1e-14;
    run(scene, 5e-3, 0.5);
    if (mu > 0) {  // the wall forces are indeterminate; only their sum is known
        CHECK((scene.pair[0].state.F + scene.pair[1].state.F).z() == Approx(g).epsilon(1e-11));
        CHECK(scene.pair[0].state.N() == Approx(scene.pair[1].state.N()).epsilon(1e-11));
    } else
        for (const auto& p : scene.pair) CHECK(p.state.N() == Approx(7.630825370750323).epsilon(1e-11));
    CHECK((scene.body[0].r - Vec3(0, 0, R / std::cos(beta))).norm() < 1e-13);
}

TEST_CASE("a falling ball rebounds with the coefficient of restitution", "[contact][dvi][scene]")
{
    const double e = GENERATE(0., 0.5, 1.), h = 1e-3;
    DviScene scene;
    scene.add(ball(2, 0.3), at({0, 0, 0.3}, {0, 0, -3}));
    scene.add(Inertia{}, Motion{});
    scene.add("floor", 0, sphere(0.3), 1, plane, {.mu = 0.2, .restitution = e});
    scene.solver.tolerance = 1e-13;
    scene.step(h);
    CHECK(scene.body[0].rdot.z() == Approx(3 * e).margin(1e-12));
    run(scene, h, 0.1);
    // ballistic flight from the end of the step with the impact
    if (e > 0)
        CHECK(scene.body[0].r.z() ==
              Approx(0.3 + 3 * e * (0.1 + h) - 0.5 * g * 0.1 * (0.1 + h)).epsilon(1e-12));
    else
        CHECK(scene.body[0].r.z() == Approx(0.3).epsilon(1e-12));
}

TEST_CASE("a contact that is not closed has no effect, also without friction", "[contact][dvi][scene]")
{
    const double mu = GENERATE(0., 1e-300, 1e-8, 0.3, 1e8), h = 1e-3;
    DviScene scene = on_floor(Vec3::Zero(), mu, 0.5);
    for (int n = 0; n < 300; ++n) {  // it reaches the floor after 319 steps
        scene.step(h);
        REQUIRE(scene.pair[0].state.F == Vec3::Zero());
    }
    CHECK(scene.body[0].rdot.z() == Approx(-g * 299.5 * h).epsilon(1e-12));
}

TEST_CASE("a row of balls without friction keeps its momentum and never gains energy",
          "[contact][dvi][scene]")
{
    const double e = GENERATE(0., 0.5, 1.), h = 1e-3, R = 0.1;
    DviScene scene;
    scene.gravity.setZero();
    scene.solver.tolerance = 1e-12;
    for (int b = 0; b < 5; ++b)
        scene.add(ball(1, R), at({2 * R * b + (b == 0 ? -0.0205 : 0), 0, 0}, {b == 0 ? 1. : 0., 0, 0}));
    for (int b = 0; b + 1 < 5; ++b)
        scene.add("balls", b, sphere(R), b + 1, sphere(R), {.mu = 0, .restitution = e});
    double energy = scene.kinetic_energy();
    for (int n = 0; n < 100; ++n) {
        scene.step(h);
        for (const DviScene::Pair& p : scene.pair) REQUIRE(p.state.N() >= 0);
        REQUIRE(scene.kinetic_energy() <= energy * (1 + 1e-10));
        energy = scene.kinetic_energy();
    }
    Vec3 momentum = Vec3::Zero();
    for (const Motion& b : scene.body) momentum += b.rdot;
    CHECK((momentum - Vec3(1, 0, 0)).norm() < 1e-12);
    CHECK((e < 1 ? energy < 0.5 : energy == Approx(0.5).epsilon(1e-9)));
}

TEST_CASE("a ball does not stop above the floor and does not pass through it", "[contact][dvi][scene]")
{
    DviScene scene = on_floor(Vec3(0, 0, -1), 0, 0.0137);
    run(scene, 4e-3, 0.1);
    CHECK(scene.body[0].r.z() == Approx(0.3).epsilon(1e-12));
}

namespace {

/// Centre [m] of a ball of 1 kg and radius 0.5 m in the bowl with the semi-axes 4, 3 and 2 m at 0, 0.1, ... 2
/// s. It slides without friction from rest at the contact point (1, 1.5). From a reduced ODE in two
/// coordinates of the contact point, integrated to 2e-12 m.
const Vec3 slides[] = {{0.930736435519058, 1.31529716138416, -1.19886988512596},
                       {0.924494246342734, 1.29866833053719, -1.20642919212852},
                       {0.905787828810182, 1.24904030815781, -1.2282240766992},
                       {0.8746996571035, 1.16725055627048, -1.26175535244454},
                       {0.831428832847401, 1.05486208854637, -1.30331216277747},
                       {0.776350961661478, 0.914305849744768, -1.34851743491031},
                       {0.710059444747112, 0.748941708688194, -1.39288442554664},
                       {0.633378016333198, 0.563010559909175, -1.43228718125279},
                       {0.54734789799856, 0.361495866374374, -1.46330156826738},
                       {0.45319926499623, 0.149932203351168, -1.48341932597756},
                       {0.352316278950847, -0.0658058703560117, -1.49116159294696},
                       {0.246201313053703, -0.279715287598117, -1.48612203407318},
                       {0.136440196416921, -0.48586972186147, -1.46896099076816},
                       {0.0246677855133555, -0.67861855073704, -1.44135833243952},
                       {-0.0874676411925535, -0.852778794394907, -1.40591869125113},
                       {-0.198341713329763, -1.00381245027653, -1.36601193692102},
                       {-0.306390991116619, -1.12797149456785, -1.32552797837888},
                       {-0.410144185447409, -1.22238513128839, -1.28853309904525},
                       {-0.508239651301733, -1.28506729982669, -1.25883857287131},
                       {-0.599422736070369, -1.31484398878456, -1.23952857417357},
                       {-0.68252388691413, -1.31123546459089, -1.23253041628573}};

/// Largest errors of a run of 2 s at those times
struct InBowl {
    double error = 0, gap = 0, N = 0;
    int iterations = 0;

    InBowl(double h, const DviOptions& options)
    {
        DviScene scene;
        scene.options = options;
        scene.solver.tolerance = 1e-13;
        scene.add(ball(1, 0.5), at(slides[0]));
        scene.add(Inertia{}, Motion{});
        scene.add("bowl", 0, sphere(0.5), 1, {std::make_shared<contact::Ellipsoid>(Vec3(4, 3, 2), true)}, {});
        const int sampled = static_cast<int>(std::lround(0.1 / h));
        for (int k = 1; k <= 20; ++k) {
            for (int n = 0; n < sampled; ++n) {
                scene.step(h);
                gap = std::max(gap, std::abs(scene.pair[0].state.contact_point.gap));
                iterations += scene.outcome.iterations;
            }
            error = std::max(error, (scene.body[0].r - slides[k]).norm());
        }
        scene.step(h);  // from the node at 2 s
        N = scene.pair[0].state.N();
    }
};

}  // namespace

TEST_CASE("a ball in a bowl converges to the reduced equations with second order in the step",
          "[contact][dvi][bowl][order]")
{
    const InBowl a(5e-3, {}), b(2.5e-3, {});
    INFO("errors " << a.error << ", " << b.error << " m; gaps " << a.gap << ", " << b.gap << " m");
    CHECK(a.error == Approx(1.6e-5).margin(0.05e-5));
    CHECK(a.gap == Approx(1.6e-5).margin(0.05e-5));
    CHECK(std::log2(a.error / b.error) == Approx(2).margin(0.03));
    CHECK(a.N == Approx(9.1922792041740102).epsilon(1e-4));
}

TEST_CASE("without stabilisation a ball in a bowl drifts, and without the half kick an order is lost",
          "[contact][dvi][bowl][order]")
{
    const InBowl drifting(5e-3, {.stabilised = false}), finer(2.5e-3, {.stabilised = false});
    CHECK(drifting.error == Approx(4.0e-3).margin(0.05e-3));
    CHECK(drifting.gap == Approx(3.7e-3).margin(0.05e-3));
    CHECK(std::log2(drifting.error / finer.error) == Approx(1).margin(0.03));

    const InBowl text(5e-3, {.half_kick = false}), half(2.5e-3, {.half_kick = false});
    CHECK(text.error == Approx(6e-3).margin(0.05e-3));
    CHECK(std::log2(text.error / half.error) == Approx(1).margin(0.03));
}

TEST_CASE("a torque-free body conserves angular momentum exactly and its motion is of second order",
          "[contact][dvi][scene][order]")
{
    const Vec3 J(0.1, 0.25, 0.3), omega(3, 0.1, 0.2);
    const auto after = [&](double h) {
        DviScene scene;
        scene.gravity.setZero();
        Motion m;
        m.omega_bar = omega;
        scene.add({2, J.asDiagonal()}, m);
        const Vec3 L = J.cwiseProduct(omega);
        run(scene, h, 1);
        const Motion& b = scene.body[0];
        // the angular momentum of the last step at its last node
        const Vec3 L_end = b.A * contact::node_momentum(-h * b.omega_bar, J.cwiseProduct(b.omega_bar));
        CHECK((L_end - L).norm() < 1e-13);
        return b.A;
    };
    const Mat3 a = after(4e-2), b = after(2e-2), c = after(1e-2);
    CHECK(std::log2((a - b).norm() / (b - c).norm()) == Approx(2).margin(0.1));
}

TEST_CASE("bodies that collide conserve momentum and angular momentum", "[contact][dvi][scene]")
{
    Random random(11);
    DviScene scene;
    scene.gravity.setZero();
    scene.solver.tolerance = 1e-12;
    const Vec3 axes(0.3, 0.25, 0.2);
    const Shape egg{std::make_shared<contact::Ellipsoid>(axes)};
    const Inertia inertia{1, Vec3(0.2, 0.26, 0.3).asDiagonal()};
    for (int b = 0; b < 2; ++b) {
        Motion m = random.motion();
        m.r = Vec3(b == 0 ? -0.4 : 0.4, 0.1 * b, 0);
        m.rdot = Vec3(b == 0 ? 1 : -1, 0.2, 0.1);
        scene.add(inertia, m);
    }
    scene.add("eggs", 0, egg, 1, egg, {.mu = 0.5, .restitution = 0.3});
    const auto momenta = [&](double h) {
        Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
        for (const Motion& b : scene.body) {
            const Vec3 L = b.A * contact::node_momentum(-h * b.omega_bar, inertia.J_bar * b.omega_bar);
            sum.head<3>() += inertia.m * b.rdot;
            sum.tail<3>() += L + b.r.cross(inertia.m * b.rdot);
        }
        return sum;
    };
    const auto first = momenta(0);
    const double before = scene.kinetic_energy(), h = 2e-3;
    bool struck = false;
    for (int n = 0; n < 300; ++n) {
        scene.step(h);
        struck = struck || scene.pair[0].state.N() > 0;
    }
    CHECK(struck);
    CHECK(scene.kinetic_energy() < before);
    const auto last = momenta(h);
    CHECK((last.head<3>() - first.head<3>()).norm() < 1e-13);
    // forces act at the middle of the gap on both bodies, so angular momentum is conserved for any gap
    CHECK((last.tail<3>() - first.tail<3>()).norm() < 1e-12);
}

TEST_CASE("a row of balls shares one impulse, with contacts that are listed or found by the neighbour list",
          "[contact][dvi][scene]")
{
    const bool found = GENERATE(false, true);
    DviScene scene;
    scene.solver.tolerance = 1e-12;
    const double R = 0.1;
    if (found) {
        const int kind = scene.add(contact::BodyType{ball(1, R), sphere(R), R});
        const int floor = scene.add(contact::BodyType{{}, plane});
        scene.neighbors.margin = 0.02;
        scene.set_contact_law("balls", kind, kind, {.mu = 0});
        scene.set_contact_law("floor", floor, kind, {.mu = 0.3});
        for (int b = 0; b < 5; ++b) scene.add_body(kind, at({2 * R * b, 0, R}, {b == 0 ? 1. : 0., 0, 0}));
        scene.add_body(floor, Motion{});
    } else {
        for (int b = 0; b < 5; ++b) scene.add(ball(1, R), at({2 * R * b, 0, R}, {b == 0 ? 1. : 0., 0, 0}));
        scene.add(Inertia{}, Motion{});
        for (int b = 0; b + 1 < 5; ++b) scene.add("balls", b, sphere(R), b + 1, sphere(R), {.mu = 0});
        for (int b = 0; b < 5; ++b) scene.add("floor", b, sphere(R), 5, plane, {.mu = 0.3});
    }
    scene.step(1e-3);
    CHECK(scene.contacts() == 9);
    // inelastic: all five balls move on together; friction spins them
    double sum = 0;
    for (int b = 0; b < 5; ++b) sum += scene.body[b].rdot.x();
    for (int b = 0; b < 5; ++b) CHECK(scene.body[b].rdot.x() == Approx(sum / 5).epsilon(1e-9));
    CHECK(sum < 1);
    CHECK(sum > 0.9);
    run(scene, 1e-3, 0.3);
    for (int b = 0; b < 5; ++b) CHECK(std::abs(scene.body[b].r.z() - R) < 1e-5);
}

TEST_CASE("a step that fails does not change the bodies", "[contact][dvi][scene]")
{
    DviScene scene = on_floor({2, 0, 0}, 0.3);
    run(scene, 1e-3, 0.01);
    const Motion before = scene.body[0];
    scene.solver.tolerance = 1e-300;
    scene.solver.max_iterations = 20;
    CHECK_THROWS_AS(scene.step(1e-3), contact::ConeNoConvergence);
    CHECK(scene.body[0].r == before.r);
    CHECK(scene.body[0].rdot == before.rdot);
    scene.solver.tolerance = 1e-12;
    scene.step(1e-3);
    CHECK(scene.t == Approx(0.011));
}

TEST_CASE("a rigid scene rejects invalid input", "[contact][dvi][scene]")
{
    DviScene scene;
    const int b = scene.add(ball(1, 0.1), Motion{}), ground = scene.add(Inertia{}, Motion{});
    const Shape s = sphere(0.1);
    CHECK_THROWS_WITH(scene.add("c", b, s, ground, plane, {.mu = -1}),
                      "contact 'c': mu must not be negative, got -1");
    CHECK_THROWS_WITH(scene.add("c", b, s, ground, plane, {.restitution = 1.5}),
                      "contact 'c': the coefficient of restitution must be in [0, 1], got 1.5");
    CHECK_THROWS_WITH(scene.add("c", b, s, 7, plane, {}), "contact::DviScene: no body has this index, got 7");
    CHECK_THROWS_WITH(scene.add("c", b, s, b, plane, {}),
                      "contact::DviScene: a contact needs two different bodies, got 0");
    const int other = scene.add(Inertia{}, Motion{});
    CHECK_THROWS_WITH(scene.add("c", other, s, ground, plane, {}),
                      "contact 'c': a contact needs at least one movable body, got two fixed bodies");
    CHECK_THROWS_WITH(scene.step(0), "contact::DviScene: the step must be positive, got 0");
    CHECK_THROWS_WITH(scene.add({-1, Mat3::Identity()}, Motion{}),
                      "contact::DviScene: the mass of a body must be positive, got -1");
}

TEST_CASE("a step of a rigid scene does not allocate", "[contact][dvi][allocation]")
{
    if (!tests::counts_allocations) {
        WARN("allocations are not counted under a sanitizer");
        return;
    }
    DviScene scene;
    scene.options.sliding = DviOptions::coulomb;
    const int kind = scene.add(contact::BodyType{ball(1, 0.1), sphere(0.1), 0.1});
    const int floor = scene.add(contact::BodyType{{}, plane});
    scene.neighbors.margin = 0.02;
    scene.set_contact_law("balls", kind, kind, {.mu = 0.3});
    scene.set_contact_law("floor", kind, floor, {.mu = 0.3});
    scene.add_body(floor, Motion{});
    Random random(12);
    for (int b = 0; b < 12; ++b) {
        const int column = b % 3, row = b / 3;
        scene.add_body(kind, at(Vec3(0.22 * column, 0.22 * row, 0.1), random.vector(0.5)));
    }
    const auto go = [&] {
        for (int n = 0; n < 100; ++n) scene.step(1e-3);
    };
    go();
    int most = scene.contacts();
    const long taken = tests::allocations_during(go);
    CHECK(most > 10);
    CHECK(taken == 0);
}
