// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/cones/contact_step.hpp"
#include "lie/check.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "tests/lie/cones/contact_system.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using lie::Vec3;

namespace {

/// A box that strikes the ground with a corner, without gravity. Newton's law alone increases the energy in
/// some of these impacts.
void add_falling_corner(tests::ContactSystem& system, tests::Random& random)
{
    system.gravity.setZero();
    const Vec3 half(0.1, 0.04, 0.3);
    const lie::Mat3 A = lie::exp(3 * random.vector());
    const Vec3 corner = A.transpose() * Vec3(0, 0, -0.2);
    system.add_box(1, half, {0, 0, 0.2 + 1e-12}, A);
    system.vertices.push_back({0, -1, corner + 0.1 * random.vector(), Vec3::UnitZ(), 0, 1, 0.9});
}

lie::State start_of_falling_corner(tests::ContactSystem& system, tests::Random& random)
{
    lie::State x = system.start();
    x.body[0].r.z() -= tests::ContactSystem::point(x, 0, system.vertices[0].s_bar).z() - 1e-9;
    x.body[0].rdot = random.vector(), x.body[0].omega_bar = 5 * random.vector();
    return x;
}

}  // namespace

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

TEST_CASE("a contact that only the impulses of the step close is found", "[lie][cones]")
{
    // Three balls in a row; the first one strikes the second, which reaches the third within the step.
    // Without restitution the gaps close at the end of the step: v_i - v_j = gap/h.
    for (const double restitution : {0., 0.5}) {
        tests::ContactSystem system;
        system.gravity.setZero();
        const double R = 0.1, gap_01 = 1e-4, gap_12 = 2.5e-4, h = 1e-3;
        system.add_sphere(1, R, {0, 0, 0});
        system.add_sphere(1, R, {2 * R + gap_01, 0, 0});
        system.add_sphere(1, R, {4 * R + gap_01 + gap_12, 0, 0});
        system.spheres.push_back({0, 1, R, R, 0, restitution});
        system.spheres.push_back({1, 2, R, R, 0, restitution});
        lie::State x = system.start();
        x.body[0].rdot.x() = 1;
        lie::ConeRows found;
        system.cones(x, h, found);
        REQUIRE(found.cone.size() == 1);
        const auto integrator = lie::scheme("rA-moreau-1").make(system, {});
        integrator->step(x, h);
        if (restitution == 0) {
            const double v_0 = (1 + 2 * gap_01 / h + gap_12 / h) / 3;
            CHECK(x.body[0].rdot.x() == Approx(v_0).epsilon(1e-9));
            CHECK(x.body[1].rdot.x() == Approx(v_0 - gap_01 / h).epsilon(1e-9));
            CHECK(x.body[2].rdot.x() == Approx(v_0 - gap_01 / h - gap_12 / h).epsilon(1e-9));
        } else {  // the second impact takes place in the next step
            CHECK(x.body[1].rdot.x() == Approx(0.75));
            CHECK(x.body[2].rdot.x() == 0);
            integrator->step(x, h);
            CHECK(x.body[1].rdot.x() == Approx(0.1875));
            CHECK(x.body[2].rdot.x() == Approx(0.5625));
        }
        for (int k = 0; k < 2; ++k) CHECK(x.body[k + 1].r.x() - x.body[k].r.x() > 2 * R - 1e-9 * system.size);
    }
}

TEST_CASE("an impact with friction does not increase the energy", "[lie][cones]")
{
    tests::Random random(11);
    long reduced = 0;
    for (int n = 0; n < 300; ++n) {
        CAPTURE(n);
        tests::ContactSystem system;
        add_falling_corner(system, random);
        lie::State x = start_of_falling_corner(system, random);
        const double before = system.kinetic_energy(x);
        const auto integrator = lie::scheme("rA-moreau-1").make(system, {});
        integrator->step(x, 1e-5);
        CHECK(system.kinetic_energy(x) <= before * (1 + 1e-6));
        reduced += integrator->statistics().restitution_reduced;
        if (integrator->statistics().restitution_reduced > 0)  // no more than necessary
            CHECK(system.kinetic_energy(x) >= before * (1 - 2e-2));
    }
    CHECK(reduced >= 3);
}

TEST_CASE("an impact that would increase the energy leaves the rebounds of other bodies unchanged",
          "[lie][cones]")
{
    // the corners of the test before, each with a ball that bounces far away from it
    tests::Random random(11);
    long reduced = 0;
    for (int n = 0; n < 300; ++n) {
        tests::ContactSystem system;
        add_falling_corner(system, random);
        system.add_sphere(1, 0.1, {5, 0, 1e-9});
        system.vertices.push_back({1, -1, Vec3::Zero(), Vec3::UnitZ(), 0, 0, 0.8});
        lie::State x = start_of_falling_corner(system, random);
        x.body[1].rdot = Vec3(0, 0, -1);
        const auto integrator = lie::scheme("rA-moreau-1").make(system, {});
        integrator->step(x, 1e-5);
        reduced += integrator->statistics().restitution_reduced;
        CHECK(x.body[1].rdot.z() == Approx(0.8).epsilon(1e-9));
    }
    CHECK(reduced >= 3);
}
