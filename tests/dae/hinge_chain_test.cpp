// SPDX-License-Identifier: GPL-3.0-or-later
/// The linear solvers on long chains of hinges, whose rows across the plane are those of a beam.

#include "dae/joints.hpp"
#include "dae/model.hpp"
#include "dae/start.hpp"
#include "lie/solver/saddle.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::dae;

namespace {

/// Bars of 1 m along x, from the origin, on hinges about y
void chain(int N, Model& model, State& x)
{
    const Vec3 Y = Vec3::UnitY();
    for (int b = 0; b < N; ++b) {
        model.add(
            {.name = "b" + std::to_string(b), .m = 1, .J_bar = Vec3(0.01, 1. / 12, 1. / 12).asDiagonal()});
        Motion& body = x.body.emplace_back();
        body.r = {b + 0.5, 0, 0};
        const Vec3 end(b == 0 ? 0 : 0.5, 0, 0);
        model.constrain("j" + std::to_string(b), revolute(b - 1, end, Y, b, {-0.5, 0, 0}, Y));
    }
    start(model, x);
}

/// The number of entries of the factors of the saddle matrix by KLU
long entries_of_factors(int N)
{
    Model model;
    State x;
    chain(N, model, x);
    lie::Saddle K(model);
    K.assemble(x);
    return K.entries_of_factors();
}

}  // namespace

TEST_CASE("the factors of a chain of hinges grow in proportion to its length", "[dae][saddle]")
{
    const double of_50 = static_cast<double>(entries_of_factors(50)) / 50,
                 of_300 = static_cast<double>(entries_of_factors(300)) / 300;
    CHECK(of_300 < 1.1 * of_50);
}

TEST_CASE("the condensed solver solves long chains of hinges", "[dae][saddle]")
{
    for (const int N : {10, 300, 1200}) {
        Model model;
        State x;
        chain(N, model, x);
        lie::Saddle K(model, lie::Metric::mass, lie::LinearSolver::automatic);
        K.assemble(x);
        CAPTURE(N, K.reciprocal_condition());
        CHECK(K.is_condensed());
        CHECK(K.factorizations() == 0);
        const Eigen::VectorXd z = Eigen::VectorXd::Random(K.size());
        Eigen::VectorXd b(K.size()), residual(K.size());
        K.multiply(z, b);
        const Eigen::VectorXd right = b;
        K.solve_in_step(b);
        K.multiply(b, residual);
        CHECK((residual - right).norm() < 1e-11 * right.norm());
        // The motion is determined to rounding, the multipliers as far as the beam is stiff.
        CHECK((b - z).head(6 * N).norm() < 1e-9 * z.norm());
    }
}
