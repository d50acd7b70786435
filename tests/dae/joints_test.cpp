// SPDX-License-Identifier: GPL-3.0-or-later
/// Joints: allowed and constrained motions, number of rows; and the two types of hinge drivers.

#include "dae/joints.hpp"

#include "dae/constraints/dp1.hpp"
#include "dae/kinematics.hpp"
#include "dae/start.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

#include <functional>
#include <numbers>

using namespace hilda;
using namespace hilda::dae;
using tests::Random;

namespace {

using std::numbers::pi;

/// A joint frame fixed in a body: its point, and its axis as the third column of R
struct JointFrame {
    Vec3 s_bar;
    Mat3 R;
    Vec3 axis() const { return 3 * R.col(2); }  // axes may have any length
};

/// Pose of the joint frame of body j relative to that of body i
struct Relative {
    Vec3 d = Vec3::Zero();
    Mat3 Q = Mat3::Identity();
};

Mat3 about(int axis, double angle) { return lie::exp(angle * Vec3::Unit(axis)); }

struct Joint {
    std::string name;
    int freedom;
    std::function<Blocks(int, const JointFrame&, int, const JointFrame&, const State&)> make;
    std::function<Relative(Random&)> allowed;  ///< a random relative pose that the joint allows
    std::vector<int> forbidden;  ///< constrained directions: 0 to 2 along, 3 to 5 about the axes of body i
};

/// All joints. Add new ones here.
std::vector<Joint> joints()
{
    const Mat3 right_angle = about(0, pi / 2);
    const auto turn = [](Random& random) { return random.number(-3, 3); };
    std::vector<Joint> all;
    all.push_back({"spherical",
                   3,
                   [](int i, const JointFrame& a, int j, const JointFrame& b, const State&) {
                       return spherical(i, a.s_bar, j, b.s_bar);
                   },
                   [](Random& random) {
                       return Relative{Vec3::Zero(), random.rotation()};
                   },
                   {0, 1, 2}});
    all.push_back({"revolute",
                   1,
                   [](int i, const JointFrame& a, int j, const JointFrame& b, const State&) {
                       return revolute(i, a.s_bar, a.axis(), j, b.s_bar, b.axis());
                   },
                   [=](Random& random) {
                       return Relative{Vec3::Zero(), about(2, turn(random))};
                   },
                   {0, 1, 2, 3, 4}});
    all.push_back({"cylindrical",
                   2,
                   [](int i, const JointFrame& a, int j, const JointFrame& b, const State&) {
                       return cylindrical(i, a.s_bar, a.axis(), j, b.s_bar, b.axis());
                   },
                   [=](Random& random) {
                       return Relative{random.number() * Vec3::UnitZ(), about(2, turn(random))};
                   },
                   {0, 1, 3, 4}});
    all.push_back({"translational",
                   1,
                   [](int i, const JointFrame& a, int j, const JointFrame& b, const State& x) {
                       return translational(i, a.s_bar, a.axis(), j, b.s_bar, b.axis(), x);
                   },
                   [](Random& random) {
                       return Relative{random.number() * Vec3::UnitZ(), about(2, 0.7)};
                   },
                   {0, 1, 3, 4, 5}});
    all.push_back(
        {"universal",
         2,
         [](int i, const JointFrame& a, int j, const JointFrame& b, const State&) {
             return universal(i, a.s_bar, a.axis(), j, b.s_bar, b.axis());
         },
         [=](Random& random) {
             return Relative{Vec3::Zero(), about(2, turn(random)) * right_angle * about(2, turn(random))};
         },
         {0, 1, 2}});
    all.push_back({"revolute_cylindrical",
                   3,
                   [](int i, const JointFrame& a, int j, const JointFrame& b, const State&) {
                       return revolute_cylindrical(i, a.s_bar, a.axis(), j, b.s_bar, b.axis());
                   },
                   [=](Random& random) {
                       const Mat3 Q = about(2, turn(random)) * right_angle * about(2, turn(random));
                       return Relative{random.number() * Q.col(2), Q};
                   },
                   {2}});  // along the revolute axis, which is perpendicular to the cylindrical axis
    all.push_back(
        {"fixed",
         0,
         [](int i, const JointFrame&, int j, const JointFrame&, const State& x) { return fixed(i, j, x); },
         [](Random&) {
             return Relative{Vec3(0.3, -0.2, 0.5), about(0, 1.0) * about(1, 2.0)};
         },
         {0, 1, 2, 3, 4, 5}});
    all.push_back({"distance",
                   5,
                   [](int i, const JointFrame& a, int j, const JointFrame& b, const State&) {
                       return distance(i, a.s_bar, j, b.s_bar, 1.7);
                   },
                   [](Random& random) {
                       return Relative{1.7 * random.unit(), random.rotation()};
                   },
                   {}});
    return all;
}

/// Moves body j so that its joint frame has the relative pose q to that of body i.
void place(const Motion& bi, const JointFrame& a, Motion& bj, const JointFrame& b, const Relative& q)
{
    const Mat3 frame_i = bi.A * a.R;
    bj.A = frame_i * q.Q * b.R.transpose();
    bj.r = bi.r + bi.A * a.s_bar + frame_i * q.d - bj.A * b.s_bar;
}

/// The two bodies of the joint. One of them may be the ground.
struct Pair {
    int i, j;
    Motion bi, bj;
    State x;

    Pair(int i, int j) : i(i), j(j) {}
    const State& state()
    {
        x.body.clear();
        for (const Motion* b : {&bi, &bj})
            x.body.push_back(*b);  // numbers 0 and 1; number 0 is not used if i is the ground
        return x;
    }
};

Eigen::VectorXd values(const Blocks& blocks, const Motion& bi, const Motion& bj)
{
    Eigen::VectorXd phi(blocks.size());
    for (size_t k = 0; k < blocks.size(); ++k) {
        const bool exchanged = blocks[k]->i != 0 && blocks[k]->j != 1;  // some blocks have exchanged bodies
        phi[k] = exchanged ? blocks[k]->phi({bj, bi, 0}) : blocks[k]->phi({bi, bj, 0});
    }
    return phi;
}

/// Rows by the twelve coordinates (r_i, π_i, r_j, π_j)
Eigen::MatrixXd variations(const Blocks& blocks, const Motion& bi, const Motion& bj)
{
    Eigen::MatrixXd C(blocks.size(), 12);
    for (size_t k = 0; k < blocks.size(); ++k) {
        const bool exchanged = blocks[k]->i != 0 && blocks[k]->j != 1;
        const Variation v = exchanged ? blocks[k]->variation({bj, bi, 0}) : blocks[k]->variation({bi, bj, 0});
        if (exchanged)
            C.row(k) << v.r_j.transpose(), v.pi_j.transpose(), v.r_i.transpose(), v.pi_i.transpose();
        else
            C.row(k) << v.r_i.transpose(), v.pi_i.transpose(), v.r_j.transpose(), v.pi_j.transpose();
    }
    return C;
}

/// A bar of 2 kg on a hinge at its end, with the point `pin` of the ground, the axis `axis` in both frames,
/// and the centre of mass at pin + arm
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

TEST_CASE("a joint has as many independent rows as it removes degrees of freedom", "[dae][joints]")
{
    Random random(GENERATE(range(1u, 6u)));
    for (const Joint& joint : joints()) {
        INFO(joint.name);
        const JointFrame a{random.vector(), random.rotation()}, b{random.vector(), random.rotation()};
        Pair pair(0, 1);
        pair.bi = random.motion();
        place(pair.bi, a, pair.bj, b, joint.allowed(random));
        const Blocks blocks = joint.make(0, a, 1, b, pair.state());
        REQUIRE(static_cast<int>(blocks.size()) == 6 - joint.freedom);

        place(pair.bi, a, pair.bj, b, joint.allowed(random));
        const Eigen::MatrixXd C = variations(blocks, pair.bi, pair.bj);
        const Eigen::VectorXd s = C.jacobiSvd().singularValues();
        CHECK(s[s.size() - 1] > 0.1);
        // The rows are independent for each body alone, as needed if the other body is the ground.
        for (const int first : {0, 6}) {
            const Eigen::MatrixXd one = C.middleCols(first, 6);
            CHECK(one.jacobiSvd().singularValues()[s.size() - 1] > 0.1);
        }
    }
}

TEST_CASE("a joint is satisfied by every allowed motion and violated by constrained ones", "[dae][joints]")
{
    Random random(GENERATE(range(11u, 16u)));
    const int i = GENERATE(0, ground);
    for (const Joint& joint : joints()) {
        INFO(joint.name);
        const JointFrame a{random.vector(), random.rotation()}, b{random.vector(), random.rotation()};
        Pair pair(i, 1);
        if (i != ground) pair.bi = random.motion();
        place(pair.bi, a, pair.bj, b, joint.allowed(random));
        const Blocks blocks = joint.make(i, a, 1, b, pair.state());
        for (int k = 0; k < 10; ++k) {
            if (i != ground) pair.bi = random.motion();  // arbitrary motion of the pair
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
    // The constrained direction of these two joints depends on the pose.
    const JointFrame a{random.vector(), random.rotation()}, b{random.vector(), random.rotation()};
    Motion bi = random.motion(), bj;
    const Mat3 Q = about(2, 1.0) * about(0, pi / 2);
    const Blocks cardan = universal(0, a.s_bar, a.axis(), 1, b.s_bar, b.axis());
    place(bi, a, bj, b, {Vec3::Zero(), lie::exp(0.1 * Vec3::UnitZ().cross(Q.col(2))) * Q});
    CHECK(values(cardan, bi, bj).norm() == Approx(std::sin(0.1)));
    const Blocks rod = distance(0, a.s_bar, 1, b.s_bar, 1.7);
    place(bi, a, bj, b, {1.8 * random.unit(), random.rotation()});
    CHECK(values(rod, bi, bj).norm() == Approx(1.8 * 1.8 - 1.7 * 1.7));
}

TEST_CASE("a joint rejects an invalid axis or length", "[dae][joints]")
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

TEST_CASE("a hinge driver rotates a crank by three revolutions forwards and backwards", "[dae][joints]")
{
    // g is not zero at the start: the rotation is g(t) - g(0)
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

TEST_CASE("a DP1 driver drives whole revolutions with its complement", "[dae][joints]")
{
    // a_i · a_j = cos(angle) is singular twice per revolution. Both senses of rotation, starts in two
    // quadrants, the crank as body i or j.
    const double sense = GENERATE(1.0, -1.0), start_angle = GENERATE(0.4, 2.5);
    const bool crank_first = GENERATE(true, false);
    const bool sine = GENERATE(true, false);
    const Vec3 X = Vec3::UnitX(), Y = Vec3::UnitY(), Z = Vec3::UnitZ();
    Model model;
    State x;
    crank(model, x, Vec3::Zero(), X, {0, 0.3, 0}, sense * 2 * pi);
    // the vector of the crank that encloses start_angle with Y at the start
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
        // The torque about the pin balances the weight, for the driver and for its complement.
        const Reaction on_crank = reactions(model, x)[0];
        const Vec3 about_pin = x.body[0].A * on_crank.T + x.body[0].r.cross(on_crank.F);
        CHECK(about_pin.x() == Approx(2 * 9.81 * x.body[0].r.y()).margin(1e-10));
        CHECK(model.largest_residual(x).value < 1e-13);
    }
    CHECK(swaps >= 7);  // four per revolution, minus one that may occur at the start
}
