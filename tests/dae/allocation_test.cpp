// SPDX-License-Identifier: GPL-3.0-or-later
/// Memory allocation of the steps of all integrators.
#include "dae/forces/prescribed.hpp"
#include "dae/forces/spring_damper.hpp"
#include "dae/forces/torsion_spring.hpp"
#include "dae/start.hpp"
#include "io/expression.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "tests/support/bristle.hpp"
#include "tests/support/mechanisms.hpp"
#include "tests/support/no_allocation.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using lie::Vec3;

TEST_CASE("a step of a mechanism with drivers, springs, internal states and expressions allocates no memory",
          "[dae][allocation]")
{
    if (!tests::counts_allocations) {
        WARN("allocations are not counted: a sanitizer replaces the allocator");
        return;
    }
    for (const lie::Scheme& s : lie::schemes()) {
        dae::Model model;
        lie::State x;
        tests::slider_crank(model, x);
        model.load(dae::SpringDamper(0, Vec3(0.01, 0, 0), 2, Vec3(0, 0.02, 0), 10, 0.1, 0.05,
                                     io::Expression("2*sin(t)*l - 0.1*ldot", {"l", "ldot", "t"})));
        model.load(dae::TorsionSpring(dae::ground, Vec3::UnitX(), 0, Vec3::UnitX(), 0.01, 1e-3, 0.2, x));
        model.load(
            dae::PrescribedForce(1, Vec3(0, 0.1, 0), dae::Frame::body,
                                 {io::Expression("t"), io::Expression("0"), io::Expression("cos(3*t)")}));
        if (s.supports.contains(lie::Feature::history)) model.load(tests::Bristle(0, 2, 0.1, 1e-3));
        dae::start(model, x, {.fix_initial = true});
        if (!s.takes(model)) continue;
        const auto integrator = s.make(model, {});
        lie::March march(x, *integrator, 1e-3);
        for (int n = 0; n < 5; ++n) march.advance({});
        const long taken = tests::allocations_during([&] {
            // beyond the first replacement of the driver by its complement
            for (int n = 0; n < 300; ++n) march.advance({});
        });
        INFO(s.name);
        CHECK(march.node().discrete_state[0] == 1);
        // KLU allocates memory when it chooses new pivots
        CHECK(taken <= integrator->statistics().factorizations * 64);
        const long steady = tests::allocations_during([&] {
            for (int n = 0; n < 20; ++n) march.advance({});
        });
        CHECK(steady == 0);
    }
}
