// SPDX-License-Identifier: GPL-3.0-or-later
/// All blocks: variations, ν and γ compared with differences of Φ and with the published matrix forms;
/// patterns.

#include "dae/constraints/cd.hpp"
#include "dae/constraints/d.hpp"
#include "dae/constraints/dp1.hpp"
#include "dae/constraints/dp2.hpp"
#include "dae/constraints/driven_hinge.hpp"
#include "tests/support/finite_difference.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::dae;
using tests::Random;

namespace {

using Vec12 = Eigen::Matrix<double, 12, 1>;

struct Named {
    std::string name;
    std::unique_ptr<Block> block;
};

template <class B>
Named named(const std::string& name, B block)
{
    return {name, std::make_unique<B>(std::move(block))};
}

/// All types of blocks with random vectors and a driver that depends on time. Add new types here.
std::vector<Named> blocks(int i, int j, Random& random)
{
    const Driver f("1.3 + 0.4*sin(2*t) + 0.2*t^2"), g("0.7*t + 0.5*sin(3*t)");
    const auto v = [&] { return random.vector(); };
    const Mat3 frame = random.rotation();
    std::vector<Named> all;
    all.push_back(named("DP1", DP1(i, v(), j, v(), f)));
    all.push_back(named("DP2", DP2(i, v(), v(), j, v(), f)));
    all.push_back(named("D", D(i, v(), j, v(), f)));
    all.push_back(named("CD", CD(v(), i, v(), j, v(), f)));
    all.push_back(named("DrivenHinge", DrivenHinge(i, frame.col(0), frame.col(1), j, random.unit(), g)));
    return all;
}

/// The same with vectors along coordinate axes and points at centres of mass, for which more derivatives
/// vanish
std::vector<Named> blocks_on_axes(int i, int j)
{
    const Vec3 X = Vec3::UnitX(), Y = Vec3::UnitY(), Z = Vec3::UnitZ(), O = Vec3::Zero();
    std::vector<Named> all;
    all.push_back(named("DP1 x y", DP1(i, X, j, Y)));
    all.push_back(named("DP1 xz z", DP1(i, X + Z, j, Z)));
    all.push_back(named("DP2 y, centres", DP2(i, Y, O, j, O)));
    all.push_back(named("DP2 z, on axes", DP2(i, Z, X, j, 2 * Y)));
    all.push_back(named("D centres", D(i, O, j, O, 1.0)));
    all.push_back(named("D on axes", D(i, X, j, -Z, 1.0)));
    all.push_back(named("CD x, centres", CD(X, i, O, j, O)));
    all.push_back(named("CD z, on axes", CD(Z, i, Y, j, 3 * X)));
    all.push_back(named("CD yz", CD(Y + Z, i, X + Y, j, O)));
    all.push_back(named("DrivenHinge about z", DrivenHinge(i, X, Y, j, X, Driver("0.3+t"))));
    return all;
}

/// The two bodies of a block. One of them may be the ground.
struct Pair {
    int i, j;
    Motion bi, bj;

    Pair(int which, Random& random) : i(which == 1 ? ground : 0), j(which == 2 ? ground : 1)
    {
        if (i != ground) bi = random.motion();
        if (j != ground) bj = random.motion();
    }
    double phi_after(const Block& b, double t, double tau) const
    {
        return b.phi({tests::pose_after(bi, tau), tests::pose_after(bj, tau), t + tau});
    }
};

Vec12 row(const Variation& v)
{
    Vec12 all;
    all << v.r_i, v.pi_i, v.r_j, v.pi_j;
    return all;
}

}  // namespace

TEST_CASE("the first variation of a block is the derivative of phi", "[dae][constraints]")
{
    Random random(GENERATE(range(1u, 11u)));
    const Pair pair(GENERATE(0, 1, 2), random);
    const double t = random.number(0, 2);
    for (const Named& n : blocks(pair.i, pair.j, random)) {
        const Vec12 exact = row(n.block->variation({pair.bi, pair.bj, t}));
        for (int c = 0; c < 12; ++c) {
            const auto phi = [&](double s) {
                const Vec12 delta = s * Vec12::Unit(c);
                return n.block->phi({tests::displaced(pair.bi, delta.head<6>()),
                                     tests::displaced(pair.bj, delta.tail<6>()), t});
            };
            INFO(n.name << ", component " << c);
            CHECK(exact[c] == Approx(tests::derivative(phi)).margin(1e-10));
        }
    }
}

TEST_CASE("nu and gamma complete the first and second time derivatives of phi", "[dae][constraints]")
{
    Random random(GENERATE(range(11u, 21u)));
    const Pair pair(GENERATE(0, 1, 2), random);
    const Motion &bi = pair.bi, &bj = pair.bj;
    const double t = random.number(0, 2);
    Vec12 velocity, acceleration;
    velocity << bi.rdot, bi.omega_bar, bj.rdot, bj.omega_bar;
    acceleration << bi.rddot, bi.omegadot_bar, bj.rddot, bj.omegadot_bar;
    for (const Named& n : blocks(pair.i, pair.j, random)) {
        const auto phi = [&](double tau) { return pair.phi_after(*n.block, t, tau); };
        const Vec12 v = row(n.block->variation({bi, bj, t}));
        INFO(n.name);
        // errors of the differences: 1e-16/h², and h⁴/90 times a sixth derivative of up to 1e3 at these
        // speeds
        CHECK(v.dot(velocity) - n.block->nu({bi, bj, t}) ==
              Approx(tests::derivative(phi, 5e-4)).margin(1e-8));
        CHECK(v.dot(acceleration) - n.block->gamma({bi, bj, t}) ==
              Approx(tests::second_derivative(phi, 1e-3)).epsilon(1e-8).margin(1e-7));
    }
}

TEST_CASE("the second variation of a block is the derivative of its first variation", "[dae][constraints]")
{
    Random random(GENERATE(range(51u, 61u)));
    const Pair pair(GENERATE(0, 1, 2), random);
    const double t = random.number(0, 2);
    for (const Named& n : blocks(pair.i, pair.j, random)) {
        const Mat12 exact = n.block->second_variation({pair.bi, pair.bj, t});
        const Vec12 nu = row(n.block->nu_variation({pair.bi, pair.bj, t}));
        for (int c = 0; c < 12; ++c) {
            const auto moved = [&](auto f) {
                return tests::derivative([&](double s) {
                    const Vec12 delta = s * Vec12::Unit(c);
                    return f(tests::displaced(pair.bi, delta.head<6>()),
                             tests::displaced(pair.bj, delta.tail<6>()));
                });
            };
            const Vec12 column = moved([&](const Motion& a, const Motion& b) {
                return row(n.block->variation({a, b, t}));
            });
            INFO(n.name << ", component " << c);
            CHECK((exact.col(c) - column).cwiseAbs().maxCoeff() < 1e-9);
            CHECK(nu[c] == Approx(moved([&](const Motion& a, const Motion& b) {
                               return n.block->nu({a, b, t});
                           })).margin(1e-9));
        }
        // The blocks of two bodies are symmetric. The rotational block H of one body has H - Hᵀ = tilde(pi).
        const Variation v = n.block->variation({pair.bi, pair.bj, t});
        Mat12 lack = exact - exact.transpose();
        lack.block<3, 3>(3, 3) -= tilde(v.pi_i);
        lack.block<3, 3>(9, 9) -= tilde(v.pi_j);
        CHECK(lack.cwiseAbs().maxCoeff() < 1e-13);
        CHECK((exact - n.block->Block::second_variation({pair.bi, pair.bj, t})).cwiseAbs().maxCoeff() < 1e-8);
    }
}

TEST_CASE("the variation of gamma is its derivative", "[dae][constraints]")
{
    Random random(GENERATE(range(61u, 71u)));
    const Pair pair(GENERATE(0, 1, 2), random);
    const double t = random.number(0, 2);
    using Vec24 = Eigen::Matrix<double, 24, 1>;
    const auto all = [](const GammaDerivatives& g) {
        Vec24 out;
        out << g.i.r, g.i.theta, g.i.rdot, g.i.omega, g.j.r, g.j.theta, g.j.rdot, g.j.omega;
        return out;
    };
    for (const Named& n : blocks(pair.i, pair.j, random)) {
        const Vec24 exact = all(n.block->gamma_variation({pair.bi, pair.bj, t}));
        for (int c = 0; c < 24; ++c) {
            const auto gamma = [&](double s) {
                Motion b[] = {pair.bi, pair.bj};
                Motion& moved = b[c / 12];
                Eigen::Matrix<double, 6, 1> pose = Eigen::Matrix<double, 6, 1>::Zero();
                if (c % 12 < 6)
                    pose[c % 12] = s;
                else
                    (c % 12 < 9 ? moved.rdot : moved.omega_bar)[c % 3] += s;
                moved = tests::displaced(moved, pose);
                return n.block->gamma({b[0], b[1], t});
            };
            INFO(n.name << ", component " << c);
            CHECK(exact[c] == Approx(tests::derivative(gamma)).margin(1e-9));
        }
        CHECK((exact - all(n.block->Block::gamma_variation({pair.bi, pair.bj, t}))).cwiseAbs().maxCoeff() <
              1e-7);
    }
}

TEST_CASE("the pattern of a block contains exactly the derivatives that can differ from zero",
          "[dae][constraints]")
{
    Random random(GENERATE(range(21u, 26u)));
    std::vector<Named> all = blocks(0, 1, random);
    for (Named& n : blocks_on_axes(0, 1)) all.push_back(std::move(n));
    for (const Named& n : all) {
        unsigned seen = 0;
        for (int k = 0; k < 20; ++k) {
            const Pair pair(0, random);
            const Vec12 v = row(n.block->variation({pair.bi, pair.bj, random.number(0, 2)}));
            for (int c = 0; c < 12; ++c)
                if (v[c] != 0) seen |= 1u << c;
        }
        INFO(n.name);
        CHECK(n.block->nonzero() == seen);
    }
}

TEST_CASE("the blocks agree with their published matrix forms", "[dae][constraints]")
{
    // Independent source: the table of first variations and right sides in matrix form.
    Random random(GENERATE(range(31u, 41u)));
    const Pair pair(GENERATE(0, 1, 2), random);
    const Motion &bi = pair.bi, &bj = pair.bj;
    const double t = random.number(0, 2);
    const Vec3 a = random.vector(), b = random.vector(), s = random.vector(), q = random.vector(),
               c = random.vector();
    const Driver f("sin(2*t)");

    using lie::tilde;
    using Row = Eigen::RowVector3d;
    const Mat3 &Ai = bi.A, &Aj = bj.A;
    const Mat3 Wi = tilde(bi.omega_bar), Wj = tilde(bj.omega_bar);
    const Vec3 u = Ai * a, w = Aj * b, d = bj.r + Aj * q - bi.r - Ai * s;
    const Vec3 ud = Ai * Wi * a, wd = Aj * Wj * b, uq = Ai * Wi * Wi * a, wq = Aj * Wj * Wj * b;
    const Vec3 dd = bj.rdot + Aj * Wj * q - bi.rdot - Ai * Wi * s, dq = Aj * Wj * Wj * q - Ai * Wi * Wi * s;

    const auto check = [&](const std::string& name, const Block& block, const Row& r_i, const Row& pi_i,
                           const Row& r_j, const Row& pi_j, double gamma) {
        Vec12 expected;
        expected << r_i.transpose(), pi_i.transpose(), r_j.transpose(), pi_j.transpose();
        INFO(name);
        CHECK((row(block.variation({bi, bj, t})) - expected).cwiseAbs().maxCoeff() < 1e-14);
        CHECK(block.nu({bi, bj, t}) == f.fdot(t));
        CHECK(block.gamma({bi, bj, t}) == Approx(gamma + f.fddot(t)).epsilon(1e-14).margin(2e-14));
    };
    const Row zero = Row::Zero(), ut = u.transpose(), wt = w.transpose(), dt = d.transpose(),
              ct = c.transpose();
    check("DP1", DP1(pair.i, a, pair.j, b, f), zero, -wt * Ai * tilde(a), zero, -ut * Aj * tilde(b),
          -(uq.dot(w) + 2 * ud.dot(wd) + u.dot(wq)));
    check("DP2", DP2(pair.i, a, s, pair.j, q, f), -ut, a.transpose() * tilde(s) - dt * Ai * tilde(a), ut,
          -ut * Aj * tilde(q), -(uq.dot(d) + 2 * ud.dot(dd) + u.dot(dq)));
    check("D", D(pair.i, s, pair.j, q, f), -2 * dt, 2 * dt * Ai * tilde(s), 2 * dt, -2 * dt * Aj * tilde(q),
          -2 * dd.dot(dd) - 2 * d.dot(dq));
    check("CD", CD(c, pair.i, s, pair.j, q, f), -ct, ct * Ai * tilde(s), ct, -ct * Aj * tilde(q), -c.dot(dq));
}

TEST_CASE("a driven hinge is a dot product with a vector that rotates with the driver", "[dae][constraints]")
{
    // Comparison with DP1 between body j and a third body that rotates in body i about u × u' by g(t).
    Random random(GENERATE(range(41u, 46u)));
    const Pair pair(0, random);
    const Mat3 frame = random.rotation();
    const Vec3 w = random.unit(), axis = frame.col(2);
    const Driver g("0.7*t + 0.5*sin(3*t)");
    const double t = random.number(0, 2);
    const DrivenHinge hinge(0, frame.col(0), frame.col(1), 1, w, g);

    Motion turning = pair.bi;
    const Mat3 R = lie::exp(g.f(t) * axis);
    turning.A = pair.bi.A * R;
    turning.omega_bar = R.transpose() * pair.bi.omega_bar + g.fdot(t) * axis;
    const DP1 dot(0, frame.col(1), 1, w);
    CHECK(hinge.phi({pair.bi, pair.bj, t}) == Approx(dot.phi({turning, pair.bj, t})).margin(1e-15));
    const Variation of_dot = dot.variation({turning, pair.bj, t}),
                    of_hinge = hinge.variation({pair.bi, pair.bj, t});
    CHECK((of_hinge.pi_i - R * of_dot.pi_i).norm() < 1e-15);
    CHECK((of_hinge.pi_j - of_dot.pi_j).norm() < 1e-15);
    CHECK(hinge.nu({pair.bi, pair.bj, t}) == Approx(-g.fdot(t) * of_dot.pi_i.dot(axis)).margin(1e-14));
    // ω̄̇ of the third body is R^T ω̄̇_i + g'' axis - g' axis × R^T ω̄_i.
    const Vec3 omegadot_bar = g.fddot(t) * axis - g.fdot(t) * axis.cross(R.transpose() * pair.bi.omega_bar);
    CHECK(hinge.gamma({pair.bi, pair.bj, t}) ==
          Approx(dot.gamma({turning, pair.bj, t}) - of_dot.pi_i.dot(omegadot_bar)).margin(2e-14));
}

TEST_CASE("a block rejects data for which it is singular", "[dae][constraints]")
{
    const Motion m;
    const Vec3 X = Vec3::UnitX(), Y = Vec3::UnitY(), O = Vec3::Zero();
    CHECK(DP1(0, X, 1, Y).start_error({m, m, 0}).empty());
    CHECK(DP1(0, 2 * X, 1, Y, 1.9).start_error({m, m, 0}).empty());
    CHECK_THAT(DP1(0, X, 1, Y, 1.1).start_error({m, m, 0}), Catch::Contains("got 1.1"));
    CHECK_THAT(DP1(0, X, 1, Y, -1.0).start_error({m, m, 0}), Catch::Contains("parallel"));
    CHECK_THAT(DP1(0, X, 1, Y, Driver("cos(t)")).start_error({m, m, 0}), Catch::Contains("parallel"));
    CHECK(DP1(0, X, 1, Y, Driver("cos(t)")).start_error({m, m, 1}).empty());
    CHECK(D(0, X, 1, Y, 2.0).start_error({m, m, 0}).empty());
    CHECK_THAT(D(0, X, 1, Y, 0.0).start_error({m, m, 0}), Catch::Contains("got 0"));
    CHECK_THAT(D(0, X, 1, Y, Driver("1-t")).start_error({m, m, 3}), Catch::Contains("got -2"));
    // with a vector of length zero the row is zero
    CHECK_THAT(DP1(0, O, 1, Y).start_error({m, m, 0}), Catch::Contains("length zero"));
    CHECK_THAT(DP1(0, X, 1, O).start_error({m, m, 0}), Catch::Contains("length zero"));
    CHECK_THAT(DP2(0, O, X, 1, Y).start_error({m, m, 0}), Catch::Contains("length zero"));
    CHECK_THAT(CD(O, 0, X, 1, Y).start_error({m, m, 0}), Catch::Contains("length zero"));
}
