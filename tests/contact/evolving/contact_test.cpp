// SPDX-License-Identifier: GPL-3.0-or-later
/// Rows, kinematics and multipliers of an evolving contact at one instant.

#include "dae/model.hpp"
#include "lie/solver/saddle.hpp"
#include "tests/support/evolving.hpp"
#include "tests/support/finite_difference.hpp"

#include <catch2/catch.hpp>

#include <Eigen/LU>

using namespace hilda;
using namespace hilda::contact;
using namespace hilda::tests;

namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;

dae::Constraint::Derivatives derivatives_of(const EvolvingContact& c, const dae::Constraint::Arguments& at)
{
    dae::Constraint::Derivatives d;
    d.C_i.setZero(c.position_rows() + c.velocity_rows(), 6);
    d.C_j.setZero(c.position_rows() + c.velocity_rows(), 6);
    d.Phi_alpha.setZero(c.position_rows(), c.algebraic_variables());
    c.variation(at, d);
    return d;
}

/// Slip velocity: velocity of the material point of i minus that of j [m/s]
Vec3 slip(const Motion& bi, const Motion& bj, const Vec6& alpha)
{
    const auto v = [](const Motion& b, const Vec3& a) { return Vec3(b.rdot + b.A * b.omega_bar.cross(a)); };
    return v(bi, alpha.head<3>()) - v(bj, alpha.tail<3>());
}

/// The contact after a time τ while both bodies rotate and translate: body i is moved along the common normal
/// so that contact is kept. This does not change the contact points.
ContactPose after(const EvolvingContact& c, const ContactPose& x, double tau)
{
    ContactPose y = x;
    y.bi = pose_after(x.bi, tau), y.bj = pose_after(x.bj, tau);
    for (int k = 0; k < 2; ++k) c.update_alpha(y.at(), false, y.alpha.data());
    const ContactPoint at = c.contact_point(y.at());
    y.bi.r -= at.gap * at.n;
    return y;
}

/// A ᾱ̇ of both points, by Montana's contact equations without charts
std::pair<Vec3, Vec3> rolling_rates(const ContactPoint& at, const Vec3& omega, const Vec3& s)
{
    const Vec3 n = -at.n;
    const Eigen::Matrix<double, 3, 2> T = tangent_basis(n);
    const Eigen::Matrix2d K = T.transpose() * (at.K_i + at.K_j) * T;
    const auto rate = [&](const Vec3& right) { return Vec3(T * K.fullPivLu().solve(T.transpose() * right)); };
    return {rate(n.cross(omega) - at.K_j * s), rate(n.cross(omega) + at.K_i * s)};
}

}  // namespace

TEST_CASE("the variation of an evolving contact equals central differences", "[contact][evolving]")
{
    Random random(GENERATE(1u, 2u, 3u));
    for (const SurfacePair& pair : surface_pairs(random))
        for (const NormalRows normal_rows : {NormalRows::tangent, NormalRows::fixed_xy}) {
            const EvolvingContact c(0, pair.i, 1, pair.j, Friction::rolling, normal_rows);
            ContactPose x = random_contact_pose(pair, random);
            x.bi = displaced(x.bi, 0.1 * Vec6::Random());  // the bodies are apart
            const auto d = derivatives_of(c, x.at());
            const auto change = [&](auto&& move) {
                return derivative([&](double tau) {
                    ContactPose y = x;
                    move(y, tau);
                    Eigen::Matrix<double, 7, 1> Phi;
                    c.phi(y.at(), Phi.data());
                    return Phi;
                });
            };
            const Vec3 n =
                x.bi.A * (pair.i.orientation * pair.i.surface->normal(pair.i.to_surface(x.alpha.head<3>())));
            const Eigen::Matrix<double, 3, 2> across = x.node.T - n * (n.transpose() * x.node.T);
            INFO(pair.name);
            for (int k = 0; k < 6; ++k) {
                INFO("component " << k);
                const Vec6 unit = Vec6::Unit(k);
                const double size = c.L;  // derivatives with respect to rotations are lengths
                CHECK((d.C_i.col(k).head<7>() - change([&](ContactPose& y, double tau) {
                           y.bi = displaced(y.bi, tau * unit);
                       })).norm() < 1e-8 * size);
                CHECK((d.C_j.col(k).head<7>() - change([&](ContactPose& y, double tau) {
                           y.bj = displaced(y.bj, tau * unit);
                       })).norm() < 1e-8 * size);
                CHECK((d.Phi_alpha.col(k) - change([&](ContactPose& y, double tau) {
                                                y.alpha += 0.1 * c.L * tau * unit;
                                            }) / (0.1 * c.L))
                          .norm() < 1e-8);
                // Rolling rows: virtual velocity of the material points, projected on the tangent plane of i
                Motion bi = x.bi, bj = x.bj;
                bi.rdot = unit.head<3>(), bi.omega_bar = unit.tail<3>();
                bj.rdot.setZero(), bj.omega_bar.setZero();
                CHECK((d.C_i.col(k).tail<2>() - across.transpose() * slip(bi, bj, x.alpha)).norm() < 1e-14);
                std::swap(bi.rdot, bj.rdot), std::swap(bi.omega_bar, bj.omega_bar);
                CHECK((d.C_j.col(k).tail<2>() - across.transpose() * slip(bi, bj, x.alpha)).norm() < 1e-14);
            }
            for (int row = 0; row < 9; ++row)
                for (int k = 0; k < 12; ++k)
                    if (!(c.nonzero(row) >> k & 1)) CHECK((k < 6 ? d.C_i(row, k) : d.C_j(row, k - 6)) == 0);
        }
}

TEST_CASE("the velocities of the contact points satisfy Montana's equations", "[contact][evolving]")
{
    Random random(GENERATE(4u, 5u));
    for (const SurfacePair& pair : surface_pairs(random)) {
        const EvolvingContact c(0, pair.i, 1, pair.j);
        ContactPose x = random_contact_pose(pair, random);
        x.bi.omega_bar *= 0.3, x.bj.omega_bar *= 0.3, x.bi.rdot *= 0.3, x.bj.rdot *= 0.3;
        INFO(pair.name << ", least curvature " << least_curvature(c.contact_point(x.at())));
        REQUIRE(least_curvature(c.contact_point(x.at())) > 0.05);
        const Vec6 alphadot = derivative([&](double tau) { return after(c, x, tau).alpha; });
        const Vec3 rdot = derivative([&](double tau) { return after(c, x, tau).bi.r; });
        x.bi.rdot = rdot;
        const auto [adot_i, adot_j] =
            rolling_rates(c.contact_point(x.at()), x.bi.A * x.bi.omega_bar - x.bj.A * x.bj.omega_bar,
                          slip(x.bi, x.bj, x.alpha));
        CHECK((x.bi.A * alphadot.head<3>() - adot_i).norm() < 1e-8 * (1 + adot_i.norm()));
        CHECK((x.bj.A * alphadot.tail<3>() - adot_j).norm() < 1e-8 * (1 + adot_j.norm()));
        CHECK(c.velocity_violation(x.at(), 0).value < 1e-8);
    }
}

TEST_CASE("gamma of an evolving contact equals its second derivative without the acceleration terms",
          "[contact][evolving]")
{
    Random random(GENERATE(6u, 7u));
    for (const SurfacePair& pair : surface_pairs(random)) {
        const EvolvingContact c(0, pair.i, 1, pair.j, Friction::rolling);
        ContactPose x = random_contact_pose(pair, random);
        for (Motion* b : {&x.bi, &x.bj}) {
            b->omega_bar *= 0.3, b->rdot *= 0.3, b->rddot *= 0.3, b->omegadot_bar *= 0.3;
        }
        const ContactPose start = x;
        x.bi.rdot = derivative([&](double tau) { return after(c, start, tau).bi.r; });
        x.bi.rddot = second_derivative([&](double tau) { return after(c, start, tau).bi.r; });
        const Vec6 alphaddot = second_derivative([&](double tau) { return after(c, start, tau).alpha; });
        Vec6 q_i, q_j;
        q_i << x.bi.rddot, x.bi.omegadot_bar;
        q_j << x.bj.rddot, x.bj.omegadot_bar;
        Eigen::Matrix<double, 9, 1> gamma;
        c.gamma(x.at(), gamma.data());
        const auto d = derivatives_of(c, x.at());
        INFO(pair.name);
        const Eigen::Matrix<double, 7, 1> left =
            d.C_i.topRows<7>() * q_i + d.C_j.topRows<7>() * q_j + d.Phi_alpha * alphaddot;
        const double scale = 1 + left.norm() + (d.Phi_alpha * alphaddot).norm() + q_i.norm();
        CHECK((left - gamma.head<7>()).norm() < 1e-7 * scale);

        // Rolling rows: relative tangential acceleration of the material points, with constant tangents
        const Vec3 slipping = derivative([&](double tau) {
            ContactPose y = after(c, start, tau);
            y.bi.rdot = x.bi.rdot + tau * x.bi.rddot, y.bj.rdot += tau * x.bj.rddot;
            for (Motion* b : {&y.bi, &y.bj}) b->omega_bar += tau * b->omegadot_bar;
            return slip(y.bi, y.bj, y.alpha);
        });
        const Eigen::Vector2d rolling = d.C_i.bottomRows<2>() * q_i + d.C_j.bottomRows<2>() * q_j;
        CHECK((rolling - gamma.tail<2>() - x.node.T.transpose() * slipping).norm() < 1e-7 * scale);
    }
}

namespace {

/// A contact of two free bodies under gravity, with consistent velocities
struct TwoBodies {
    dae::Model model;
    lie::State x;

    TwoBodies(const SurfacePair& pair, Random& random, Friction friction)
    {
        for (const char* name : {"i", "j"}) {
            const Mat3 A = random.rotation();
            model.add({name, random.number(0.5, 2),
                       random.number(0.1, 0.3) * A * Vec3(1, 1.5, 2).asDiagonal() * A.transpose()});
        }
        model.gravity = random.vector(9.81);
        model.constrain("contact", std::make_unique<EvolvingContact>(0, pair.i, 1, pair.j, friction));
        const ContactPose at = random_contact_pose(pair, random);
        x.body = {at.bi, at.bj};
        dae::start(model, x, {.fix_initial = true});
    }
    ContactPoint contact_point() const
    {
        return contact_of(model).contact_point(model.arguments(contact_of(model), x));
    }
};

/// Contact force on body i without constraints or multipliers: from the relative acceleration of the two
/// material points, which a force f changes by W f.
Vec3 force_on_i(const TwoBodies& two, Friction friction)
{
    const ContactPoint at = two.contact_point();
    const Vec3 n = -at.n;
    const lie::State& x = two.x;
    const Vec3 s = slip(x.body[0], x.body[1], x.alpha);
    const Vec3 omega_i = x.body[0].A * x.body[0].omega_bar, omega_j = x.body[1].A * x.body[1].omega_bar;
    const auto [adot_i, adot_j] = rolling_rates(at, omega_i - omega_j, s);

    Mat3 W = Mat3::Zero();
    Vec3 relative =
        omega_i.cross(adot_i) - omega_j.cross(adot_j);  // d/dt of the slip without the contact force
    for (const int b : {0, 1}) {
        const Motion& body = x.body[b];
        const Mat3& J_bar = two.model.mass().J_bar[b];
        const Vec3 a_bar = x.alpha.segment<3>(3 * b), arm = body.A * a_bar, omega = body.A * body.omega_bar;
        const Mat3 turning =
            lie::tilde(arm) * body.A * J_bar.inverse() * body.A.transpose() * lie::tilde(arm);
        W += Mat3::Identity() / two.model.mass().m[b] - turning;
        const Vec3 omegadot_bar = -J_bar.inverse() * body.omega_bar.cross(J_bar * body.omega_bar);
        const Vec3 acceleration =
            two.model.gravity + (body.A * omegadot_bar).cross(arm) + omega.cross(omega.cross(arm));
        relative += (b == 0 ? 1 : -1) * acceleration;
    }
    const Vec3 ndot = omega_i.cross(n) + at.K_i * adot_i;
    if (friction == Friction::rolling) return -W.inverse() * (relative + ndot.dot(s) * n);
    return -(n.dot(relative) + ndot.dot(s)) / n.dot(W * n) * n;
}

}  // namespace

TEST_CASE("the contact force at a start follows from the accelerations of the material points",
          "[contact][evolving]")
{
    Random random(GENERATE(8u, 9u, 10u));
    for (const Friction friction : {Friction::none, Friction::rolling})
        for (const SurfacePair& pair : surface_pairs(random)) {
            const TwoBodies two(pair, random, friction);
            const auto lambda = multipliers(two.model, two.x);
            const Vec3 f = force_on_i(two, friction), n = -two.contact_point().n;
            INFO(pair.name << (friction == Friction::rolling ? ", rolling" : "") << ", F_N " << lambda.F_N);
            const double scale = f.norm() + two.model.gravity.norm();
            CHECK(std::abs(lambda.F_N + f.dot(n)) < 1e-12 * scale);
            CHECK((-lambda.F_N * n + lambda.friction - f).norm() < 1e-11 * scale);
        }
}

TEST_CASE("the multipliers of an evolving contact are a force along the normal", "[contact][evolving]")
{
    // λ_N = 0, λ_Ψ = F_N n_i, λ_G = -F_N (σ_i, σ_j); the reaction on body i is -λ_Ψ
    Random random(GENERATE(11u, 12u));
    for (const SurfacePair& pair : surface_pairs(random)) {
        const TwoBodies two(pair, random, Friction::none);
        const auto lambda = multipliers(two.model, two.x);
        const EvolvingContact& c = contact_of(two.model);
        INFO(pair.name << ", F_N " << lambda.F_N);
        const double scale = std::abs(lambda.F_N) + 1,
                     condition = 1 + 1 / (c.L * least_curvature(two.contact_point()));
        CHECK(lambda.N.norm() < 1e-12 * scale);
        CHECK(lambda.tangential.norm() < 1e-12 * scale * condition);
        CHECK(std::abs(lambda.G[0] + lambda.F_N * pair.i.surface->sigma()) < 1e-12 * scale * condition);
        CHECK(std::abs(lambda.G[1] + lambda.F_N * pair.j.surface->sigma()) < 1e-12 * scale * condition);
        const auto reactions = dae::reactions(two.model, two.x);
        const Vec3 n = -two.contact_point().n;
        CHECK((reactions[0].F + lambda.F_N * n).norm() < 1e-11 * scale);
        CHECK((reactions[1].F - lambda.F_N * n).norm() < 1e-11 * scale);
        const Vec3 arm = two.x.alpha.head<3>();
        CHECK((reactions[0].T - arm.cross(two.x.body[0].A.transpose() * reactions[0].F)).norm() <
              1e-11 * scale);
    }
}

namespace {

/// A ball of 1 kg in contact with the ground
struct OnGround {
    dae::Model model;
    lie::State x;

    OnGround(const Shape& ball, const Shape& ground, const Vec3& r, Friction friction = Friction::none)
    {
        model.add({"ball", 1, 0.1 * Mat3::Identity()});
        model.constrain("rest", std::make_unique<EvolvingContact>(0, ball, dae::ground, ground, friction));
        x.body.resize(1);
        x.body[0].r = r;
    }
};

}  // namespace

TEST_CASE("surfaces without a unique contact point are rejected", "[contact][evolving]")
{
    const Shape ball = shape<Sphere>(0.5);
    const auto refused = [](const Shape& i, const Shape& j, const Vec3& r, const std::string& why) {
        INFO(why);
        CHECK_THROWS_AS(
            [&] {
                OnGround o(i, j, r);
                dae::start(o.model, o.x);
            }(),
            lie::InvalidInput);
        CHECK_THROWS_WITH(
            [&] {
                OnGround o(i, j, r);
                dae::start(o.model, o.x);
            }(),
            Catch::Contains(why));
    };
    refused(ball, shape<Sphere>(0.5, true), Vec3::Zero(), "must be less than that of the concave sphere");
    refused(shape<Ellipsoid>(Vec3(0.5, 0.5, 0.5)), shape<Sphere>(0.5, true), Vec3::Zero(), "curve");
    refused(shape<Ellipsoid>(Vec3(0.4, 0.4, 0.05)), shape<Ellipsoid>(Vec3(0.6, 0.6, 0.4), true),
            Vec3(0, 0, -0.35), "curve");
    refused(ball, shape<Ellipsoid>(Vec3(0.6, 0.6, 2), true), Vec3(0, 0, -1.5), "curve");
    refused(shape<Cylinder>(0.5), shape<Plane>(), Vec3(0, 0, 0.5), "must have a single contact point");
    refused(shape<Plane>(), shape<Plane>(), Vec3::Zero(), "must be curved");
    CHECK_NOTHROW(OnGround(ball, shape<Sphere>(0.51, true), Vec3(0, 0, -0.01)));
}

TEST_CASE("bodies that are not in contact at the start are rejected unless they are projected",
          "[contact][evolving]")
{
    const Shape ball = shape<Sphere>(0.5), bowl = shape<Ellipsoid>(Vec3(4, 3, 2), true);
    for (const double z : {-1.4, -1.6}) {
        OnGround o(ball, bowl, Vec3(0, 0, z));
        CHECK_THROWS_AS(dae::start(o.model, o.x), lie::InvalidInput);
        CHECK_THROWS_WITH(dae::start(o.model, o.x),
                          Catch::Contains("contact 'rest'; bodies 'ball', 'ground'") &&
                              Catch::Contains("the gap or overlap is 0.1 m"));
        const dae::StartReport report = dae::start(o.model, o.x, {.fix_initial = true});
        CHECK(report.projected);
        CHECK(report.position_residual == Approx(0.1).epsilon(1e-9));
        CHECK(o.x.body[0].r.z() == Approx(-1.5).epsilon(1e-14));
        CHECK(multipliers(o.model, o.x).F_N == Approx(9.81).epsilon(1e-12));
    }
    for (const double zdot : {-0.25, 0.25}) {
        OnGround o(ball, bowl, Vec3(0, 0, -1.5));
        o.x.body[0].rdot.z() = zdot;
        CHECK_THROWS_AS(dae::start(o.model, o.x), lie::InvalidInput);
        CHECK_THROWS_WITH(dae::start(o.model, o.x), Catch::Contains("violate the contact by 0.25 m/s"));
        dae::start(o.model, o.x, {.fix_initial = true});
        CHECK(std::abs(o.x.body[0].rdot.z()) < 1e-14);
    }
    OnGround rolling(ball, bowl, Vec3(0, 0, -1.5), Friction::rolling);
    rolling.x.body[0].rdot.x() = 0.3;  // slip
    CHECK_THROWS_WITH(dae::start(rolling.model, rolling.x),
                      Catch::Contains("violate the contact by 0.3 m/s"));
    rolling.x.body[0].omega_bar.y() = 0.3 / 0.5;
    CHECK_NOTHROW(dae::start(rolling.model, rolling.x));
}

TEST_CASE("more contacts than degrees of freedom of a body are rejected by name", "[contact][evolving]")
{
    // planes in contact with a ball or an ellipsoid at random points
    const auto box = [](const Shape& body, int planes) {
        dae::Model model;
        model.add({"body", 1, Vec3(0.1, 0.12, 0.15).asDiagonal()});
        Random random(3);
        for (int k = 0; k < planes; ++k) {
            const Vec3 n = random.unit(), a = *body.surface->support(n);
            Shape plane = shape<Plane>();
            plane.position = a;
            plane.orientation << tangent_basis(-n), -n;
            model.constrain("wall " + std::to_string(k + 1),
                            std::make_unique<EvolvingContact>(0, body, dae::ground, plane));
        }
        lie::State x;
        x.body.resize(1);
        return dae::start(model, x);
    };
    const Shape ball = shape<Sphere>(0.5), ellipsoid = shape<Ellipsoid>(Vec3(0.5, 0.6, 0.8));
    CHECK(box(ball, 3).degrees_of_freedom == 3);
    CHECK(box(ellipsoid, 6).degrees_of_freedom == 0);
    for (const auto& [body, planes] : {std::pair{ball, 4}, {ellipsoid, 7}}) {
        try {
            box(body, planes);
            FAIL("not rejected");
        } catch (const lie::NumericalFailure& e) {
            CHECK(e.status == "contact_rank");
            CHECK_THAT(e.what(), Catch::EndsWith("'wall " + std::to_string(planes) + "'"));
        }
    }
}

TEST_CASE("a contact fails if its normals are not opposite or its curvatures match", "[contact][evolving]")
{
    Random random(5);
    const SurfacePair pair = surface_pairs(random)[2];
    const EvolvingContact c(0, pair.i, 1, pair.j);
    ContactPose x = random_contact_pose(pair, random);
    Eigen::VectorXd internal_state(c.internal_states());
    c.update_internal_state(x.at(), true, internal_state.data());
    const Vec3 n = -c.contact_point(x.at()).n;
    const auto T = Eigen::Matrix<double, 3, 2>::Map(internal_state.data());
    CHECK((T.transpose() * T - Eigen::Matrix2d::Identity()).norm() < 1e-15);
    CHECK((T.transpose() * n).norm() < 1e-14);
    const auto status = [&](const EvolvingContact& contact, const ContactPose& at) {
        try {
            contact.update_internal_state(at.at(), false, internal_state.data());
        } catch (const lie::NumericalFailure& e) {
            return e.status;
        }
        return std::string("continues");
    };
    CHECK(status(c, x) == "continues");
    ContactPose opposite = x;  // n_j = n_i is also a root of Tᵀ(n_i + n_j) = 0
    opposite.alpha.head<3>() = 2 * pair.i.position - x.alpha.head<3>();
    CHECK(status(c, opposite) == "contact_lost");
    // a ball at the end of a bowl whose radius of curvature there is that of the ball
    const EvolvingContact tight(0, shape<Sphere>(0.5), 1, shape<Ellipsoid>(Vec3(1, 1, 2), true));
    ContactPose y;
    y.alpha << 0, 0, -0.5, 0, 0, -2;
    y.bi.r = Vec3(0, 0, -1.5);
    CHECK(status(tight, y) == "contact_singular");
}

TEST_CASE("the condition number of an evolving contact does not depend on size", "[contact][evolving]")
{
    const auto at = [](double size, double mass) {
        dae::Model model;
        model.add({"ball", mass, 0.1 * mass * size * size * Mat3::Identity()});
        model.constrain("rest",
                        std::make_unique<EvolvingContact>(0, shape<Sphere>(0.5 * size), dae::ground,
                                                          shape<Ellipsoid>(Vec3(4, 3, 2) * size, true)));
        lie::State x;
        x.body.resize(1);
        x.body[0].r = size * Vec3(0, 1.3203946979732251, -1.2654225449401859);
        dae::start(model, x);
        lie::Saddle K(model);
        K.assemble(x);
        INFO("size " << size << ", mass " << mass);
        CHECK(multipliers(model, x).F_N == Approx(mass * 9.155246512774925).epsilon(1e-12));
        CHECK(K.reciprocal_condition() > 1e-3);  // KLU's estimate; it depends on the pivots
        return condition(model, x, mass, 0.5 * size);
    };
    const double one = at(1, 1);
    CHECK(one < 36);
    for (const double size : {1e-3, 0.1, 1e3})
        for (const double mass : {1e-6, 1e6}) CHECK(at(size, mass) == Approx(one).epsilon(1e-9));
}
