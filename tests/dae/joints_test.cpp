// SPDX-License-Identifier: GPL-3.0-or-later
/// Joints: what they allow, what they forbid, how many rows that takes; and the two ways to drive a hinge.

#include "dae/joints.hpp"

#include "dae/constraints/dp1.hpp"
#include "dae/kinematics.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

#include <functional>

using namespace hilda;
using namespace hilda::dae;
using tests::Random;

namespace {

constexpr double pi = 3.14159265358979323846;

/// A joint frame fixed in a body: its point, and its axis as third column of R.
struct Frame {
    Vec3 s_bar;
    Mat3 R;
    Vec3 axis() const { return 3 * R.col(2); }  // joints take axes of any length
};

/// Where the joint frame of body j is, seen from that of body i.
struct Relative {
    Vec3 d = Vec3::Zero();
    Mat3 Q = Mat3::Identity();
};

Mat3 about(int axis, double angle) { return lie::exp(angle * Vec3::Unit(axis)); }

struct Joint {
    std::string name;
    int freedom;
    std::function<Blocks(int, const Frame&, int, const Frame&, const State&)> make;
    std::function<Relative(Random&)> allowed;  ///< a random relative pose the joint allows
    std::vector<int> forbidden;  ///< directions no small motion may take: 0–2 along, 3–5 about the axes of i
};

/// All joints; add the next one here.
std::vector<Joint> joints()
{
    const Mat3 right_angle = about(0, pi / 2);
    const auto turn = [](Random& random) { return random.number(-3, 3); };
    std::vector<Joint> all;
    all.push_back({"spherical",
                   3,
                   [](int i, const Frame& a, int j, const Frame& b, const State&) {
                       return spherical(i, a.s_bar, j, b.s_bar);
                   },
                   [](Random& random) {
                       return Relative{Vec3::Zero(), random.rotation()};
                   },
                   {0, 1, 2}});
    all.push_back({"revolute",
                   1,
                   [](int i, const Frame& a, int j, const Frame& b, const State&) {
                       return revolute(i, a.s_bar, a.axis(), j, b.s_bar, b.axis());
                   },
                   [=](Random& random) {
                       return Relative{Vec3::Zero(), about(2, turn(random))};
                   },
                   {0, 1, 2, 3, 4}});
    all.push_back({"cylindrical",
                   2,
                   [](int i, const Frame& a, int j, const Frame& b, const State&) {
                       return cylindrical(i, a.s_bar, a.axis(), j, b.s_bar, b.axis());
                   },
                   [=](Random& random) {
                       return Relative{random.number() * Vec3::UnitZ(), about(2, turn(random))};
                   },
                   {0, 1, 3, 4}});
    all.push_back({"translational",
                   1,
                   [](int i, const Frame& a, int j, const Frame& b, const State& x) {
                       return translational(i, a.s_bar, a.axis(), j, b.s_bar, b.axis(), x);
                   },
                   [](Random& random) {
                       return Relative{random.number() * Vec3::UnitZ(), about(2, 0.7)};
                   },
                   {0, 1, 3, 4, 5}});
    all.push_back(
        {"universal",
         2,
         [](int i, const Frame& a, int j, const Frame& b, const State&) {
             return universal(i, a.s_bar, a.axis(), j, b.s_bar, b.axis());
         },
         [=](Random& random) {
             return Relative{Vec3::Zero(), about(2, turn(random)) * right_angle * about(2, turn(random))};
         },
         {0, 1, 2}});
    all.push_back({"revolute_cylindrical",
                   3,
                   [](int i, const Frame& a, int j, const Frame& b, const State&) {
                       return revolute_cylindrical(i, a.s_bar, a.axis(), j, b.s_bar, b.axis());
                   },
                   [=](Random& random) {
                       const Mat3 Q = about(2, turn(random)) * right_angle * about(2, turn(random));
                       return Relative{random.number() * Q.col(2), Q};
                   },
                   {2}});  // along the revolute axis, which the cylindrical one is perpendicular to
    all.push_back({"fixed",
                   0,
                   [](int i, const Frame&, int j, const Frame&, const State& x) { return fixed(i, j, x); },
                   [](Random&) {
                       return Relative{Vec3(0.3, -0.2, 0.5), about(0, 1.0) * about(1, 2.0)};
                   },
                   {0, 1, 2, 3, 4, 5}});
    all.push_back({"distance",
                   5,
                   [](int i, const Frame& a, int j, const Frame& b, const State&) {
                       return distance(i, a.s_bar, j, b.s_bar, 1.7);
                   },
                   [](Random& random) {
                       return Relative{1.7 * random.unit(), random.rotation()};
                   },
                   {}});
    return all;
}

/// Places body j so that its joint frame stands in the relative pose q to that of body i.
void place(const Motion& bi, const Frame& a, Motion& bj, const Frame& b, const Relative& q)
{
    const Mat3 frame_i = bi.A * a.R;
    bj.A = frame_i * q.Q * b.R.transpose();
    bj.r = bi.r + bi.A * a.s_bar + frame_i * q.d - bj.A * b.s_bar;
}

/// Both bodies of the joint, one of which may be the ground
struct Pair {
    int i, j;
    Motion bi, bj;
    State x;

    Pair(int i, int j) : i(i), j(j) {}
    const State& state()
    {
        x.body.clear();
        for (const Motion* b : {&bi, &bj})
            x.body.push_back(*b);  // numbers 0 and 1; the ground leaves a spare
        return x;
    }
};

Eigen::VectorXd values(const Blocks& blocks, const Motion& bi, const Motion& bj)
{
    Eigen::VectorXd phi(blocks.size());
    for (size_t k = 0; k < blocks.size(); ++k) {
        const bool turned = blocks[k]->i != 0 && blocks[k]->j != 1;  // some blocks stand from j to i
        phi[k] = turned ? blocks[k]->phi(bj, bi, 0) : blocks[k]->phi(bi, bj, 0);
    }
    return phi;
}

/// Rows by the twelve coordinates (r_i, π_i, r_j, π_j)
Eigen::MatrixXd variations(const Blocks& blocks, const Motion& bi, const Motion& bj)
{
    Eigen::MatrixXd C(blocks.size(), 12);
    for (size_t k = 0; k < blocks.size(); ++k) {
        const bool turned = blocks[k]->i != 0 && blocks[k]->j != 1;
        const Variation v = turned ? blocks[k]->variation(bj, bi, 0) : blocks[k]->variation(bi, bj, 0);
        if (turned)
            C.row(k) << v.r_j.transpose(), v.pi_j.transpose(), v.r_i.transpose(), v.pi_i.transpose();
        else
            C.row(k) << v.r_i.transpose(), v.pi_i.transpose(), v.r_j.transpose(), v.pi_j.transpose();
    }
    return C;
}

/// A bar of 2 kg on a hinge at its end: ground point `pin`, axis `axis` of the ground and of the bar; centre
/// at `arm`.
void crank(Model& model, State& x, const Vec3& pin, const Vec3& axis, const Vec3& arm, double omega)
{
    model.add({.name = "crank", .m = 2, .J_bar = Vec3(0.3, 0.5, 0.6).asDiagonal()});
    Motion m;
    m.r = pin + arm;
    m.omega_bar = omega * axis.normalized();
    m.rdot = m.omega_bar.cross(arm);
    x.body.push_back(m);
    model.constrain("pin", revolute(ground, pin, axis, 0, -arm, axis));
}

}  // namespace

TEST_CASE("a joint has as many independent rows as it takes freedoms", "[dae][joints]")
{
    Random random(GENERATE(range(1u, 6u)));
    for (const Joint& joint : joints()) {
        INFO(joint.name);
        const Frame a{random.vector(), random.rotation()}, b{random.vector(), random.rotation()};
        Pair pair(0, 1);
        pair.bi = random.motion();
        place(pair.bi, a, pair.bj, b, joint.allowed(random));
        const Blocks blocks = joint.make(0, a, 1, b, pair.state());
        REQUIRE(static_cast<int>(blocks.size()) == 6 - joint.freedom);

        place(pair.bi, a, pair.bj, b, joint.allowed(random));
        const Eigen::MatrixXd C = variations(blocks, pair.bi, pair.bj);
        const Eigen::VectorXd s = C.jacobiSvd().singularValues();
        CHECK(s[s.size() - 1] > 0.1);
        // each body alone is held as well: that is what counts where the other is the ground
        for (const int first : {0, 6}) {
            const Eigen::MatrixXd one = C.middleCols(first, 6);
            CHECK(one.jacobiSvd().singularValues()[s.size() - 1] > 0.1);
        }
    }
}

TEST_CASE("a joint holds in every motion it allows and breaks in those it forbids", "[dae][joints]")
{
    Random random(GENERATE(range(11u, 16u)));
    const int i = GENERATE(0, ground);
    for (const Joint& joint : joints()) {
        INFO(joint.name);
        const Frame a{random.vector(), random.rotation()}, b{random.vector(), random.rotation()};
        Pair pair(i, 1);
        if (i != ground) pair.bi = random.motion();
        place(pair.bi, a, pair.bj, b, joint.allowed(random));
        const Blocks blocks = joint.make(i, a, 1, b, pair.state());
        for (int k = 0; k < 10; ++k) {
            if (i != ground) pair.bi = random.motion();  // the pair as a whole goes anywhere
            const Relative q = joint.allowed(random);
            place(pair.bi, a, pair.bj, b, q);
            CHECK(values(blocks, pair.bi, pair.bj).cwiseAbs().maxCoeff() < 2e-14);

            for (const int direction : joint.forbidden) {
                Relative off = q;
                if (direction < 3)
                    off.d[direction] += 0.1;
                else
                    off.Q = about(direction - 3, 0.1) * q.Q;
                place(pair.bi, a, pair.bj, b, off);
                INFO("direction " << direction);
                CHECK(values(blocks, pair.bi, pair.bj).norm() > 0.05);
            }
        }
    }
    // which direction these two forbid depends on where they are
    const Frame a{random.vector(), random.rotation()}, b{random.vector(), random.rotation()};
    Motion bi = random.motion(), bj;
    const Mat3 Q = about(2, 1.0) * about(0, pi / 2);
    const Blocks cardan = universal(0, a.s_bar, a.axis(), 1, b.s_bar, b.axis());
    place(bi, a, bj, b, {Vec3::Zero(), lie::exp(0.1 * Vec3::UnitZ().cross(Q.col(2))) * Q});
    CHECK(values(cardan, bi, bj).norm() == Approx(std::sin(0.1)));
    const Blocks rod = distance(0, a.s_bar, 1, b.s_bar, 1.7);
    place(bi, a, bj, b, {1.8 * random.unit(), random.rotation()});
    CHECK(values(rod, bi, bj).norm() == Approx(1.8 * 1.8 - 1.7 * 1.7));
}

TEST_CASE("a joint refuses an axis or a length that is none", "[dae][joints]")
{
    const Vec3 O = Vec3::Zero(), X = Vec3::UnitX();
    State x;
    x.body.resize(2);
    CHECK_THROWS_AS(revolute(0, O, O, 1, O, X), lie::InvalidInput);
    CHECK_THROWS_AS(revolute(0, O, X, 1, O, O), lie::InvalidInput);
    CHECK_THROWS_AS(cylindrical(0, O, O, 1, O, X), lie::InvalidInput);
    CHECK_THROWS_AS(translational(0, O, X, 1, O, O, x), lie::InvalidInput);
    CHECK_THROWS_AS(universal(0, O, Vec3(NAN, 0, 0), 1, O, X), lie::InvalidInput);
    CHECK_THROWS_AS(revolute_cylindrical(0, O, X, 1, O, O), lie::InvalidInput);
    CHECK_THROWS_AS(distance(0, O, 1, O, 0), lie::InvalidInput);
    CHECK_THROWS_AS(distance(0, O, 1, O, -1), lie::InvalidInput);
    CHECK_THROWS_AS(hinge_driver(0, O, 1, X, Driver("t"), x), lie::InvalidInput);
    CHECK_THROWS_WITH(hinge_driver(0, X, 1, -X, Driver("t"), x),
                      Catch::Contains("parallel") && Catch::Contains("got -1"));
}

TEST_CASE("a hinge driver turns a crank through three whole turns and back", "[dae][joints]")
{
    // g is not zero at the start: the angle counts from there
    const Vec3 axis = Vec3(1, 2, 2) / 3, pin(0.1, 0.2, 0.3), arm = 0.5 * axis.unitOrthogonal();
    const Driver g("3*pi*(1 - cos(pi*t)) + 0.4");
    Model model;
    State x;
    crank(model, x, pin, axis, arm, g.fdot(0));
    model.constrain("motor", hinge_driver(ground, axis, 0, 2 * axis, g, x));
    dae::start(model, x);
    Kinematics kinematics(model);
    for (int k = 1; k <= 100; ++k) {
        kinematics.move_to(x, 0.02 * k, 2e-3);
        INFO("t = " << x.t);
        CHECK((x.body[0].A - lie::exp((g.f(x.t) - 0.4) * axis)).norm() < 1e-13);
        CHECK((x.body[0].omega_bar - g.fdot(x.t) * axis).norm() < 1e-11);
        CHECK((x.body[0].omegadot_bar - g.fddot(x.t) * axis).norm() < 1e-10);
    }
}

TEST_CASE("a DP1 driver swaps to its complement and so drives whole turns", "[dae][joints]")
{
    // a_i · a_j = cos(angle) is singular twice a turn. Both ways round, from both quadrants, with the crank
    // as body i or j.
    const double sense = GENERATE(1.0, -1.0), start_angle = GENERATE(0.4, 2.5);
    const bool crank_first = GENERATE(true, false);
    const bool sine = GENERATE(true, false);
    const Vec3 X = Vec3::UnitX(), Y = Vec3::UnitY(), Z = Vec3::UnitZ();
    Model model;
    State x;
    crank(model, x, Vec3::Zero(), X, {0, 0.3, 0}, sense * 2 * pi);
    // the vector of the crank that stands at start_angle from Y when the crank has not turned
    const Vec3 a_bar = std::cos(start_angle) * Y + std::sin(start_angle) * Z;
    std::ostringstream f;
    f.precision(17);
    f << (sine ? "sin(" : "cos(") << sense << "*2*pi*t + " << start_angle << ")";
    const Vec3 reference = sine ? Z : Y;
    model.constrain("motor", crank_first ? DP1(0, a_bar, ground, reference, Driver(f.str()))
                                         : DP1(ground, reference, 0, a_bar, Driver(f.str())));
    dae::start(model, x);
    Kinematics kinematics(model);
    int swaps = 0, branch = x.discrete_state[0];
    for (int k = 1; k <= 100; ++k) {
        kinematics.move_to(x, 0.02 * k);
        if (x.discrete_state[0] != branch) ++swaps, branch = x.discrete_state[0];
        INFO(f.str() << " at t = " << x.t << ", crank is body " << (crank_first ? "i" : "j"));
        CHECK((x.body[0].A - lie::exp(sense * 2 * pi * x.t * X)).norm() < 1e-12);
        CHECK((x.body[0].omega_bar - sense * 2 * pi * X).norm() < 1e-11);
        // the torque about the pin that holds the weight, the same on either branch
        const Reaction on_crank = reactions(model, x)[0];
        const Vec3 about_pin = x.body[0].A * on_crank.T + x.body[0].r.cross(on_crank.F);
        CHECK(about_pin.x() == Approx(2 * 9.81 * x.body[0].r.y()).margin(1e-10));
        CHECK(model.largest_residual(x).value < 1e-13);
    }
    CHECK(swaps >= 7);  // four a turn, less one that may be made at the start
}
