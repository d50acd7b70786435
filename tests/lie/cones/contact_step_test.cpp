// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/cones/contact_step.hpp"
#include "lie/check.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "tests/lie/cones/contact_system.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using lie::Vec3;

TEST_CASE("a body that is driven into the ground is an error with the name of the contact point",
          "[lie][cones]")
{
    struct Driven final : tests::ContactSystem {
        void phi(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override
        {
            ContactSystem::phi(x, out);
            out[2] += 0.1 * x.t;  // z = -0.1 t
        }
        void nu(const lie::State&, Eigen::Ref<Eigen::VectorXd> out) const override
        {
            out.setZero();
            out[2] = -0.1;
        }
    } system;
    system.add_sphere(1, 0.1, Vec3::Zero());
    system.vertices.push_back({0, -1, Vec3::Zero(), Vec3::UnitZ(), 0, 0.5, 0});
    for (int k = 0; k < 3; ++k) system.pins.push_back({0, -1, Vec3::Zero(), Vec3::Zero(), Vec3::Unit(k)});
    lie::State x = system.start();
    const auto integrator = lie::scheme("rA-moreau-1").make(system, {});
    try {
        integrator->step(x, 1e-3);
        FAIL("the step should fail");
    } catch (const lie::NumericalFailure& e) {
        INFO(e.what());
        CHECK(e.status == "cones_not_solved");
        CHECK(std::string(e.what()).find("contact 0") != std::string::npos);
        CHECK(std::string(e.what()).find("reduce the step") != std::string::npos);
    }
    CHECK(x.t == 0);
    CHECK(x.body[0].r == Vec3::Zero());
    CHECK(x.cone_forces.empty());
}

TEST_CASE("the impulses of the last step are the initial guess in rotated axes", "[lie][cones]")
{
    // A box rests on the ground. The tangential axes of a second system are turned, and its step from the
    // saved state needs no factorisation.
    struct Turned final : tests::ContactSystem {
        bool turned = false;
        void cones(const lie::State& x, double h, lie::ConeRows& out) const override
        {
            ContactSystem::cones(x, h, out);
            if (!turned) return;
            const lie::Mat3 turn = lie::exp(Vec3(0.7, 0, 0));
            for (auto& cone : out.cone) {
                cone.axes = cone.axes * turn;
                cone.C_i = turn.transpose() * cone.C_i;
            }
        }
    } system;
    const Vec3 half(0.1, 0.1, 0.05);
    system.gravity = {2, 1, -9.81};
    system.put_on(system.add_box(1, half, {0, 0, 0.05}), half, -1, 0, 0.5);
    lie::State x = system.start();
    const auto first = lie::scheme("rA-moreau-1").make(system, {});
    for (int n = 0; n < 3; ++n) first->step(x, 1e-3);
    REQUIRE(first->statistics().cone_factorizations > 0);
    const lie::State saved = x;
    system.turned = true;
    const auto second = lie::scheme("rA-moreau-1").make(system, {});
    second->step(x, 1e-3);
    CHECK(second->statistics().cone_factorizations == 0);
    for (size_t c = 0; c < 4; ++c) CHECK((x.cone_forces.at(c).F - saved.cone_forces.at(c).F).norm() < 1e-9);
}
