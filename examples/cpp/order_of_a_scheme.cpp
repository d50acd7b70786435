// SPDX-License-Identifier: GPL-3.0-or-later
/// Measures the order of two integrators on a double pendulum: the error of the position of its lower end at
/// t = 1 s is C h^p, so that p = log2(error(h)/error(h/2)). The reference solution is a run of the
/// fourth-order rA-rkmk-4.

#include "dae/joints.hpp"
#include "dae/model.hpp"
#include "dae/start.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"

#include <cmath>
#include <cstdio>
#include <string>

using namespace hilda;
using lie::Vec3;

namespace {

constexpr double t_end = 1;  // [s]

/// The lower end of two bars of 1 m and 1 kg that are hinged about x and start horizontally at rest [m]
Vec3 lower_end(const std::string& scheme, double h)
{
    const Vec3 X = Vec3::UnitX(), Y = Vec3::UnitY();
    dae::Model model;
    dae::State x;
    x.body.resize(2);
    for (int b = 0; b < 2; ++b) {
        model.add({.name = "bar " + std::to_string(b + 1),
                   .m = 1,
                   .J_bar = Vec3(1. / 12, 1e-3, 1. / 12).asDiagonal()});
        x.body[b].r = (b + 0.5) * Y;  // the bars are along y
    }
    model.constrain("upper hinge", dae::revolute(dae::ground, Vec3::Zero(), X, 0, -0.5 * Y, X));
    model.constrain("lower hinge", dae::revolute(0, 0.5 * Y, X, 1, -0.5 * Y, X));
    dae::start(model, x);

    // The Newton tolerance must be far below the errors that are measured.
    const auto integrator = lie::scheme(scheme).make(model, {.tolerance = 1e-12});
    const dae::State end = lie::march(x, *integrator, lie::TimeGrid::over(t_end, h, t_end)).row.back();
    return end.body[1].r + end.body[1].A * (0.5 * Y);
}

}  // namespace

int main()
{
    const Vec3 reference = lower_end("rA-rkmk-4", 5e-4);
    bool passed = true;
    for (const std::string name : {"rA-half-1", "rA-half-2"}) {
        const int declared = lie::scheme(name).order;
        std::printf("%s, declared order %d\n     h [s]     error [m]    order\n", name.c_str(), declared);
        double before = 0, order = 0;
        for (const double h : {4e-3, 2e-3, 1e-3, 5e-4}) {
            const double error = (lower_end(name, h) - reference).norm();
            std::printf("  %8.1e    %10.3e", h, error);
            if (before > 0) {
                order = std::log2(before / error);
                std::printf("   %6.2f", order);
            }
            std::printf("\n");
            before = error;
        }
        // Both bounds are checked: an order above the declared one is an error of the declaration.
        if (!(std::abs(order - declared) < 0.15)) {
            std::printf("FAILED: the measured order differs from the declared one by more than 0.15\n");
            passed = false;
        }
    }
    return passed ? 0 : 1;
}
