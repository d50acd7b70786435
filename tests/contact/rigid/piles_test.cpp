// SPDX-License-Identifier: GPL-3.0-or-later
// Piles of balls with friction that fall and settle.

#include "tests/contact/rigid/rigid_models.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace rigid_tests;

namespace {

/// Layers of 4 × 4 balls, each shifted against the one below, in a bin
std::string pile_of_balls(int balls)
{
    const std::string ball = ball_surface(0.05), laws = dvi(0.3, 0);
    std::string bodies;
    for (int b = 0; b < balls; ++b) {
        const int layer = b / 16, x = b % 4, y = b / 4 % 4;
        const double shift = layer % 2 == 0 ? 0 : 0.01;
        if (b > 0) bodies += ", ";
        bodies += body('b' + std::to_string(b), 1, ball_shape(0.05),
                       {(x + 0.5) * 0.105 + shift, (y + 0.5) * 0.105 + shift / 2, 0.055 + layer * 0.105});
    }
    std::string contacts = R"({"name": "balls", "bodies": "all", "surface": )" + ball + ", " + laws + '}';
    const auto add_wall = [&](const std::string& name, const Vec3& position, const Vec3& normal) {
        contacts += R"(, {"name": ")" + name + R"(", "body_i": "all", "body_j": "ground", "surface_i": )" +
                    ball + R"(, "surface_j": {"type": "plane", "position": )" + list(position) +
                    R"(, "normal": )" + list(normal) + "}, " + laws + '}';
    };
    const double width = 4 * 0.105 + 0.01;
    add_wall("floor", Vec3::Zero(), Vec3::UnitZ());
    add_wall("left", Vec3::Zero(), Vec3::UnitX());
    add_wall("right", width * Vec3::UnitX(), -Vec3::UnitX());
    add_wall("front", Vec3::Zero(), Vec3::UnitY());
    add_wall("back", width * Vec3::UnitY(), -Vec3::UnitY());
    return model(bodies, contacts);
}

}  // namespace

TEST_CASE("a settling pile of balls satisfies Coulomb's law in each step and loses energy",
          "[contact][rigid]")
{
    Run pile(pile_of_balls(100), 1e-3);
    double before = pile.energy();
    for (int n = 0; n < 220; ++n) {
        pile.step();
        const double energy = pile.energy();
        CHECK(energy < before + 1e-9 * std::abs(before));
        before = energy;
    }
    const lie::Statistics all = pile.statistics();
    CHECK(all.friction_relaxed == 0);
    CHECK(all.cone_residual <= 1e-6);
    CHECK(all.overlap <= 1e-6);
    CHECK(all.cone_iterations < 500 * all.steps);
}
