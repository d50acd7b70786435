// SPDX-License-Identifier: GPL-3.0-or-later
/// Functions of surfaces and contact laws that contradict differences.

#include "contact/derivative_check.hpp"
#include "contact/compliant/contact_force.hpp"
#include "contact/compliant/contact_group.hpp"
#include "contact/evolving/contact.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"
#include "dae/model.hpp"
#include "dae/start.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::contact;
using Catch::Contains;

namespace {

constexpr double R = 0.2, k = 1e5, c = 10, mu = 0.4, K = 1e4;

/// A sphere. Each factor multiplies one function; 1 is right.
struct SurfaceFactors {
    double gradient = 1, hessian = 1, support = 1, together = 1;
};

class Ball final : public Surface {
public:
    explicit Ball(const SurfaceFactors& by) : by(by) {}
    std::string name() const override { return "ball"; }
    double value(const Vec3& a) const override { return 0.5 * (a.squaredNorm() / R - R); }
    Vec3 gradient(const Vec3& a) const override { return by.gradient * a / R; }
    Mat3 hessian(const Vec3&) const override { return by.hessian / R * Mat3::Identity(); }
    Derivatives derivatives(const Vec3& a) const override
    {
        return {value(a), by.together * gradient(a), hessian(a)};
    }
    bool convex() const override { return true; }
    std::optional<Vec3> support(const Vec3& u) const override { return by.support * R * u; }
    Vec3 project(const Vec3& a) const override { return R * a.normalized(); }
    double size() const override { return R; }

private:
    const SurfaceFactors by;
};

struct LawFactors {
    double stiffness = 1, damping = 1, energy = 1, of_curvature = 0;
};

class Spring final : public NormalLaw {
public:
    explicit Spring(const LawFactors& by) : by(by) {}
    double force(const NormalInput& p) const override
    {
        return (k + by.of_curvature * p.curvature) * p.overlap + c * p.overlap_rate;
    }
    double stiffness(const NormalInput& p) const override
    {
        return by.stiffness * (k + by.of_curvature * p.curvature);
    }
    double damping(const NormalInput&) const override { return by.damping * c; }
    double energy(const NormalInput& p) const override
    {
        return by.energy * (k + by.of_curvature * p.curvature) * p.overlap * p.overlap / 2;
    }

private:
    const LawFactors by;
};

/// F = sign (K S + D s), limited to mu N
class Friction final : public FrictionModel {
public:
    explicit Friction(double sign, double declared = 1) : sign(sign), declared(declared) {}
    void advance(const ContactState&, Deflections&) const override {}
    Wrench load(const ContactState& now, const Rates& rates, const Deflections& at) const override
    {
        Wrench out;
        out.F = sign * (K * tangent(at.S, now.slip.n, now.slip.u) + c * rates.s);
        if (const double F = out.F.norm(); F > mu * now.N) out.F *= mu * now.N / F;
        return out;
    }
    Springs springs(const ContactState&) const override
    {
        return {.K_slide = declared * K, .D_slide = declared * c};
    }

private:
    const double sign, declared;
};

Shape ball(const SurfaceFactors& by) { return {.surface = std::make_shared<Ball>(by)}; }
Shape floor() { return {.surface = std::make_shared<Plane>()}; }

/// The findings of a start of a ball above a floor
std::vector<std::string> findings(const Shape& surface, std::shared_ptr<const NormalLaw> law,
                                  std::shared_ptr<const FrictionModel> friction)
{
    dae::Model model;
    model.gravity = {0, 0, -9.81};
    model.add({.name = "ball", .m = 1, .J_bar = 0.4 * R * R * Mat3::Identity()});
    model.load(std::make_unique<ContactForce>("ball-floor", model, 0, surface, dae::ground, floor(),
                                              std::move(law), std::move(friction)));
    lie::State x;
    x.body.resize(1);
    x.body[0].r = {0, 0, 1.1 * R};
    return start(model, x).warnings;
}

void one_finding(const std::vector<std::string>& found, const std::string& text)
{
    CAPTURE(text, found);
    REQUIRE(found.size() == 1);
    CHECK_THAT(found[0], Contains("contact 'ball-floor'") && Contains(text));
}

}  // namespace

TEST_CASE("functions of a surface that contradict differences are named", "[contact][start]")
{
    const auto spring = std::make_shared<Spring>(LawFactors{});
    const auto with = [&](const SurfaceFactors& by) { return findings(ball(by), spring, frictionless()); };
    CHECK(with({}).empty());
    one_finding(with({.gradient = 1.01, .hessian = 1.01}), "of the gradient is ");
    one_finding(with({.hessian = 1.01}), "of the Hessian is ");
    one_finding(with({.together = 2}), "gradient of derivatives() is ");
    one_finding(with({.support = -1}), "rad from the direction of the support point");
    one_finding(with({.support = 1.01}), "the support point is 0.001");
}

TEST_CASE("functions of a normal law that contradict differences are named", "[contact][start]")
{
    const auto with = [&](const LawFactors& by) {
        return findings(ball({}), std::make_shared<Spring>(by), frictionless());
    };
    CHECK(with({}).empty());
    one_finding(with({.stiffness = 0.5}), "stiffness is 5e+04, differences of force have 1e+05");
    one_finding(with({.damping = 0}), "damping is 0, differences of force have 10");
    one_finding(with({.energy = 2}), ", differences of energy have ");
    one_finding(with({.of_curvature = 1000}),
                "force depends on the curvature, but needs_curvature() is false");
}

TEST_CASE("the laws of a group of contacts are compared as well, also if no pair is near", "[contact][start]")
{
    for (const double distance : {2 * R, 100 * R}) {
        dae::Model model;
        lie::State x;
        for (const char* name : {"a", "b"}) {
            model.add({.name = name, .m = 1, .J_bar = 0.4 * R * R * Mat3::Identity()});
            x.body.emplace_back().r.x() = model.bodies() * distance;
        }
        ContactPairs pairs;
        pairs.first = pairs.second = {0, 1};
        pairs.each_two = pairs.is_group = true;
        pairs.index();
        model.load(std::make_unique<ContactGroup>("balls", model, pairs, ball({}), ball({}),
                                                  std::make_shared<Spring>(LawFactors{.stiffness = 0.5}),
                                                  frictionless()));
        const std::vector<std::string> found = start(model, x).warnings;
        CAPTURE(distance, found);
        REQUIRE(found.size() == 1);
        CHECK_THAT(found[0], Contains("contact 'balls: a-b'") && Contains("stiffness is 5e+04"));
    }
}

TEST_CASE("springs of a friction law that contradict its loads are named", "[contact][start]")
{
    const auto with = [&](double sign, double declared) {
        return findings(ball({}), std::make_shared<Spring>(LawFactors{}),
                        std::make_shared<Friction>(sign, declared));
    };
    CHECK(with(1, 1).empty());
    for (const double sign : {-1., 2.}) {
        const std::vector<std::string> found = with(sign, 1);
        CAPTURE(sign);
        REQUIRE(found.size() == 2);
        CHECK_THAT(found[0], Contains("K_slide of springs() is 1e+04, differences of load() have "));
        CHECK_THAT(found[1], Contains("D_slide of springs() is 10, differences of load() have "));
    }
}

TEST_CASE("the surfaces of an evolving contact are compared with differences", "[contact][start]")
{
    dae::Model model;
    model.gravity = {0, 0, -9.81};
    model.add({.name = "ball", .m = 1, .J_bar = 0.4 * R * R * Mat3::Identity()});
    model.constrain("ball-floor",
                    std::make_unique<EvolvingContact>(0, ball({.hessian = 1.01}), dae::ground, floor()));
    lie::State x;
    x.body.resize(1);
    x.body[0].r = {0, 0, R};
    one_finding(start(model, x).warnings, "of the Hessian is ");
}
