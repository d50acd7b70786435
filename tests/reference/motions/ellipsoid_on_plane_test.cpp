// SPDX-License-Identifier: GPL-3.0-or-later
/// Ellipsoid on the plane: independent integration, equations of motion, invariants, periods, reversal of the
/// rattleback.

#include "reference/motions/ellipsoid_on_plane.hpp"

#include "lie/check.hpp"
#include "tests/reference/contact_motion.hpp"
#include "tests/support/random_motion.hpp"

#include <algorithm>
#include <numbers>

using namespace hilda;
using namespace hilda::reference;

namespace {

using std::numbers::pi;

/// Rattleback: semi-axes 0.2, 0.05, 0.04 m, 1 kg, principal axes rotated by 0.1 rad about the z axis of the
/// body
EllipsoidOnPlane rattleback()
{
    EllipsoidOnPlane body{.semi_axes = Vec3(0.2, 0.05, 0.04), .m = 1};
    const Mat3 turned = lie::exp(Vec3(0, 0, 0.1));
    body.J_bar = turned * body.J_bar * turned.transpose();
    return body;
}

/// State of an independent integration of the same motion: DOP853 with a relative tolerance of 1e-13, in
/// quaternions
struct ReferenceState {
    Vec3 r, rdot;
    Eigen::Quaterniond e;
    Vec3 omega_bar, a_bar, F;
};

void check_instant(const ContactInstant& x, const ReferenceState& expected)
{
    // deviations accumulated over 2 s: 2e-12 in A, 6e-12 in ω̄ and 2e-11 in F
    INFO("t = " << x.t);
    CHECK((x.body.r - expected.r).norm() < 1e-12);
    CHECK((x.body.rdot - expected.rdot).norm() < 5e-12);
    CHECK((x.body.A - expected.e.toRotationMatrix()).norm() < 1e-11);
    CHECK((x.body.omega_bar - expected.omega_bar).norm() < 2e-11);
    CHECK((x.a_bar - expected.a_bar).norm() < 2e-12);
    CHECK((x.F() - expected.F).norm() < 1e-10);
}

}  // namespace

TEST_CASE("sliding and rolling ellipsoids agree with an independent integration",
          "[reference][ellipsoid][acceptance]")
{
    const EllipsoidOnPlane pebble;
    const Mat3 A = lie::exp(Vec3(0.5, 0.3, 0.1));
    const auto slide = pebble.slide({.A = A, .omega_bar = Vec3(1, 2, 4), .xdot = 0.3}, {0, 1, 2});
    CHECK(slide[0].body.r.z() == Approx(0.19093344966747580).epsilon(1e-15));
    CHECK(slide[0].body.rdot.z() == Approx(0.16523035228314287).epsilon(1e-14));
    CHECK(slide[0].F_N == Approx(10.876732229093287).epsilon(1e-14));
    check_instant(slide[1],
                  {{0.3, 0, 0.18204868708218258},
                   {0.3, 0, 0.3360523526801223},
                   {-0.5541088497626463, -0.06984901993510965, -0.20899673615202657, 0.8027483175358402},
                   {-3.9456895844795836, 0.7390119412051532, 3.6517989316691777},
                   {0.1699438917756906, 0.0886217722109719, -0.11159029415007501},
                   {0, 0, 12.275310149435677}});
    check_instant(slide[2],
                  {{0.6, 0, 0.1607136805832542},
                   {0.3, 0, -0.14229447384789198},
                   {-0.5292018462566367, -0.10890356469168537, 0.031949649116065106, -0.8408713572463813},
                   {6.565247698985792, 2.785235972022416, 3.071169316372982},
                   {-0.12149996321575009, -0.023929529965449794, -0.13639389894372328},
                   {0, 0, 30.921991802370865}});
    const auto roll = pebble.roll({.A = A, .omega_bar = Vec3(0.5, 1, 1)}, {0, 2});
    check_instant(roll[0], {{0, 0, 0.1909334496674758},
                            {0.007784747560074652, -0.251584493887696, 0.10070796386032964},
                            {0.9565680814220291, 0.2463700839976002, 0.1478220503985601, 0.04927401679952004},
                            {0.5, 1, 1},
                            {0.12186025082357148, -0.1590564311722014, -0.09838647483418977},
                            {-4.428072879373999, 4.0586104097587885, 15.633423052699085}});
    check_instant(roll[1],
                  {{-0.05260211731080966, 0.13424198741552118, 0.16917293913750456},
                   {0.2516731043656758, 0.44816770624182495, 0.2299289187099349},
                   {0.19884947785842677, 0.12036572091334853, 0.13998097082951702, 0.9624844446483625},
                   {3.6680598833292803, 0.4713090089668547, 0.4756520315032005},
                   {-0.09364794675015008, -0.11723518588047928, -0.12393402900872413},
                   {-5.1326957029521845, -2.214397244219456, 19.325567467509494}});

    const Mat3 tilted = lie::exp(Vec3(0.005, 0.01, 0));
    const auto there = rattleback().roll({.A = tilted, .omega_bar = Vec3(0, 0, 3)}, {1}),
               back = rattleback().roll({.A = tilted, .omega_bar = Vec3(0, 0, -3)}, {1});
    check_instant(there[0],
                  {{-0.000458130475952238, -0.0007678470713243546, 0.04000467337907183},
                   {-0.0035237215449027163, -0.021149322948921478, 0.0002344599364728503},
                   {0.06310519877420641, -0.0014427200844414091, -0.008121134696194356, 0.9979727950288385},
                   {-0.6755311012349589, -0.05652732729063351, 3.0179097100684436},
                   {0.0018544024935324712, 0.0010243446498876436, -0.0399898850611021},
                   {0.0820320936357863, 0.022463702286367897, 9.816982579069819}});
    check_instant(back[0],
                  {{-0.0031119978218449268, 0.001463642871459071, 0.04107646611394369},
                   {-0.03445698140433918, -0.01582250799843224, 0.040891800686443165},
                   {0.16773876630058243, 0.02220332229826609, 0.011487718368786176, -0.9855144601098238},
                   {2.6347538395453807, 0.9732373219735126, -2.2729859167081705},
                   {0.04636938499658685, 0.0009247332347126878, -0.03890305799299186},
                   {1.7107347553218881, -0.5138336556244462, 8.963043431481372}});
}

TEST_CASE("a rattleback reverses one direction of spin and not the other", "[reference][ellipsoid]")
{
    const EllipsoidOnPlane body = rattleback();
    std::vector<double> instants;
    for (int k = 0; k <= 20; ++k) instants.push_back(0.1 * k);
    const Mat3 tilted = lie::exp(Vec3(0.005, 0.01, 0));
    for (const double spin : {-3.0, 3.0}) {
        const auto run = body.roll({.A = tilted, .omega_bar = Vec3(0, 0, spin)}, instants);
        double least = spin * spin;
        for (const ContactInstant& x : run) {
            least = std::min(least, spin * x.body.omega_bar.z());
            CHECK(body.energy(x.body) == Approx(body.energy(run[0].body)).epsilon(1e-13));
        }
        CHECK((least < 0) == (spin < 0));
    }
}

TEST_CASE("an ellipsoid without friction conserves energy, L_z and horizontal velocity",
          "[reference][ellipsoid]")
{
    tests::Random random(GENERATE(1u, 2u));
    EllipsoidOnPlane body{.semi_axes = Vec3(0.5, 0.3, 0.2), .m = 1.7};
    const Mat3 turned = random.rotation();
    body.J_bar = turned * body.J_bar * turned.transpose();
    const auto run = body.slide(
        {.A = random.rotation(), .omega_bar = random.vector(3), .x = 1, .y = 2, .xdot = -0.4, .ydot = 0.2},
        {0, 0.5, 1, 3});
    for (const ContactInstant& x : run) {
        CHECK(body.energy(x.body) == Approx(body.energy(run[0].body)).epsilon(1e-12));
        CHECK(body.L_z(x.body) == Approx(body.L_z(run[0].body)).epsilon(1e-12).margin(1e-13));
        CHECK((x.body.rdot - Vec3(-0.4, 0.2, x.body.rdot.z())).norm() == 0);
        CHECK((x.body.r - Vec3(1 - 0.4 * x.t, 2 + 0.2 * x.t, x.body.r.z())).norm() < 1e-13);
        CHECK(std::abs(x.p.z()) < 1e-15);
        // the contact point is on the ellipsoid, and the outward normal there is -z
        CHECK(x.a_bar.cwiseQuotient(body.semi_axes).norm() == Approx(1).epsilon(1e-14));
        CHECK((x.body.A * x.a_bar.cwiseQuotient(body.semi_axes.cwiseAbs2())).normalized().z() ==
              Approx(-1).epsilon(1e-14));
    }
}

TEST_CASE("the motions on the plane satisfy the equations of motion", "[reference][ellipsoid]")
{
    tests::Random random(GENERATE(1u, 2u, 3u));
    EllipsoidOnPlane body{.semi_axes = Vec3(0.5, 0.3, 0.2), .m = 1.7};
    const Mat3 turned = random.rotation(), A = random.rotation();
    body.J_bar = turned * body.J_bar * turned.transpose();
    const Vec3 omega_bar = random.vector(4);
    const double rate = 40, h = 4e-3 / rate;  // of an oscillation on the narrow side, √(F_N a/J)
    const auto instants = tests::five_instants(0.3, h);
    const auto slide = body.slide({.A = A, .omega_bar = omega_bar, .xdot = 1}, instants),
               roll = body.roll({.A = A, .omega_bar = omega_bar}, instants);
    for (const auto& run : {slide, roll}) tests::check_motion(run, h, body.m, body.J_bar, 9.81, rate);
    CHECK(roll[2].slip().norm() < 1e-13);
    CHECK(body.energy(roll[4].body) == Approx(body.energy(roll[0].body)).epsilon(1e-13));
    CHECK(std::abs(slide[2].slip().z()) < 1e-13);
    CHECK(slide[2].F_t.norm() == 0);
}

TEST_CASE("a rocking ellipsoid returns to its initial state after the period",
          "[reference][ellipsoid][acceptance]")
{
    const EllipsoidOnPlane body;
    const double T = body.slide_period(0.6), T_roll = body.roll_period(0.6);
    CHECK(T == Approx(0.7120300728).margin(6e-11));
    CHECK(T_roll == Approx(1.0671467671).margin(6e-11));

    const Mat3 A = lie::exp(Vec3(0.6, 0, 0));
    const auto slide = body.slide({.A = A}, {T / 4, T / 2, T}),
               roll = body.roll({.A = A}, {T_roll / 4, T_roll / 2, T_roll});
    for (const auto& run : {slide, roll}) {
        CHECK((run[0].body.A - Mat3::Identity()).norm() < 1e-12);
        CHECK((run[1].body.A - A.transpose()).norm() < 1e-12);
        CHECK((run[2].body.A - A).norm() < 1e-12);
        CHECK(run[2].body.omega_bar.norm() < 1e-11);
    }

    // small oscillations: the deviation from T_0 is quadratic in the amplitude
    const double b = 0.25, c = 0.15, J = body.J_bar(0, 0), stiffness = body.m * 9.81 * (b * b / c - c);
    const double T_0 = 2 * pi * std::sqrt(J / stiffness),
                 T_roll_0 = 2 * pi * std::sqrt((J + body.m * c * c) / stiffness);
    CHECK((body.slide_period(0.02) - T_0) / (body.slide_period(0.01) - T_0) == Approx(4).epsilon(1e-2));
    CHECK((body.roll_period(0.02) - T_roll_0) / (body.roll_period(0.01) - T_roll_0) ==
          Approx(4).epsilon(1e-2));
    CHECK(body.slide_period(1e-6) == Approx(T_0).epsilon(1e-11));
    CHECK(body.roll_period(1e-6) == Approx(T_roll_0).epsilon(1e-11));
}

TEST_CASE("an ellipsoid with equal semi-axes rolls straight on as a ball", "[reference][ellipsoid]")
{
    const EllipsoidOnPlane ball{.semi_axes = Vec3::Constant(0.2), .m = 3};
    CHECK((ball.J_bar - 0.4 * 3 * 0.04 * Mat3::Identity()).norm() < 1e-16);
    const Mat3 A = tests::Random(1).rotation();
    const Vec3 omega(1, -2, 5);
    const auto run = ball.roll({.A = A, .omega_bar = A.transpose() * omega}, {4});
    CHECK((run[0].body.r - Vec3(4 * 0.2 * -2, 4 * 0.2 * -1, 0.2)).norm() < 1e-13);
    CHECK((run[0].body.A - lie::exp(4 * omega) * A).norm() < 1e-12);
    CHECK((run[0].F() - Vec3(0, 0, 3 * 9.81)).norm() < 1e-12);
}

TEST_CASE("invalid parameters of an ellipsoid on the plane are rejected with the value",
          "[reference][ellipsoid]")
{
    using Catch::Contains;
    const EllipsoidOnPlane body;
    CHECK_THROWS_WITH((EllipsoidOnPlane{.semi_axes = Vec3(1, 1, -1)}.roll({}, {1})),
                      Contains("positive") && Contains("got -1"));
    CHECK_THROWS_WITH((EllipsoidOnPlane{.J_bar = -Mat3::Identity()}.roll({}, {1})),
                      Contains("positive definite"));
    CHECK_THROWS_WITH(body.roll({.A = 2 * Mat3::Identity()}, {1}), Contains("must be a rotation"));
    CHECK_THROWS_WITH(body.slide({}, {1, 0.5}), Contains("ascend"));
    CHECK_THROWS_WITH(body.roll_period(2), Contains("quarter turn"));
    CHECK_THROWS_WITH((EllipsoidOnPlane{.semi_axes = Vec3(1, 1, 2)}.roll_period(0.1)),
                      Contains("b must exceed c"));
    CHECK_THROWS_WITH(EllipsoidOnPlane{.J_bar = rattleback().J_bar}.roll_period(0.1),
                      Contains("principal axis"));
}
