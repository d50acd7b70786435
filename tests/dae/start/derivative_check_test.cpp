// SPDX-License-Identifier: GPL-3.0-or-later
/// Functions of constraints and forces that contradict differences.
#include "dae/start/derivative_check.hpp"

#include "dae/block.hpp"
#include "dae/force.hpp"
#include "dae/forces/spring_damper.hpp"
#include "dae/model.hpp"
#include "dae/start.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::dae;
using Catch::Contains;

namespace {

/// The point P of body j at s_bar has the height 0.3 + 0.1 t. Each factor multiplies one function; 1 is
/// right.
struct Factors {
    double variation = 1, nu = 1, gamma = 1, second = 1;
};

class Height final : public Block {
public:
    Height(int j, const Factors& by) : Block(ground, j), by(by) {}

    using Block::gamma, Block::nu, Block::phi, Block::second_variation, Block::variation;
    double phi(const Arguments& x) const override { return (x.bj.r + x.bj.A * s_bar).z() - 0.3 - 0.1 * x.t; }
    Variation variation(const Arguments& x) const override
    {
        Variation v = Variation::zero();
        v.r_j = Vec3::UnitZ();
        v.pi_j = by.variation * s_bar.cross(x.bj.A.transpose() * Vec3::UnitZ());
        return v;
    }
    double nu(const Arguments&) const override { return by.nu * 0.1; }
    double gamma(const Arguments& x) const override
    {
        const Vec3& w = x.bj.omega_bar;
        return -by.gamma * (x.bj.A * w.cross(w.cross(s_bar))).z();
    }
    Mat12 second_variation(const Arguments& x) const override
    {
        return by.second * Block::second_variation(x);
    }

private:
    const Vec3 s_bar{0.4, -0.2, 0.3};
    const Factors by;
};

/// F = -k |r| r with derivatives times a factor
class Cubic final : public Force {
public:
    explicit Cubic(double factor) : factor(factor) { name = "cubic"; }
    void add(const State& x, lie::Loads& out) const override
    {
        const Vec3& r = x.body[0].r;
        out.F[0] -= k * r.norm() * r;
    }
    bool load_derivatives(const State& x, LoadDerivatives& out) const override
    {
        const Vec3& r = x.body[0].r;
        out.setZero();
        out.block<3, 3>(0, 0) = -factor * k * (r.norm() * Mat3::Identity() + r * r.transpose() / r.norm());
        return true;
    }
    std::array<int, 2> bodies() const override { return {0, ground}; }
    int last_body() const override { return 0; }

private:
    const double k = 50, factor;
};

std::vector<std::string> warnings(const Factors& by, double factor = 1)
{
    Model model;
    model.gravity = {0, 0, -9.81};
    model.add({.name = "b", .m = 1, .J_bar = Mat3::Identity()});
    model.constrain("height", Height(0, by));
    model.load(Cubic(factor));
    State x;
    x.body.resize(1);
    x.body[0].r = {0.2, 0.1, 0};
    x.body[0].rdot = {0, 0, 0.1};
    return start(model, x).warnings;
}

}  // namespace

TEST_CASE("functions of a constraint that contradict differences of its phi are named", "[dae][start]")
{
    CHECK(warnings({}).empty());
    const auto one = [](const Factors& by, const std::string& text) {
        const std::vector<std::string> found = warnings(by);
        CAPTURE(text);
        REQUIRE(found.size() == 1);
        CHECK_THAT(found[0], Contains("height") && Contains(text));
    };
    one({.gamma = -1}, "gamma of row 1 is ");
    one({.gamma = 1.01}, "gamma of row 1 is ");
    one({.variation = -1}, "C_j of row 1 is ");
    one({.second = 2}, "second_variation of row 1 is ");
}

TEST_CASE("a wrong nu is named", "[dae][start]")
{
    // The start would refuse the velocity that contradicts it: compared without a start.
    Model model;
    model.add({.name = "b", .m = 1, .J_bar = Mat3::Identity()});
    model.constrain("height", Height(0, {.nu = 0.5}));
    State x;
    x.body.resize(1);
    model.prepare(x);
    const std::vector<std::string> found = wrong_derivatives(model, x);
    REQUIRE(found.size() == 1);
    CHECK_THAT(found[0], Contains("nu of row 1 is 0.05, by differences 0.1"));
}

TEST_CASE("load derivatives that contradict differences of the loads are named", "[dae][start]")
{
    const std::vector<std::string> found = warnings({}, 0.5);
    REQUIRE(found.size() == 1);
    CHECK_THAT(found[0],
               Contains("force 'cubic': load_derivatives has ") && Contains("differences of add() have"));
}
