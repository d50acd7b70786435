// SPDX-License-Identifier: GPL-3.0-or-later
/// Overconstrained mechanisms: redundant rows are removed and named, contradictory rows are rejected.

#include "dae/constraints/d.hpp"
#include "dae/constraints/dp1.hpp"
#include "dae/joints.hpp"
#include "dae/start.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "tests/dae/axes.hpp"
#include "tests/support/mechanisms.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::dae;
using namespace hilda::tests::axes;
using Catch::Contains;

namespace {

/// Angle between the sides a and b of a triangle with the third side c
double corner(double a, double b, double c) { return std::acos((a * a + b * b - c * c) / (2 * a * b)); }

/// A four-bar linkage in the plane x = 0: crank of 1 m at A = (0, 0, 0), coupler of 2.5 m, rocker of 2 m at
/// D = (0, 3, 0). The bars are parallel to their body-fixed y axes.
struct FourBar {
    static constexpr double crank_length = 1, coupler_length = 2.5, rocker_length = 2;
    const Vec3 A = O, D = 3 * Y;

    static Vec3 end(double length) { return 0.5 * length * Y; }

    void bodies(Model& model, State& x, double crank_angle = 1.0) const
    {
        const Vec3 B = crank_length * Vec3(0, std::cos(crank_angle), std::sin(crank_angle)), BD = D - B;
        const double diagonal = BD.norm();
        const double coupler_angle =
            std::atan2(BD.z(), BD.y()) + corner(coupler_length, diagonal, rocker_length);
        const Vec3 C = B + coupler_length * Vec3(0, std::cos(coupler_angle), std::sin(coupler_angle));
        const Vec3 DC = C - D;
        bar(model, x, "crank", 1, A, crank_angle, crank_length);
        bar(model, x, "coupler", 2, B, coupler_angle, coupler_length);
        bar(model, x, "rocker", 1.5, D, std::atan2(DC.z(), DC.y()), rocker_length);
        x.body[0].omega_bar = 3 * X;  // the velocities of the others follow by the projection
        x.body[0].rdot = 3 * X.cross(x.body[0].r);
    }

private:
    static void bar(Model& model, State& x, const std::string& name, double m, const Vec3& from, double angle,
                    double length)
    {
        const Mat3 turned = lie::exp(angle * X);
        tests::add_body(model, x, name, m, m * Vec3(length * length / 12, 1e-3, length * length / 12),
                        from + turned * end(length), turned);
    }
};

/// Four revolute joints: 20 rows, 3 of them redundant because all axes are parallel
void four_revolutes(Model& model, const FourBar& f)
{
    model.constrain("A", revolute(ground, f.A, X, 0, -f.end(f.crank_length), X));
    model.constrain("B", revolute(0, f.end(f.crank_length), X, 1, -f.end(f.coupler_length), X));
    model.constrain("C", revolute(1, f.end(f.coupler_length), X, 2, f.end(f.rocker_length), X));
    model.constrain("D", revolute(2, -f.end(f.rocker_length), X, ground, f.D, X));
}

/// The same motion with 17 rows: a spherical joint at B and a cylindrical joint at C close the loop.
void four_bar_without_redundance(Model& model, const FourBar& f)
{
    model.constrain("A", revolute(ground, f.A, X, 0, -f.end(f.crank_length), X));
    model.constrain("B", spherical(0, f.end(f.crank_length), 1, -f.end(f.coupler_length)));
    model.constrain("C", cylindrical(1, f.end(f.coupler_length), X, 2, f.end(f.rocker_length), X));
    model.constrain("D", revolute(2, -f.end(f.rocker_length), X, ground, f.D, X));
}

/// Bricard's mechanism of the IFToMM benchmark library: five rods of 1 m along edges of a cube; the sixth
/// edge is the ground. The axis of each joint is perpendicular to its two rods, so that adjacent axes are
/// perpendicular.
void bricard(Model& model, State& x)
{
    const Vec3 along[] = {X, Y, Z, -X, -Y, -Z};
    Vec3 at = O;
    for (int k = 0; k < 5; ++k) {
        Mat3 A;  // the rod along body x
        A << along[k], along[k + 1], along[k].cross(along[k + 1]);
        tests::add_body(model, x, "rod " + std::to_string(k + 1), 1, {2e-3, 1.0 / 12, 1.0 / 12},
                        at + 0.5 * along[k], A);
        at += along[k];
    }
    // Joint k + 1 is at the beginning of rod k + 1; the last joint is at (0, 0, 1) on the ground. The last
    // row of the last joint is removed. With the ground as body i, its ground vector is perpendicular to the
    // sixth edge and to the axis. The coefficient of this row in the linear dependence of all rows stays away
    // from zero. Other rows have a coefficient that vanishes (first at t = 0.89 s). The remaining rows would
    // lose rank there.
    for (int k = 0; k < 6; ++k) {
        const Vec3 axis = along[(k + 5) % 6].cross(along[k]);
        const auto in = [&](int b) { return Vec3(x.body[b].A.transpose() * axis); };
        const std::string name = "joint " + std::to_string(k + 1);
        if (k == 0)
            model.constrain(name, revolute(ground, O, axis, 0, -0.5 * X, in(0)));
        else if (k == 5)
            model.constrain(name, revolute(ground, Z, axis, 4, 0.5 * X, in(4)));
        else
            model.constrain(name, revolute(k - 1, 0.5 * X, in(k - 1), k, -0.5 * X, in(k)));
    }
    model.gravity = {0, -9.81, 0};
}

State last_of_half_2(const Model& model, const State& x, double t_end, double h)
{
    const auto scheme = lie::scheme("rA-half-2").make(model, {.tolerance = 1e-12});
    return lie::march(x, *scheme, lie::TimeGrid::over(t_end, h, t_end)).row.back();
}

double distance_between(const State& x, const State& y)
{
    double most = 0;
    for (size_t b = 0; b < x.body.size(); ++b)
        most = std::max({most, (x.body[b].r - y.body[b].r).norm(), (x.body[b].A - y.body[b].A).norm()});
    return most;
}

/// A bar on a hinge about x through the origin with 1 rad/s
void hinged_bar(Model& model, State& x)
{
    tests::add_body(model, x, "bar", 1, {0.1, 0.2, 0.2}, 0.5 * Y, Mat3::Identity(), 0.5 * X.cross(Y), X);
    model.constrain("pin", revolute(ground, O, X, 0, -0.5 * Y, X));
}

}  // namespace

TEST_CASE("the three redundant rows of a four-bar with four hinges are removed and named",
          "[dae][overconstrained]")
{
    const FourBar f;
    Model model;
    State x;
    f.bodies(model, x);
    four_revolutes(model, f);
    const StartReport report = dae::start(model, x, {.fix_initial = true});
    CHECK(report.rows == 20);
    CHECK(report.rank == 17);
    CHECK(report.degrees_of_freedom == 1);
    REQUIRE(report.dropped.size() == 3);
    // D is the last joint and closes the loop, so that its rows are the redundant ones
    for (const std::string& name : report.dropped)
        CHECK_THAT(name, Contains("constraint 'D' row") && Contains("'rocker'"));
    CHECK(model.rows() == 17);
    CHECK(model.dropped_rows().size() == 3);
    CHECK(model.largest_residual(x).value < 1e-14);
    CHECK(model.largest_velocity_residual(x).value < 1e-13);
}

TEST_CASE("an overconstrained four-bar has the motion of the one without redundant rows",
          "[dae][overconstrained][acceptance]")
{
    const FourBar f;
    Model redundant, lean;
    State x, y;
    f.bodies(redundant, x);
    f.bodies(lean, y);
    four_revolutes(redundant, f);
    four_bar_without_redundance(lean, f);
    dae::start(redundant, x, {.fix_initial = true});
    const StartReport report = dae::start(lean, y, {.fix_initial = true});
    REQUIRE(report.rows == 17);
    REQUIRE(report.dropped.empty());
    CHECK(distance_between(x, y) < 1e-14);
    CHECK((x.body[0].omega_bar - y.body[0].omega_bar).norm() < 1e-13);
    CHECK((x.body[1].rddot - y.body[1].rddot).norm() < 1e-12);

    const State start = x;
    x = last_of_half_2(redundant, x, 1, 1e-3);
    y = last_of_half_2(lean, y, 1, 1e-3);
    INFO("after 1 s they differ by " << distance_between(x, y));
    CHECK(distance_between(x, start) > 0.5);
    CHECK(distance_between(x, y) < 1e-8);
    CHECK(redundant.largest_residual(x).value < 1e-12);  // also of the removed rows
}

TEST_CASE("the second of two equal joints is removed", "[dae][overconstrained]")
{
    Model model;
    State x;
    hinged_bar(model, x);
    model.constrain("pin again", revolute(0, -0.5 * Y, X, ground, O, 2 * X));
    const StartReport report = dae::start(model, x);
    CHECK(report.rank == 5);
    REQUIRE(report.dropped.size() == 5);
    for (const std::string& name : report.dropped) CHECK_THAT(name, Contains("constraint 'pin again'"));

    Model once;
    State y;
    hinged_bar(once, y);
    dae::start(once, y);
    CHECK((x.body[0].rddot - y.body[0].rddot).norm() < 1e-14);
    CHECK((reactions(model, x)[0].F - reactions(once, y)[0].F).norm() < 1e-13);
}

TEST_CASE("contradictory velocities are detected together with large accelerations", "[dae][overconstrained]")
{
    Model model;
    State x;
    hinged_bar(model, x);
    model.constrain("motor", hinge_driver(ground, X, 0, X, Driver("50000*t^2"), x));
    model.constrain("other motor", hinge_driver(ground, X, 0, X, Driver("50000*t^2 + 0.01*t"), x));
    CHECK_THROWS_AS(dae::start(model, x, {.fix_initial = true}), ConstraintError);
}

TEST_CASE("two drivers of one hinge are rejected unless they are equal", "[dae][overconstrained]")
{
    struct SecondDriver {
        const char *second, *level;
    };
    const SecondDriver c = GENERATE(SecondDriver{"2*t", "velocity"}, SecondDriver{"t + t^2", "acceleration"},
                                    SecondDriver{"t", nullptr});
    Model model;
    State x;
    hinged_bar(model, x);
    model.constrain("motor", hinge_driver(ground, X, 0, X, Driver("t"), x));
    model.constrain("other motor", hinge_driver(ground, X, 0, X, Driver(c.second), x));
    INFO(c.second);
    if (c.level == nullptr) {
        CHECK(dae::start(model, x).dropped ==
              std::vector<std::string>{"constraint 'other motor' row 1; bodies 'ground', 'bar'"});
        return;
    }
    try {
        dae::start(model, x, {.fix_initial = true});
        FAIL("two different drivers were accepted");
    } catch (const ConstraintError& e) {
        CHECK_THAT(e.what(), Contains("constraint 'other motor' row 1") && Contains("contradicts") &&
                                 Contains(c.level));
        CHECK(model.constraint_name(e.constraint) == "other motor");
    }
}

TEST_CASE("an impossible distance is rejected", "[dae][overconstrained]")
{
    const bool fix_initial = GENERATE(false, true);
    Model model;
    State x;
    hinged_bar(model, x);
    model.constrain("stay", dae::distance(ground, O, 0, 0.5 * Y, 1.2));  // the distance is 1 m at every angle
    try {
        dae::start(model, x, {.fix_initial = fix_initial});
        FAIL("an impossible distance was accepted");
    } catch (const ConstraintError& e) {
        CHECK_THAT(e.what(),
                   Contains("constraint 'stay' row 1") && Contains(fix_initial ? "contradicts" : "violate"));
    }
}

TEST_CASE("redundant rows are found in initial data that violate the constraints", "[dae][overconstrained]")
{
    // Redundant rows appear independent if the data violate the constraints. The rank must be that of the
    // projected positions.
    tests::Random random(GENERATE(range(1u, 6u)));
    const double size = GENERATE(1e-6, 1e-4, 1e-2);
    const FourBar f;
    Model model;
    State x;
    f.bodies(model, x);
    four_revolutes(model, f);
    State off = x;
    for (Motion& m : off.body) {
        Eigen::Matrix<double, 6, 1> delta;
        delta << random.vector(size), random.vector(size);
        m = tests::displaced(m, delta);
    }
    INFO("off by " << size);
    const StartReport report = dae::start(model, off, {.fix_initial = true});
    CHECK(report.rank == 17);
    CHECK(report.dropped.size() == 3);
    CHECK(model.largest_residual(off).value < 1e-12);
    CHECK(distance_between(x, off) < 20 * size);
}

TEST_CASE("Bricard's mechanism moves although it has as many rows as coordinates", "[dae][overconstrained]")
{
    Model model;
    State x;
    bricard(model, x);
    const StartReport report = dae::start(model, x);
    CHECK(report.rows == 30);
    CHECK(report.rank == 29);
    CHECK(report.degrees_of_freedom == 1);
    REQUIRE(report.dropped.size() == 1);
    const Model::Row& dropped = model.all_rows()[model.dropped_rows()[0]];

    struct Watch final : lie::Observer {
        const Model& model;
        const Model::Row& dropped;
        double e_0, energy_error = 0, residual = 0, kinetic = 0, path = 0;
        Vec3 r_0;
        Watch(const Model& model, const Model::Row& dropped, const State& x)
            : model(model), dropped(dropped), e_0(lie::energy(model, x)), r_0(x.body[2].r)
        {}
        void accepted(const State& node, long, int) override
        {
            const double e = lie::energy(model, node);
            energy_error = std::max(energy_error, std::abs(e - e_0));
            kinetic = std::max(kinetic, e - model.potential_energy(node));
            residual = std::max(residual, std::abs(model.scaled_residual(dropped, node)));
            path = std::max(path, (node.body[2].r - r_0).norm());
        }
    } watch(model, dropped, x);
    lie::Observer* observers[] = {&watch};
    const auto scheme = lie::scheme("rA-half-2").make(model, {.tolerance = 1e-12});
    lie::march(x, *scheme, lie::TimeGrid::over(2, 1e-3, 2), observers);
    INFO("energy error " << watch.energy_error << " J of " << watch.kinetic << " J, dropped row "
                         << watch.residual << ", path " << watch.path << " m");
    CHECK(watch.path > 0.5);
    CHECK(watch.kinetic > 5);
    CHECK(watch.energy_error <
          2e-4 * watch.kinetic);  // second order in h = 1 ms, at up to 10 rad/s; 7e-5 measured
    CHECK(watch.residual < 1e-9);
}
