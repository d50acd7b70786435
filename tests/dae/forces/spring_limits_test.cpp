// SPDX-License-Identifier: GPL-3.0-or-later
/// Stability limits of springs and dampers: closed forms, and the step at which a scheme becomes unstable.

#include "dae/forces/bushing.hpp"
#include "dae/forces/limits.hpp"
#include "dae/forces/spring_damper.hpp"
#include "dae/forces/torsion_spring.hpp"
#include "dae/joints.hpp"
#include "dae/model.hpp"
#include "dae/start.hpp"
#include "lie/check.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "tests/dae/axes.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::dae;
using namespace hilda::tests::axes;
using lie::LoadEvaluation;

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
struct OscillatingBody {
    Model model;
    State x;

    /// A body of mass m at (1.01, 0, 0) m, without gravity
    explicit OscillatingBody(double m)
    {
        model.gravity.setZero();
        model.add({.name = "body", .m = m, .J_bar = Vec3(1, 1, 1).asDiagonal()});
        x.body.resize(1);
        x.body[0].r = 1.01 * X;
    }
    /// Largest distance from the rest position in this number of steps, or infinity if a step fails
    double largest(const std::string& scheme, double h, int steps) const
    {
        const auto integrator = lie::scheme(scheme).make(model, {});
        State at = x;
        double most = 0;
        try {
            for (int n = 0; n < steps; ++n) {
                integrator->step(at, h);
                most = std::max(most, std::abs(at.body[0].r.x() - 1));
            }
        } catch (const lie::NumericalFailure&) {
            return infinite;
        }
        return most;
    }
};

/// The h with h² k w + beta h c w = 4
double root(double k, double c, double w, double beta)
{
    return 8 / (beta * c * w + std::sqrt(beta * beta * c * c * w * w + 16 * k * w));
}

}  // namespace

TEST_CASE("the limit of a spring-damper is the step at which the schemes become unstable (long)",
          "[dae][forces][stable]")
{
    const auto [k, c] = GENERATE(std::pair(1e6, 0.), std::pair(1e6, 500.), std::pair(10., 4e4));
    constexpr double m = 2;
    OscillatingBody o(m);
    o.model.load(SpringDamper(ground, O, 0, O, k, c, 1));
    start(o.model, o.x);
    const Force& spring = *o.model.forces()[0];
    CHECK(spring.spring_limits.at_step == Approx(root(k, c, 1 / m, 2)).epsilon(1e-9));
    CHECK(spring.spring_limits.extrapolated == Approx(root(k, c, 1 / m, 4)).epsilon(1e-9));
    CHECK(o.model.stable_step(o.x, LoadEvaluation::implicit).force == -1);
    for (const char* name : {"rA-half-1", "rA-half-1-kick", "rA-half-1-momentum", "rA-half-2-bdf2"}) {
        const double limit = o.model.stable_step(o.x, lie::scheme(name).loads).h;
        CAPTURE(name, k, c, limit);
        CHECK(o.largest(name, 0.98 * limit, 3000) < 0.2);
        CHECK(o.largest(name, 1.02 * limit, 3000) > 1);  // from 0.01; the spring has no negative length
    }
}

TEST_CASE("the limit of a spring uses the effective mass of the constrained bodies", "[dae][forces][stable]")
{
    OscillatingBody o(3);
    o.x.body[0].r = Vec3(0, 0, -0.5);
    o.model.constrain("hinge", revolute(ground, O, X, 0, 0.5 * Z, X));
    constexpr double k = 700, J = 1 + 3 * 0.25;  // about the hinge
    o.model.load(TorsionSpring(ground, X, 0, X, k, 0, 0, o.x));
    o.model.load(SpringDamper(ground, Vec3(0, 1, -0.5), 0, O, k, 0, 1));  // lever arm 0.5 m
    o.model.load(SpringDamper(ground, Vec3(1, 0, -0.5), 0, O, k, 0, 1));  // along the axis of the hinge
    o.model.load(SpringDamper(ground, Vec3(0, 0, -2), 0, O, k, 0, 1));    // through the hinge
    start(o.model, o.x);
    const auto& force = o.model.forces();
    CHECK(force[0]->stable_step(o.x) == Approx(2 / std::sqrt(k / J)).epsilon(1e-9));
    CHECK(force[1]->stable_step(o.x) == Approx(2 / std::sqrt(k * 0.25 / J)).epsilon(1e-9));
    CHECK(force[2]->stable_step(o.x) == infinite);
    CHECK(force[3]->stable_step(o.x) == infinite);
    CHECK(o.model.stable_step(o.x).force == 0);
}

TEST_CASE("the limit of an actuator contains the derivatives of its law", "[dae][forces][stable]")
{
    OscillatingBody o(2);
    o.x.body[0].rdot = 0.5 * X;
    o.model.load(SpringDamper(ground, O, 0, O, 100, 0, 1,
                              io::Expression("300*(l - 1) + 40*ldot^3", {"l", "ldot", "t"})));
    start(o.model, o.x);
    CHECK(o.model.forces()[0]->stable_step(o.x) == Approx(root(400, 120 * 0.25, 0.5, 2)).epsilon(1e-6));
}

TEST_CASE("the limit of a bushing is that of its stiffest direction", "[dae][forces][stable]")
{
    OscillatingBody o(2);
    const Bushing::Coefficients soft{.stiffness = Vec3(1e3, 2e3, 8e3),
                                     .rotational_stiffness = Vec3(1e3, 1e3, 2e3)},
        hard{.stiffness = Vec3(1e3, 2e3, 8e3), .rotational_stiffness = Vec3(1e3, 1e3, 9e3)};
    o.model.load(Bushing(ground, 1.01 * X, 0, O, soft, o.x));
    o.model.load(Bushing(ground, 1.01 * X, 0, O, hard, o.x));
    start(o.model, o.x);
    CHECK(o.model.forces()[0]->stable_step(o.x) == Approx(2 / std::sqrt(8e3 / 2)).epsilon(1e-9));
    CHECK(o.model.forces()[1]->stable_step(o.x) == Approx(2 / std::sqrt(9e3 / 1)).epsilon(1e-9));
}

TEST_CASE("a limit of a distance or an angle limits the step while it is exceeded", "[dae][forces][stable]")
{
    OscillatingBody o(2);
    o.model.load(DistanceLimit(ground, O, 0, O, {.maximum = 1.02, .stiffness = 5e5}));
    o.model.load(AngleLimit(ground, X, 0, X, {.maximum = 0.1, .stiffness = 5e5}, o.x));
    start(o.model, o.x);
    CHECK(o.model.stable_step(o.x).force == -1);
    o.x.body[0].r.x() = 1.03;
    o.x.body[0].A = lie::exp(0.2 * X);
    CHECK(o.model.forces()[0]->stable_step(o.x) == Approx(2 / std::sqrt(5e5 / 2)).epsilon(1e-9));
    CHECK(o.model.forces()[1]->stable_step(o.x) == Approx(2 / std::sqrt(5e5)).epsilon(1e-9));
    CHECK_FALSE(o.model.forces()[0]->is_stable(o.x, 5e-3, LoadEvaluation::at_step, {}));
    CHECK(o.model.forces()[0]->is_stable(o.x, 3e-3, LoadEvaluation::at_step, {}));
}
