// SPDX-License-Identifier: GPL-3.0-or-later
/// Ball in the bowl: closed forms, independent integration, quadratures, invariants, and the planar motion in
/// one angle compared with two coordinates.

#include "reference/motions/planar_bowl.hpp"
#include "reference/motions/ball_in_bowl.hpp"

#include "lie/check.hpp"
#include "tests/reference/contact_motion.hpp"
#include "tests/support/random_motion.hpp"

#include <algorithm>

using namespace hilda;
using namespace hilda::reference;

namespace {

/// State of an independent integration of the same motion: DOP853 with a relative tolerance of 1e-13, in
/// angles and in (x, y)
struct ReferencePoint {
    double t;
    Vec3 r;
    double F_N;
};

void check_against(const std::vector<ContactInstant>& run, const std::vector<ReferencePoint>& expected)
{
    // deviations over 10 s: 3e-13 m in the plane, 2e-12 m in space, 8e-12 N
    REQUIRE(run.size() == expected.size());
    for (size_t k = 0; k < run.size(); ++k) {
        INFO("t = " << expected[k].t);
        CHECK((run[k].body.r - expected[k].r).norm() < 5e-12);
        CHECK(run[k].F_N == Approx(expected[k].F_N).margin(2e-11));
    }
}

double largest_difference(const std::vector<ContactInstant>& a, const std::vector<ContactInstant>& b)
{
    REQUIRE(a.size() == b.size());
    double largest = 0;
    for (size_t k = 0; k < a.size(); ++k)
        largest =
            std::max({largest, (a[k].body.r - b[k].body.r).norm(), (a[k].body.rdot - b[k].body.rdot).norm(),
                      (a[k].body.A - b[k].body.A).norm(), (a[k].body.omega_bar - b[k].body.omega_bar).norm(),
                      (a[k].p - b[k].p).norm(), (a[k].a_bar - b[k].a_bar).norm(),
                      (a[k].F() - b[k].F()).norm(), (a[k].body.rddot - b[k].body.rddot).norm(),
                      (a[k].body.omegadot_bar - b[k].body.omegadot_bar).norm()});
    return largest;
}

}  // namespace

TEST_CASE("a ball in the planar bowl has the closed-form state at the start and at the bottom",
          "[reference][bowl]")
{
    const PlanarBowl bowl;
    const double T = bowl.slide_period(1.5), T_roll = bowl.roll_period(1.5);
    CHECK(T == Approx(3.918321172588791).epsilon(1e-14));
    CHECK(T_roll == Approx(4.636220134568755).epsilon(1e-14));
    // rolling increases the kinetic energy by the factor 1 + J/(m R²), and the period by its square root
    CHECK(T_roll / T == Approx(std::sqrt(1.4)).epsilon(1e-14));

    // n and r at y = 1.5; F_N = m g n_z because v = 0
    const auto slide = bowl.slide({}, {0, T / 4, T / 2, T, 2 * T}),
               roll = bowl.roll({}, {0, T_roll / 4, T_roll});
    CHECK((slide[0].p - Vec3(0, 1.5, -std::sqrt(3.0))).norm() < 1e-15);
    CHECK((slide[0].n - Vec3(0, -0.3592106040535498, 0.9332565252573827)).norm() < 1e-15);
    CHECK((slide[0].body.r - Vec3(0, 1.3203946979732251, -1.2654225449401859)).norm() < 1e-15);
    for (const ContactInstant& x : {slide[0], roll[0]}) CHECK(x.F_N == Approx(9.81 * x.n.z()).epsilon(1e-15));
    CHECK(slide[0].F_N == Approx(9.155246512774925).epsilon(1e-15));
    CHECK(roll[0].F_t.norm() == Approx(1.006816007361521).epsilon(1e-14));
    CHECK(roll[0].F_t.norm() / roll[0].F_N == Approx(0.10997).epsilon(1e-4));

    // at the bottom: v² = 2 g fall/(1 + J/(m R²)), F_N = m (g + v²/(b²/c - R))
    const double fall = 2 - 0.5 - 1.2654225449401859, v_2 = 2 * 9.81 * fall;
    CHECK(slide[1].body.rdot.norm() == Approx(2.145322742217019).epsilon(1e-13));
    CHECK(slide[1].F_N == Approx(10.960602417068388).epsilon(1e-13));
    CHECK(slide[1].F_N == Approx(9.81 + v_2 / 4).epsilon(1e-13));
    CHECK(roll[1].body.rdot.norm() == Approx(1.8131286433505626).epsilon(1e-13));
    CHECK(roll[1].F_N == Approx(10.631858869334563).epsilon(1e-13));
    CHECK(roll[1].F_N == Approx(9.81 + v_2 / 1.4 / 4).epsilon(1e-13));

    // half a period and whole periods
    CHECK((slide[2].p - Vec3(0, -1.5, -std::sqrt(3.0))).norm() < 1e-12);
    CHECK((slide[4].p - slide[0].p).norm() < 1e-12);
    CHECK(slide[4].body.rdot.norm() < 1e-12);
    CHECK((roll[2].p - roll[0].p).norm() < 1e-12);
    CHECK((roll[2].body.A - Mat3::Identity()).norm() < 1e-12);
}

TEST_CASE("small oscillations in the bowl are those of a pendulum of the radius of curvature",
          "[reference][bowl]")
{
    // T = T_0 (1 + O(y²)), T_0 with the radius of curvature b²/c - R of the path
    const PlanarBowl bowl{.b = 2.5, .c = 1.5, .R = 0.3};
    const double T_0 = 2 * 3.14159265358979323846 * std::sqrt((2.5 * 2.5 / 1.5 - 0.3) / 9.81);
    const double far = bowl.slide_period(4e-2) - T_0, near = bowl.slide_period(2e-2) - T_0;
    CHECK(std::abs(near) < 1e-3 * T_0);
    CHECK(far / near == Approx(4).epsilon(2e-3));
}

TEST_CASE("sliding and rolling in the planar bowl agree with an independent integration",
          "[reference][bowl][acceptance]")
{
    const PlanarBowl bowl;
    const std::vector<double> instants{1, 5, 10};
    check_against(bowl.slide({}, instants),
                  {{1, {0, -0.04379852021523343, -1.4997601939062588}, 10.959128729898383},
                   {5, {0, -0.21799345248961782, -1.4940492041270184}, 10.923840159204648},
                   {10, {0, -1.2522330425429515, -1.2907517170911922}, 9.390381661564907}});
    check_against(bowl.roll({}, instants),
                  {{1, {0, 0.28601473818796896, -1.4897427934753709}, 10.579190991490238},
                   {5, {0, 1.1670812215149953, -1.3199463925292243}, 9.555005010000865},
                   {10, {0, 0.7359284517111293, -1.4308610477453634}, 10.257998046462587}});
    check_against(bowl.spring({}, {}, instants),
                  {{1, {0, 0.2860288984894405, -1.489741774647521}, 10.57913430410876},
                   {5, {0, 1.167104279041207, -1.319938841592535}, 9.554901200683178},
                   {10, {0, 0.7360850563116267, -1.430830978273947}, 10.25777078009428}});
    check_against(bowl.resist({}, {.eta = 0.1}, instants).instant,
                  {{1, {0, 0.4185895777125987, -1.477951551512025}, 10.36373419438878},
                   {5, {0, 0.5916802755719389, -1.455647004909352}, 9.715877961666921},
                   {10, {0, -0.08189236062766345, -1.499161493677658}, 9.80794265358343}});
    check_against(bowl.resist({}, {.eta = 0.2}, instants).instant,
                  {{1, {0, 0.548860552007574, -1.46190717467124}, 10.1660836168039},
                   {5, {0, -0.07562903972692997, -1.499284877221528}, 9.808245499772875},
                   {10, {0, -0.07562903972692997, -1.499284877221528}, 9.808245499772875}});
    check_against(bowl.resist({}, {.eta = 0.3}, instants).instant,
                  {{1, {0, 0.6769314535127808, -1.441696647777234}, 9.98266261684432},
                   {5, {0, -0.2894920268806756, -1.489491070238295}, 9.784083340563992},
                   {10, {0, -0.2894920268806756, -1.489491070238295}, 9.784083340563992}});
    CHECK(bowl.spring({}, {}, {1.0})[0].F_t.norm() == Approx(0.2011563879910437).margin(1e-11));
}

TEST_CASE("sliding and rolling with spin in the bowl agree with an independent integration",
          "[reference][bowl][acceptance]")
{
    const BallInBowl bowl;
    const std::vector<double> instants{1, 5, 10};
    const Vec3 p = bowl.point(1, 1.5);
    CHECK(p.z() == Approx(-1.6583123951776999).epsilon(1e-15));
    check_against(bowl.slide({.p = p}, instants),
                  {{1, {0.35231627895084683, -0.06580587035601165, -1.4911615929469626}, 11.110989983185153},
                   {5, {0.9126415432796583, -0.32080267792750583, -1.4302216306621267}, 10.873127354310634},
                   {10, {0.7743950745822324, -1.168162030126549, -1.2742051101055032}, 9.604876515551638}});
    check_against(bowl.roll({.p = p}, instants),
                  {{1, {0.5062292325059147, 0.2667508907399017, -1.473823716589973}, 10.675123929733173},
                   {5, {0.2706198475532322, 1.1355724566913876, -1.3246565268538624}, 9.73057884552541},
                   {10, {-0.7796800868796572, 0.5988117161942829, -1.4124098207695475}, 10.411169296655208}});
    const auto spun = bowl.roll({.p = p, .spin = 5}, instants);
    check_against(spun,
                  {{1, {0.42778303063326534, 0.2874110140194877, -1.4773252120234406}, 10.679561249330437},
                   {5, {0.9791676963669169, 0.891576140600447, -1.3280061866098196}, 9.910355780512683},
                   {10, {-0.17379960113822268, 0.1793198545487713, -1.4939560390420483}, 10.73788919790689}});
    const Eigen::Quaterniond e(-0.32965802928249865, 0.37290448072386606, -0.2607642316820426,
                               0.8272060489750281);
    CHECK((spun[2].body.A - e.toRotationMatrix()).norm() < 5e-12);
    CHECK((spun[2].a_bar - Vec3(-0.23298501822151152, 0.31959988298379705, -0.30589850617658343)).norm() <
          5e-12);
    CHECK((spun[2].F_t - Vec3(-0.37754406131827933, 0.030092534406449878, 0.01013340311049582)).norm() <
          5e-12);
    CHECK(bowl.roll({.p = p}, {0})[0].F_N == Approx(9.014262047215154).epsilon(1e-15));
}

TEST_CASE("one angle and two coordinates give the same planar motion", "[reference][bowl]")
{
    const PlanarBowl plane;
    const BallInBowl bowl;
    const std::vector<double> instants{0, 0.3, 1, 2, 4};
    const Vec3 p = bowl.point(0, 1.5), forward(0, bowl.normal(p).z(), -bowl.normal(p).y());
    for (const double v : {0.0, -1.5}) {
        const BallInBowl::InitialState start{.p = p, .rdot = v * forward};
        CHECK(largest_difference(plane.slide({.v = v}, instants), bowl.slide(start, instants)) < 1e-11);
        CHECK(largest_difference(plane.roll({.v = v}, instants), bowl.roll(start, instants)) < 1e-11);
    }
    CHECK(largest_difference(plane.roll({}, instants), plane.resist({}, {.eta = 0}, instants).instant) <
          1e-11);
}

TEST_CASE("the ball passes the equator and covers the whole ellipsoid", "[reference][bowl]")
{
    const PlanarBowl plane;
    const BallInBowl bowl;
    const std::vector<double> instants{0.05, 0.15, 0.25, 0.4, 0.6, 0.9};
    const auto round = plane.slide({.y = 0, .v = 14}, instants);
    CHECK(largest_difference(round, bowl.slide({.rdot = Vec3(0, 14, 0)}, instants)) <
          1e-9);  // accelerations are about 400 m/s²
    double highest = 0;
    for (const ContactInstant& x : round) {
        CHECK(x.F_N > 0);
        CHECK(bowl.energy(x.body) == Approx(bowl.energy(round[0].body)).epsilon(1e-12));
        highest = std::max(highest, x.p.z());
    }
    CHECK(highest > 1);
    const auto aslant = bowl.roll({.rdot = Vec3(5, 14, 0), .spin = -20}, instants);
    for (const ContactInstant& x : aslant)
        CHECK(bowl.energy(x.body) == Approx(bowl.energy(aslant[0].body)).epsilon(1e-12));
}

TEST_CASE("the motions in the bowl satisfy the equations of motion", "[reference][bowl]")
{
    const PlanarBowl plane{.R = 0.4, .m = 1.3};
    const BallInBowl bowl{.R = 0.4, .m = 1.3};
    const Vec3 p = bowl.point(-1, 1.2), n = bowl.normal(p), rdot = n.cross(Vec3(0.3, -1, 2));
    const Mat3 A = tests::Random(3).rotation(), J_bar = bowl.J * Mat3::Identity();
    const double rate = 8, h = 4e-3 / rate;
    const auto instants = tests::five_instants(0.8, h);
    const BallInBowl::InitialState start{.p = p, .rdot = rdot, .spin = 4, .A = A};
    const auto slide = bowl.slide(start, instants), roll = bowl.roll(start, instants);
    for (const auto& run : {slide, roll, plane.slide({}, instants), plane.roll({}, instants),
                            plane.resist({}, {.eta = 0.2}, instants).instant})
        tests::check_motion(run, h, 1.3, J_bar, 9.81, rate);
    const double fast = 400;  // K_D (1/m + R²/J)
    tests::check_motion(plane.spring({}, {}, tests::five_instants(0.02, 4e-3 / fast)), 4e-3 / fast, 1.3,
                        J_bar, 9.81, fast);

    CHECK(roll[2].slip().norm() < 1e-14);
    CHECK(slide[2].F_t.norm() < 1e-13);
    CHECK((roll[2].body.A * roll[2].body.omega_bar).dot(roll[2].n) != Approx(4).margin(1e-3));
    CHECK((slide[2].body.omega_bar - A.transpose() * (4 * n)).norm() < 1e-13);
}

TEST_CASE("a bowl of revolution conserves the angular momentum about its axis", "[reference][bowl]")
{
    const BallInBowl bowl{.semi_axes = Vec3(2, 2, 1.5), .R = 0.3, .m = 0.7};
    const Vec3 p = bowl.point(0.5, -1), n = bowl.normal(p);
    const auto L_z = [&](const ContactInstant& x) { return bowl.m * x.body.r.cross(x.body.rdot).z(); };
    const auto slide = bowl.slide({.p = p, .rdot = n.cross(Vec3(1, -1.5, 0))}, {0, 1, 3});
    for (const ContactInstant& x : slide) {
        CHECK(L_z(x) == Approx(L_z(slide[0])).epsilon(1e-12));
        CHECK(bowl.energy(x.body) == Approx(bowl.energy(slide[0].body)).epsilon(1e-12));
    }

    // horizontal circle at the height of p: F_N n + m g is the centripetal force m v²/r
    const Vec3 inwards = -Vec3(p.x(), p.y(), 0).normalized();
    const double r = (p + bowl.R * n).head<2>().norm(), v = std::sqrt(r * 9.81 * n.dot(inwards) / n.z());
    const auto circle = bowl.slide({.p = p, .rdot = v * inwards.cross(Vec3::UnitZ())}, {0, 1, 3});
    for (const ContactInstant& x : circle) {
        CHECK(x.p.z() == Approx(p.z()).epsilon(1e-11));
        CHECK(x.F_N == Approx(bowl.m * 9.81 / n.z()).epsilon(1e-11));
    }
}

TEST_CASE("rolling resistance reverses and stops the ball at the reference positions and times",
          "[reference][bowl][acceptance]")
{
    struct Example {
        double eta;
        std::vector<double> y;
        double t;
    };
    for (const Example& c : {Example{0.1, {-1.11118, 0.71410, -0.31204, -0.09213}, 9.406},
                             Example{0.2, {-0.71747, -0.08509}, 4.675}, Example{0.3, {-0.32581}, 2.309}}) {
        INFO("eta " << c.eta);
        const ResistedRolling run = PlanarBowl().resist({}, {.eta = c.eta}, {2.0, 10.0, 12.0});
        REQUIRE(run.reversal.size() == c.y.size());
        for (size_t k = 0; k < c.y.size(); ++k) {
            CHECK(run.reversal[k].y == Approx(c.y[k]).margin(6e-6));
            CHECK(run.reversal[k].at_rest == (k + 1 == c.y.size()));
        }
        CHECK(run.reversal.back().t == Approx(c.t).margin(6e-4));
        CHECK(run.instant[0].body.rdot.norm() > 0);
        CHECK(run.instant[2].t == 12.0);
        CHECK((run.instant[2].p - run.instant[1].p).norm() == 0);
        // at rest, forces and moments are in balance
        CHECK(run.instant[2].body.rddot.norm() < 1e-14);
        CHECK(run.instant[2].body.omegadot_bar.norm() < 1e-13);
    }
}

TEST_CASE("rolling resistance dissipates its work and holds a ball at rest near the bottom",
          "[reference][bowl]")
{
    const PlanarBowl plane;
    const RollingResistance law{.eta = 0.2};
    constexpr int N = 400;  // Simpson's rule over 0.7 s, relative error 1e-12
    std::vector<double> nodes;
    for (int k = 0; k <= N; ++k) nodes.push_back(0.7 + 0.7 * k / N);
    const auto run = plane.resist({}, law, nodes).instant;
    double work = 0;
    for (int k = 0; k <= N; ++k)
        work += (k == 0 || k == N ? 1
                 : k % 2 == 1     ? 4
                                  : 2) *
                run[k].moment.dot(run[k].body.omega_bar) * 0.7 / N / 3;
    const auto energy = [](const ContactInstant& x) { return BallInBowl().energy(x.body); };
    CHECK(energy(run[N]) - energy(run[0]) == Approx(work).epsilon(1e-10));
    CHECK(work < -0.1);

    const ResistedRolling held = plane.resist({.y = 0.05}, law, {0, 5});
    REQUIRE(held.reversal.size() == 1);
    CHECK(held.reversal[0].at_rest);
    CHECK(held.instant[1].p.y() == Approx(0.05).epsilon(1e-15));
}

TEST_CASE("invalid parameters of a bowl are rejected with the value", "[reference][bowl]")
{
    using Catch::Contains;
    const BallInBowl bowl;
    CHECK_THROWS_WITH((BallInBowl{.R = 1.0}.slide({}, {1})),
                      Contains("radius of curvature") && Contains("got 1"));
    CHECK_THROWS_WITH((PlanarBowl{.R = 1.4}.slide({}, {1})),
                      Contains("radius of curvature") && Contains("got 1.4"));
    CHECK_THROWS_WITH(bowl.slide({.p = Vec3(0, 0, -1)}, {1}), Contains("on the bowl"));
    CHECK_THROWS_WITH(bowl.slide({.rdot = Vec3(0, 1, 1)}, {1}), Contains("along the normal"));
    CHECK_THROWS_WITH(bowl.slide({}, {1, 0.5}), Contains("ascend"));
    CHECK_THROWS_WITH(bowl.point(4, 1), Contains("no point of the bowl"));
    CHECK_THROWS_WITH((BallInBowl{.m = -1}.roll({}, {1})), Contains("positive") && Contains("got -1"));
    CHECK_THROWS_WITH(PlanarBowl().slide({.y = 3}, {1}), Contains("lower half of the trough"));
    CHECK_THROWS_WITH(PlanarBowl().resist({}, {.mu_s = 0.1}, {1}),
                      Contains("mu_s must not be smaller than mu_k"));
    CHECK_THROWS_WITH(PlanarBowl().resist({}, {}, {1, 0.5}), Contains("ascend"));
    CHECK_THROWS_AS(PlanarBowl().slide_period(0), lie::InvalidInput);
}
