// SPDX-License-Identifier: GPL-3.0-or-later
/// Rows that a model evaluates together are those of their blocks.

#include "dae/constraints/cd.hpp"
#include "dae/constraints/dp1.hpp"
#include "dae/joints.hpp"
#include "dae/model.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::dae;
using tests::Random;

namespace {

/// Compares Φ, Φ_r, Π̄, ν and γ of the model with those of the blocks of its active rows.
void check_rows(const Model& model, const State& x)
{
    const double rounding = 1e-14;
    const auto n = static_cast<Eigen::Index>(model.active_rows().size());
    Eigen::VectorXd phi(n), nu(n), gamma(n);
    lie::Rows C = model.pattern();
    model.phi(x, phi);
    model.nu(x, nu);
    model.gamma(x, gamma);
    model.variation(x, C);
    REQUIRE(C.rows() == n);
    for (int k = 0; k < C.rows(); ++k) {
        const Model::Row& row = model.all_rows()[static_cast<size_t>(model.active_rows()[k])];
        const Block& block = row.active_block(x);
        const Constraint::Arguments at = Model::arguments(block, x);
        INFO("row " << k << ": constraint " << row.constraint << ", row " << row.number);
        CHECK(std::abs(phi[k] - block.phi(at)) < rounding);
        CHECK(std::abs(nu[k] - block.nu(at)) < rounding);
        CHECK(std::abs(gamma[k] - block.gamma(at)) < 10 * rounding);
        const Variation v = block.variation(at);
        int e = C.start[k];
        if (block.i != ground) {
            CHECK(C.entry[e].body == block.i);
            CHECK((C.entry[e].r - v.r_i).norm() + (C.entry[e].pi - v.pi_i).norm() < rounding);
            ++e;
        }
        if (block.j != ground) {
            CHECK(C.entry[e].body == block.j);
            CHECK((C.entry[e].r - v.r_j).norm() + (C.entry[e].pi - v.pi_j).norm() < rounding);
            ++e;
        }
        CHECK(e == C.start[k + 1]);
    }
}

}  // namespace

TEST_CASE("rows of a point that are evaluated together are those of their blocks", "[dae][constraints]")
{
    Random random(GENERATE(1u, 2u, 3u));
    Model model;
    for (const char* name : {"a", "b", "c", "d"})
        model.add({.name = name, .m = 1, .J_bar = Mat3::Identity()});
    const auto v = [&] { return random.vector(); };
    const Vec3 p = v(), q = v(), x_axis = Vec3::UnitX(), y_axis = Vec3::UnitY();
    model.constrain("to the ground", spherical(ground, v(), 0, v()));
    model.constrain("of the ground", spherical(1, v(), ground, v()));
    model.constrain("hinge", revolute(0, v(), x_axis, 1, v(), x_axis));
    // rows that are scaled, prescribed, oblique or driven, for the same points and others
    model.constrain("scaled", CD(-2.5 * x_axis, 1, p, 2, q, Driver(0.3)));
    model.constrain("the same direction", CD(x_axis, 1, p, 2, q));
    model.constrain("oblique", CD(Vec3(1, 1, 0), 1, p, 2, q));
    model.constrain("driven", CD(y_axis, 1, p, 2, q, Driver("sin(t)")));
    model.constrain("next", CD(y_axis, 1, p, 2, q));
    model.constrain("another point", CD(y_axis, 1, q, 2, p));
    model.constrain("reversed", CD(y_axis, 2, p, 1, q));
    model.constrain("axes", DP1(2, v(), 3, v()));
    model.constrain("four rows", spherical(2, p, 3, q));
    model.constrain("fourth", CD(x_axis, 2, p, 3, q));
    State x = random.state(4);
    check_rows(model, x);

    model.drop({1, 9});  // 1: the second row of a group
    model.drop({4, 5});  // two rows of the next one
    x.discrete_state.assign(10, 0);
    check_rows(model, x);
}
