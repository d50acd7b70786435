// SPDX-License-Identifier: GPL-3.0-or-later
// Tracked friction on evolving contacts: a ball in a bowl as in Fang (2022), Sec. 5.5.2.
#include "contact/evolving/friction.hpp"
#include "contact/evolving/unilateral.hpp"
#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"
#include "dae/forces/spring_damper.hpp"
#include "dae/start.hpp"
#include "lie/schemes.hpp"
#include "lie/trajectory.hpp"
#include "tests/support/no_allocation.hpp"
#include "tests/support/watched_march.hpp"

#include <array>

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::contact;
using lie::State;
using tests::march;

namespace {

// Table 5.1, for a homogeneous sphere
constexpr double m = 1, I = 0.1, R = 0.5, K_E = 1e4, K_D = 100;
const Vec3 semi_axes(4, 3, 2);

FrictionParameters rubber(double eta_r = 0)
{
    return {.mu_s = 0.25, .mu_k = 0.2, .K_E = K_E, .eta_r = eta_r, .D_slide = K_D, .static_start = false};
}

Shape sphere(double radius = R) { return {.surface = std::make_shared<Sphere>(radius)}; }
Shape bowl(const Mat3& orientation = Mat3::Identity())
{
    return {.surface = std::make_shared<Ellipsoid>(semi_axes, true), .orientation = orientation};
}

/// Centre of the sphere whose contact point on the bowl is at (0, y)
Vec3 centre_over(double y)
{
    const Vec3 p(0, y, -semi_axes.z() * std::sqrt(1 - y * y / (semi_axes.y() * semi_axes.y())));
    return p - R * p.cwiseQuotient(semi_axes.cwiseAbs2()).normalized();
}

/// A ball in the bowl, with its contact point at (0, 1.5)
struct Bowl {
    dae::Model model;
    State x;

    explicit Bowl(const FrictionParameters& p, bool swapped = false, const Mat3& turned = Mat3::Identity())
    {
        model.gravity = turned * model.gravity;
        model.add({.name = "ball", .m = m, .J_bar = I * Mat3::Identity()});
        auto contact = swapped ? std::make_unique<EvolvingContact>(dae::ground, bowl(turned), 0, sphere())
                               : std::make_unique<EvolvingContact>(0, sphere(), dae::ground, bowl(turned));
        const EvolvingContact& c = *contact;
        model.constrain("ball-bowl", std::move(contact));
        model.load(std::make_unique<EvolvingFriction>(model, c, friction_law("slide-roll-spin").make(p)));
        x.body.resize(1);
        x.body[0].r = turned * centre_over(1.5);
    }
    void start() { dae::start(model, x); }
    const EvolvingFriction& friction() const
    {
        return dynamic_cast<const EvolvingFriction&>(*model.forces()[0]);
    }
};

struct Released : Bowl {
    explicit Released(double eta_r) : Bowl(rubber(eta_r)) { start(); }
};

/// The same motion in the plane x = 0 as an ODE in (φ, v, ω, S). The centre moves along the curve at distance
/// R inside the ellipse (3 sin φ, -2 cos φ), with a spring-damper friction that sticks:
///
///     φ̇ |p'|(1 - R κ) = v,   m v̇ = -m g t_z + F,   I ω̇ = R F,   Ṡ = v + R ω,   F = -K_E S - K_D Ṡ
Vec3 centre_by_ode(double t)
{
    using Vec4 = Eigen::Vector4d;
    const double a = semi_axes.y(), c = semi_axes.z();
    const auto slope = [&](const Vec4& y) -> Vec4 {
        const double cosine = std::cos(y[0]), sine = std::sin(y[0]);
        const double speed = std::hypot(a * cosine, c * sine);  // |p'|
        const double kappa = a * c / (speed * speed * speed);
        const double slip = y[1] + R * y[2], F = -K_E * y[3] - K_D * slip;
        return {y[1] / (speed * (1 - R * kappa)), -9.81 * c * sine / speed + F / m, R * F / I, slip};
    };
    Vec4 y(std::asin(1.5 / a), 0, 0, 0);
    const int steps = static_cast<int>(std::lround(t / 2e-4));
    const double h = t / steps;
    for (int n = 0; n < steps; ++n) {
        const Vec4 k1 = slope(y), k2 = slope(y + 0.5 * h * k1), k3 = slope(y + 0.5 * h * k2),
                   k4 = slope(y + h * k3);
        y += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    return centre_over(a * std::sin(y[0]));
}

/// Power of friction on both bodies [W]
double power(const EvolvingFriction& f, const State& x)
{
    const Wrench w = f.friction(x);
    const Vec3 C = f.at(x).contact_state.contact_point.C();
    double sum = 0;
    const auto of = [&](int b, const Vec3& F, const Vec3& T) {
        if (b == dae::ground) return;
        const Motion& body = x.body[b];
        const Vec3 omega = body.A * body.omega_bar;
        sum += F.dot(body.rdot + omega.cross(C - body.r)) + T.dot(omega);
    };
    of(f.i, w.F, w.T_i);
    of(f.j, -w.F, w.T_j);
    return sum;
}

}  // namespace

TEST_CASE("the stability limit of a sphere in a bowl is that of one damped spring",
          "[contact][evolving][friction]")
{
    const Released b(0);
    const double q = 1 / m + R * R / I, d = K_D * q, k = K_E * q;
    const double h = (std::sqrt(d * d + 4 * k) - d) / k;
    CHECK(h == Approx(4.638e-3).epsilon(1e-3));
    CHECK(b.model.stable_step(b.x).h == Approx(h).epsilon(1e-9));
    CHECK(b.model.stable_step(b.x).force == 0);

    // rolling resistance adds stiffness and lowers the limit
    CHECK(Released(0.1).model.stable_step(b.x).h < h);
    CHECK(Released(0.3).model.stable_step(b.x).h < Released(0.1).model.stable_step(b.x).h);
    CHECK(Released(0.3).model.stable_step(b.x).h > 2.5e-3);
}

TEST_CASE("friction in the bowl is smooth below the stability limit and oscillates above it (long)",
          "[contact][evolving][friction]")
{
    const Released b(0);
    for (const char* scheme : {"rA-half-1", "rA-half-1-momentum"}) {
        const auto most = [&](double h) {
            double F = 0;
            // the transient of the release has decayed by then, and the ball turns round at 2.3 s
            march(b.model, b.x, scheme, 3, h, [&](const State& x) {
                if (x.t > 1.5) F = std::max(F, b.friction().friction(x).F.norm());
            });
            return F;
        };
        INFO(scheme);
        CHECK(most(4.6e-3) == Approx(1.0065).margin(5e-3));
        CHECK(most(4.7e-3) > 2);  // μ_s N
    }
}

TEST_CASE("the ball in the bowl follows the ODE in one angle (long)", "[contact][evolving][friction][order]")
{
    const Released b(0);
    CHECK((centre_by_ode(3) - Vec3(0, -8.027347665166105e-01, -1.417395761748674e+00)).norm() < 1e-9);
    // the start of the dissertation, of first order, and the half kick, of second order
    for (const auto& [scheme, order, error, t] :
         {std::tuple{"rA-half-1", 1., 2.3e-3, 3.}, {"rA-half-1-momentum", 2., 3e-6, 1.}}) {
        const Vec3 reference = centre_by_ode(t);
        double far[2];
        double* e = far;
        for (const double h : {2.5e-3, 1.25e-3})
            *e++ = (march(b.model, b.x, scheme, t, h).body[0].r - reference).norm();
        INFO(scheme << ' ' << far[0] << ' ' << far[1]);
        CHECK(far[0] < error);
        CHECK(far[0] > 0.1 * error);
        CHECK(std::log2(far[0] / far[1]) == Approx(order).margin(0.05));
    }
}

TEST_CASE("rolling resistance stops the ball at the rest position of the dissertation (long)",
          "[contact][evolving][friction]")
{
    struct Case {
        double eta_r, t_end, rest, stops;
        std::array<double, 3> turns;
        int turned;
    };
    // rest position and turning points of the contact point [m]; all within 1e-3 of the limit of stiff
    // springs
    for (const Case& c :
         {Case{0.1, 9.8, -0.0929, 9.406, {-1.1110, 0.7137, -0.3114}, 3},
          Case{0.2, 5.0, -0.0859, 4.675, {-0.7170}, 1}, Case{0.3, 2.7, -0.3249, 2.309, {}, 0}}) {
        const Released b(c.eta_r);
        for (const char* scheme : {"rA-half-1-momentum", "rA-half-1"}) {
            if (c.turned > 0 && std::string(scheme) == "rA-half-1") continue;  // the long runs once
            std::vector<double> turns;
            double y[2] = {1.5, 1.5}, stopped = 0;
            const State end = march(b.model, b.x, scheme, c.t_end, 2.5e-3, [&](const State& x) {
                const double next = x.alpha[4];
                if ((next - y[1]) * (y[1] - y[0]) < 0 && std::abs(next - 1.5) > 0.1) {
                    turns.push_back(y[1]);
                    if (static_cast<int>(turns.size()) == c.turned + 1) stopped = x.t;
                }
                y[0] = y[1], y[1] = next;
            });
            INFO("eta_r " << c.eta_r << ' ' << scheme << ", turns " << Catch::Detail::stringify(turns));
            CHECK(end.alpha[4] == Approx(c.rest).margin(1e-3));
            CHECK(stopped == Approx(c.stops).margin(0.03));
            CHECK(end.body[0].rdot.norm() < 1e-4);
            REQUIRE(turns.size() >= static_cast<size_t>(c.turned));
            for (int n = 0; n < c.turned; ++n) CHECK(turns[n] == Approx(c.turns[n]).margin(1e-3));
        }
    }
}

TEST_CASE("tracked friction converges to ideal rolling with increasing stiffness (long)",
          "[contact][evolving][friction]")
{
    const double t = 0.25, h = 2.5e-4;
    dae::Model ideal;
    ideal.add({.name = "ball", .m = m, .J_bar = I * Mat3::Identity()});
    ideal.constrain("ball-bowl", std::make_unique<EvolvingContact>(0, sphere(), dae::ground, bowl(),
                                                                   EvolvingContact::Friction::rolling));
    State x;
    x.body.resize(1);
    x.body[0].r = centre_over(1.5);
    dae::start(ideal, x);
    const Vec3 rolls = march(ideal, x, "rA-half-1-momentum", t, h).body[0].r;
    double apart[2];
    double* d = apart;
    for (const double stiff : {1., 10.}) {
        FrictionParameters p = rubber();
        p.K_E = stiff * K_E, p.D_slide = stiff * K_D;
        Bowl b(p);
        b.start();
        REQUIRE(h < b.model.stable_step(b.x).h);
        *d++ = (march(b.model, b.x, "rA-half-1-momentum", t, h).body[0].r - rolls).norm();
    }
    INFO(apart[0] << ' ' << apart[1]);
    CHECK(apart[0] < 2e-4);
    CHECK(apart[0] / apart[1] == Approx(10).epsilon(0.1));

    const auto& rolling = dynamic_cast<const EvolvingContact&>(*ideal.general_constraints()[0]);
    CHECK_THROWS_WITH(EvolvingFriction(ideal, rolling, friction_law("slide-roll-spin").make(rubber())),
                      Catch::StartsWith("contact 'ball-bowl': a contact with ideal rolling"));
}

TEST_CASE("the work of friction on an evolving contact equals the loss of energy",
          "[contact][evolving][friction]")
{
    FrictionParameters p = rubber(0.1);
    p.mu_s = p.mu_k = 0.05;  // sliding, rolling and spinning
    p.eta_psi = 0.05;
    double off[2], lost = 0;
    double* e = off;
    for (const double h : {1e-3, 5e-4}) {
        Bowl b(p);
        b.x.body[0].rdot = {0.3, 0, 0};
        b.x.body[0].omega_bar = lie::Vec3(0, 2, 5);
        b.start();
        const double before = lie::energy(b.model, b.x);
        double work = 0, after = 0, last = power(b.friction(), b.x), most = last;
        march(b.model, b.x, "rA-half-1-momentum", 0.5, h, [&](const State& x) {
            const double now = power(b.friction(), x);
            if (x.t > 0) work += 0.5 * h * (now + last);
            last = now, most = std::max(most, now);
            after = lie::energy(b.model, x);
        });
        lost = before - after;
        *e++ = std::abs(lost + work);
    }
    INFO(off[0] << ' ' << off[1] << " of " << lost);
    CHECK(lost > 0.1);
    CHECK(off[0] < 1e-2 * lost);
    CHECK(off[1] < 0.7 * off[0]);
}

TEST_CASE("two free bodies with friction between them conserve momentum", "[contact][evolving][friction]")
{
    dae::Model model;
    model.gravity.setZero();
    const Vec3 axes(0.3, 0.25, 0.2);
    model.add({.name = "egg", .m = 2, .J_bar = Vec3(0.041, 0.052, 0.061).asDiagonal()});
    model.add({.name = "ball", .m = 0.5, .J_bar = 0.002 * Mat3::Identity()});
    auto contact =
        std::make_unique<EvolvingContact>(0, Shape{std::make_shared<Ellipsoid>(axes)}, 1, sphere(0.1));
    const EvolvingContact& c = *contact;
    model.constrain("egg-ball", std::move(contact));
    FrictionParameters p = rubber(0.05);
    p.eta_psi = 0.05;
    p.K_E = 1e3, p.D_slide = {};
    model.load(std::make_unique<EvolvingFriction>(model, c, friction_law("slide-roll-spin").make(p)));
    model.load(dae::SpringDamper(0, Vec3::Zero(), 1, Vec3::Zero(), 50, 0, 0));
    State x;
    x.body.resize(2);
    x.body[1].r = {0.4, 0, 0};
    x.body[0].omega_bar = {0.5, 1, 2};
    x.body[1].omega_bar = {3, 0, -1};
    dae::start(model, x, {.fix_initial = true});
    REQUIRE(1e-3 < model.stable_step(x).h);
    const auto momentum = [&](const State& s) {
        Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
        for (int b = 0; b < 2; ++b) {
            const Motion& body = s.body[b];
            const Vec3 mv = model.mass().m[b] * body.rdot;
            sum.head<3>() += mv;
            sum.tail<3>() += body.r.cross(mv) + body.A * (model.mass().J_bar[b] * body.omega_bar);
        }
        return sum;
    };
    const Eigen::Matrix<double, 6, 1> before = momentum(x);
    const auto& friction = dynamic_cast<const EvolvingFriction&>(*model.forces()[0]);
    double off = 0, most = 0;
    const State end = march(model, x, "rA-half-1-momentum", 0.5, 1e-3, [&](const State& s) {
        most = std::max(most, friction.friction(s).F.norm());
        const Vec3 P = momentum(s).head<3>() - before.head<3>();
        off = std::max(off, P.norm());
    });
    CHECK(most > 0.1);
    CHECK(off < 1e-12);
    CHECK((end.body[1].A * end.body[1].omega_bar - x.body[1].omega_bar).norm() > 0.5);
    // resultant force and torque of friction about the origin, on both bodies together
    lie::Loads out(2);
    friction.add(end, out);
    CHECK((out.F[0] + out.F[1]).norm() < 1e-14);
    Vec3 about = Vec3::Zero();
    for (int b = 0; b < 2; ++b) about += end.body[b].r.cross(out.F[b]) + end.body[b].A * out.n_bar[b];
    CHECK(out.F[0].norm() + about.norm() > 0);
    CHECK(about.norm() < 1e-13);
}

TEST_CASE("friction does not depend on the order of the bodies or on the global axes",
          "[contact][evolving][friction]")
{
    const Mat3 turned = lie::exp(Vec3(0.4, -1.1, 0.7));
    FrictionParameters p = rubber(0.1);
    p.mu_s = p.mu_k = 0.05, p.eta_psi = 0.02;
    std::vector<State> end;
    for (const auto& [swapped, axes] :
         {std::pair{false, Mat3(Mat3::Identity())}, {true, Mat3(Mat3::Identity())}, {false, turned}}) {
        Bowl b(p, swapped, axes);
        b.x.body[0].rdot = axes * Vec3(0.3, 0, 0);
        b.x.body[0].omega_bar = axes * Vec3(0, 2, 5);
        b.start();
        end.push_back(march(b.model, b.x, "rA-half-1-momentum", 0.5, 2e-3));
    }
    CHECK((end[1].body[0].r - end[0].body[0].r).norm() < 1e-9);
    CHECK((end[1].body[0].A - end[0].body[0].A).norm() < 1e-9);
    CHECK((end[2].body[0].r - turned * end[0].body[0].r).norm() < 1e-9);
    CHECK((end[2].body[0].A * turned - turned * end[0].body[0].A).norm() < 1e-9);
}

namespace {

/// An ellipsoid that slides over a floor. Its centre of mass is not on the contact normal, so friction
/// changes F_N.
struct Egg {
    static constexpr double mass = 2;
    const Vec3 axes = Vec3(0.3, 0.25, 0.15), J = Vec3(0.034, 0.045, 0.061);
    dae::Model model;
    State x;

    Egg(double v, double mu)
    {
        model.add({.name = "egg", .m = mass, .J_bar = J.asDiagonal()});
        auto contact = std::make_unique<EvolvingContact>(0, Shape{std::make_shared<Ellipsoid>(axes)},
                                                         dae::ground, Shape{std::make_shared<Plane>()});
        const EvolvingContact& c = *contact;
        model.constrain("egg-floor", std::move(contact));
        if (mu > 0)
            model.load(std::make_unique<EvolvingFriction>(
                model, c,
                friction_law("slide-roll-spin")
                    .make({.mu_s = mu, .mu_k = mu, .K_E = 1e4, .D_slide = 1e4, .static_start = false})));
        x.body.resize(1);
        Motion& egg = x.body[0];
        egg.A = lie::exp(Vec3(0, 0.6, 0));
        egg.r.z() = axes.cwiseProduct(egg.A.transpose() * Vec3::UnitZ()).norm();
        egg.rdot.x() = v;
    }
    double F_N()
    {
        dae::start(model, x);
        const auto& c = dynamic_cast<const EvolvingContact&>(*model.general_constraints()[0]);
        return c.multipliers(model.arguments(c, x), x.lambda).F_N;
    }
    /// c_nt / c_nn: compliances of the contact point (acceleration per force); t points against the velocity
    double coupling(double v) const
    {
        const Motion& egg = x.body[0];
        const auto& c = dynamic_cast<const EvolvingContact&>(*model.general_constraints()[0]);
        const Vec3 s = c.contact_point(model.arguments(c, x)).C() - egg.r, n = Vec3::UnitZ(),
                   t = -v * Vec3::UnitX();
        const Mat3 J_inverse = egg.A * J.cwiseInverse().asDiagonal() * egg.A.transpose();
        const auto moves = [&](const Vec3& a, const Vec3& b) {
            return a.dot(b) / mass + s.cross(a).dot(J_inverse * s.cross(b));
        };
        return moves(n, t) / moves(n, n);
    }
};

}  // namespace

TEST_CASE("friction and the normal force are consistent at a start", "[contact][evolving][friction]")
{
    for (const double mu : {0.4, 2.5, 10.})
        for (const double v : {1., -1., 0.}) {
            if (mu > 3 && v > 0) continue;  // with the damper a solution can exist
            Egg smooth(v, 0), rough(v, mu);
            const double N_0 = smooth.F_N(), c = smooth.coupling(v);
            INFO("mu " << mu << ", v " << v << ", mu c_nt/c_nn " << mu * c);
            if (1 + mu * c <= 0) {  // Painlevé paradox: Coulomb's law has no solution
                CHECK_THROWS_WITH(rough.F_N(), Catch::Contains("converge at the start"));
                continue;
            }
            const double N = rough.F_N();
            // the contact point has no normal acceleration: N (c_nn + μ c_nt) = N_0 c_nn
            CHECK(N == Approx(N_0 / (1 + mu * c)).epsilon(1e-11));
            if (v != 0) CHECK(std::abs(N / N_0 - 1) > 0.1);
            const auto& friction = dynamic_cast<const EvolvingFriction&>(*rough.model.forces()[0]);
            CHECK(friction.normal_force(rough.x) == Approx(N).epsilon(1e-12));
            CHECK(friction.friction(rough.x).F.norm() == Approx(std::abs(v) * mu * N).margin(1e-12));
        }
}

TEST_CASE("a contact under tension has no friction", "[contact][evolving][friction]")
{
    // on top of a sphere and too fast to stay there: the bilateral constraint pulls
    dae::Model model;
    model.add({.name = "ball", .m = m, .J_bar = I * Mat3::Identity()});
    auto contact = std::make_unique<EvolvingContact>(0, sphere(), dae::ground, sphere(1));
    const EvolvingContact& c = *contact;
    model.constrain("ball-top", std::move(contact));
    model.load(std::make_unique<EvolvingFriction>(model, c, friction_law("slide-roll-spin").make(rubber())));
    State x;
    x.body.resize(1);
    x.body[0].r.z() = 1 + R;
    x.body[0].rdot.x() = 5;
    dae::start(model, x);
    const auto& friction = dynamic_cast<const EvolvingFriction&>(*model.forces()[0]);
    CHECK(friction.normal_force(x) == Approx(m * (9.81 - 25 / 1.5)).epsilon(1e-9));
    CHECK(friction.friction(x).F.norm() == 0);
    lie::Loads out(1);
    friction.add(x, out);
    CHECK(out.F[0].norm() + out.n_bar[0].norm() == 0);
}

TEST_CASE("a bouncing ball has no friction in flight and ends rolling at five sevenths of its speed",
          "[contact][evolving][friction]")
{
    dae::Model model;
    model.add({.name = "ball", .m = m, .J_bar = I * Mat3::Identity()});
    auto contact = std::make_unique<EvolvingContact>(
        0, sphere(), dae::ground, Shape{std::make_shared<Plane>()}, EvolvingContact::Friction::none,
        EvolvingContact::NormalRows::tangent, Unilateral{.enabled = true, .restitution = 0.5});
    const EvolvingContact& c = *contact;
    model.constrain("ball-floor", std::move(contact));
    model.load(std::make_unique<EvolvingFriction>(model, c, friction_law("slide-roll-spin").make(rubber())));
    const auto& friction = dynamic_cast<const EvolvingFriction&>(*model.forces()[0]);
    State x;
    x.body.resize(1);
    x.body[0].r.z() = R + 0.05;
    x.body[0].rdot.x() = 1;
    dae::start(model, x);
    CHECK(model.stable_step(x).h == Approx(4.638e-3).epsilon(1e-3));
    const auto integrator = make_integrator(model, lie::scheme("rA-half-1-momentum"), {});
    lie::March march(x, *integrator, 2e-3);
    double flown = 0, off = 0;
    for (int n = 0; n < 700; ++n) {
        const State before = march.node();
        march.advance({});
        const State& now = march.node();
        if (!dae::Model::inactive(c, now) || !dae::Model::inactive(c, before)) continue;
        flown += now.t - before.t;
        off =
            std::max(off, friction.friction(now).F.norm() + friction.saved_history(now).deflections.S.norm());
    }
    CHECK(flown > 0.25);  // at least two flights
    CHECK(off == 0);
    const Motion& end = march.node().body[0];
    CHECK(end.rdot.x() == Approx(5. / 7).epsilon(1e-6));
    CHECK(R * end.omega_bar.norm() == Approx(5. / 7).epsilon(1e-6));
}

TEST_CASE("the friction of an evolving contact is a function of the state", "[contact][evolving][friction]")
{
    const Released b(0.1);
    const State x = march(b.model, b.x, "rA-half-1-momentum", 0.2, 2e-3);
    lie::Loads first(1), second(1);
    b.friction().add(x, first);
    State y = x;
    y.t += 1e-3;
    y.body[0].r += 1e-3 * y.body[0].rdot;
    b.model.update_alpha(y);
    second.set_zero();
    b.friction().add(y, second);
    CHECK((first.F[0] - second.F[0]).norm() > 1e-3);
    second.set_zero();
    b.friction().add(x, second);
    CHECK(first.F[0] == second.F[0]);
    CHECK(first.n_bar[0] == second.n_bar[0]);

    // a step that fails does not change the state
    State z = x;
    const auto failing =
        lie::scheme("rA-half-1-momentum").make(b.model, {.tolerance = 1e-30, .max_iterations = 1});
    CHECK_THROWS_AS(failing->step(z, 0.1), lie::NoConvergence);
    CHECK(z.internal_state == x.internal_state);
    CHECK(z.discrete_state == x.discrete_state);
    CHECK(z.alpha == x.alpha);
}

TEST_CASE("every scheme for evolving contacts converges with tracked friction (long)",
          "[contact][evolving][friction][order]")
{
    const double t = 0.2;
    const Vec3 reference = centre_by_ode(t);
    const Released b(0);
    for (const lie::Scheme& s : lie::schemes()) {
        if (!s.supports.contains(lie::Feature::algebraic) || s.adaptive) continue;
        const double h =
            5e-4;  // the Newton matrix of fully implicit schemes does not contain the stiff friction
        const double far = (march(b.model, b.x, s.name, t, 2 * h).body[0].r - reference).norm(),
                     near = (march(b.model, b.x, s.name, t, h).body[0].r - reference).norm();
        INFO(s.name << ' ' << far << ' ' << near);
        CHECK(near < (s.order == 1 ? 5e-4 : 1e-6));
        CHECK(std::log2(far / near) > 0.8);
    }
}

TEST_CASE("a step with friction on an evolving contact does not allocate",
          "[contact][evolving][friction][allocation]")
{
    if (!tests::counts_allocations) {
        WARN("allocations are not counted under a sanitizer");
        return;
    }
    const Released b(0.1);
    const auto integrator = lie::scheme("rA-half-1-momentum").make(b.model, {});
    lie::March march(b.x, *integrator, 2e-3);
    for (int n = 0; n < 3; ++n) march.advance({});
    CHECK(tests::allocations_during([&] {
              for (int n = 0; n < 50; ++n) march.advance({});
          }) == 0);
}
