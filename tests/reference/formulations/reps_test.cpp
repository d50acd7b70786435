// SPDX-License-Identifier: GPL-3.0-or-later
/// Schemes on Euler angles near the singular set of the angles.

#include "reference/formulations/reps.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "reference/solvers/index1.hpp"
#include "tests/reference/classical_models.hpp"

using namespace hilda;
using lie::Mat3;
using lie::Vec3;

namespace {

/// Body on a ball joint that tumbles such that its third axis passes near the global z axis
void tumbling(dae::Model& model, lie::State& x)
{
    const Vec3 eps(0.3, 0.7, -0.4);
    const Mat3 A = lie::rotation(eps);
    const Vec3 s_bar(0.1, -0.3, 0.2), omega_bar = lie::B(eps) * Vec3(0.1, -4, 0.3);
    tests::add_body(model, x, "bob", 2, {0.11, 0.15, 0.13}, -A * s_bar, A, -A * omega_bar.cross(s_bar),
                    omega_bar);
    model.constrain("ball", dae::spherical(dae::ground, Vec3::Zero(), 0, s_bar));
    dae::start(model, x);
}

}  // namespace

TEST_CASE("a step near the singular set of the Euler angles fails and names the body", "[reference][reps]")
{
    dae::Model model;
    lie::State x;
    tumbling(model, x);
    for (const char* name : {"reps-half-1", "reps-half-1-kick"}) {
        const auto integrator = lie::scheme(name).make(model, {});
        lie::State y = x, before;
        std::string status, what;
        for (int n = 0; n < 1000 && status.empty(); ++n) {
            before = y;
            try {
                integrator->step(y, 1e-3);
            } catch (const lie::NumericalFailure& failure) {
                status = failure.status, what = failure.what();
            }
        }
        INFO(name << ": " << what);
        CHECK(status == "singular_parametrisation");
        CHECK_THAT(what, Catch::Contains("'bob'") && Catch::Contains("phi = ") &&
                             Catch::Contains("--reparametrise") && Catch::Contains("rA"));
        CHECK_THAT(what, !Catch::Contains("\n"));
        CHECK(y.t == before.t);
        CHECK(y.body[0].A == before.body[0].A);
        CHECK(y.history == before.history);
        CHECK(lie::distance_to_singular_set(lie::euler_angles(y.body[0].A)) == Approx(0.1).margin(0.01));
    }
}

TEST_CASE("singular Euler angles at the start are rejected or expressed in another frame",
          "[reference][reps]")
{
    dae::Model model;
    lie::State x;
    tests::add_body(model, x, "crate", 2, {0.1, 0.2, 0.3}, {0, 0, 0}, Mat3::Identity(), {1, 0, 0}, {1, 2, 3});
    dae::start(model, x);
    const auto integrator = lie::scheme("reps-half-1").make(model, {});
    CHECK_THROWS_WITH(integrator->step(x, 1e-3),
                      Catch::Contains("body 'crate': the Euler angle phi = 0 rad"));
    CHECK(x.t == 0);
    const auto other = lie::scheme("reps-half-1").make(model, {.reparametrise = true});
    CHECK_NOTHROW(other->step(x, 1e-3));
    CHECK(x.t > 0);
}

TEST_CASE("with a change of frame Euler angles pass the singular set and keep the order", "[reference][reps]")
{
    dae::Model model;
    lie::State x;
    tumbling(model, x);
    const std::vector<double> instants = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8};
    const lie::Trajectory exact = reference::index1(model, x, instants);
    for (const char* name : {"reps-half-1", "reps-half-1-kick"}) {
        tests::Deviation d[2];
        for (int k = 0; k < 2; ++k)
            d[k] = tests::deviation(tests::run(name, model, x, k == 0 ? 1e-3 : 5e-4, 0.8, 0.1,
                                               {.tolerance = 1e-12, .reparametrise = true}),
                                    exact.row);
        INFO(name << " at h = 5e-4: " << d[1]);
        tests::check_order(tests::order(d[0], d[1]), lie::scheme(name).order, 0.15);

        const auto integrator = lie::scheme(name).make(model, {.reparametrise = true});
        lie::State y = x;
        int frame_changes = 0;
        double frame = 0, nearest = 1;
        for (int n = 0; n < 800; ++n) {
            integrator->step(y, 1e-3);
            const double now = y.history[12];  // index of the frame of the angles
            frame_changes += now != frame;
            frame = now;
            nearest = std::min(nearest, lie::distance_to_singular_set(lie::euler_angles(y.body[0].A)));
        }
        CHECK(frame_changes >= 1);
        CHECK(nearest < 0.1);
    }
}
