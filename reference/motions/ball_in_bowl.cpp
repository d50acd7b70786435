// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/motions/ball_in_bowl.hpp"

#include "lie/check.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace hilda::reference {

namespace {

using Vec2 = Eigen::Vector2d;
using Mat32 = Eigen::Matrix<double, 3, 2>;

// Largest rotation before the charts are reset [rad]. The stereographic chart is singular at π.
constexpr double leg_angle = 0.5;
// Tolerance of the initial state, relative to R and to the speed. It covers decimal input.
constexpr double start_tolerance = 1e-9;

/// Stereographic coordinates: s, ṡ, s̈ without the term s_q q̈, and s_q = ∂s/∂q. The columns of e are e_1,
/// e_2, e_3.
struct Stereographic {
    Vec2 qdot;
    Vec3 s, sdot, sddot_0;
    Mat32 s_q;

    Stereographic(const Mat3& e, const Vec2& q, const Vec2& qdot) : qdot(qdot)
    {
        const double d = 1 + q.squaredNorm(), q_qdot = q.dot(qdot);
        const Vec3 u = 2 / d * (e * Vec3(q.x(), q.y(), 1));
        s = u - e.col(2);
        s_q = 2 / d * (e.leftCols<2>() - u * q.transpose());
        sdot = s_q * qdot;
        sddot_0 = -4 * q_qdot / d * sdot - 2 * qdot.squaredNorm() / d * u;
    }
};

/// Normal of the bowl and derivatives of the centre r in the chart
struct BowlPoint : Stereographic {
    Vec3 n, ndot;
    Mat3 r_s;  // ṙ = r_s ṡ, r̈ = r_s s̈ + rddot_0
    Mat32 r_q;
    Vec3 rddot_0;  // r̈ without the term r_q q̈

    BowlPoint(const BallInBowl& bowl, const Mat3& e, const Vec2& q = Vec2::Zero(),
              const Vec2& qdot = Vec2::Zero())
        : Stereographic(e, q, qdot)
    {
        const Vec3 inverse = bowl.semi_axes.cwiseInverse();
        const Vec3 w = inverse.cwiseProduct(s);
        const double rho = w.norm();
        n = -w / rho;
        const Mat3 n_s = -(Mat3::Identity() - n * n.transpose()) * inverse.asDiagonal() / rho;
        r_s = bowl.R * n_s;
        r_s.diagonal() += bowl.semi_axes;
        r_q = r_s * s_q;
        ndot = n_s * sdot;
        const double rhodot = -n.dot(inverse.cwiseProduct(sdot));
        rddot_0 = r_s * sddot_0 - bowl.R * (2 * rhodot / rho * ndot + ndot.squaredNorm() * n);
    }

    /// x with r_qᵀ r_q x = r_qᵀ v: components of v in the two coordinates
    Vec2 tangent_coordinates(const Vec3& v) const
    {
        return (r_q.transpose() * r_q).llt().solve(r_q.transpose() * v);
    }
};

/// State of the ball, independent of the chart
struct BallState {
    double t = 0;
    Vec3 s = Vec3::Zero(), rdot = Vec3::Zero(), omega = Vec3::Zero();
    Mat3 A = Mat3::Identity();

    Mat3 chart() const  // e_3 = s
    {
        Mat3 e;
        e.col(0) = s.unitOrthogonal();
        e.col(1) = s.cross(e.col(0));
        e.col(2) = s;
        return e;
    }
};

Vec3 gravity(const BallInBowl& bowl) { return {0, 0, -bowl.g}; }

BallState initial_state(const BallInBowl& bowl, const BallInBowl::InitialState& start)
{
    const char* where = "reference::BallInBowl";
    for (const double positive :
         {bowl.semi_axes.x(), bowl.semi_axes.y(), bowl.semi_axes.z(), bowl.R, bowl.m, bowl.J})
        if (!(positive > 0)) lie::reject(where, "lengths, mass and inertia must be positive", positive);
    const double shortest = bowl.semi_axes.minCoeff(),
                 smallest = shortest * shortest / bowl.semi_axes.maxCoeff();
    if (!(bowl.R < smallest))
        lie::reject(where,
                    "the ball must be smaller than the smallest radius of curvature, " +
                        std::to_string(smallest) + " m",
                    bowl.R);
    BallState x;
    x.s = start.p.cwiseQuotient(bowl.semi_axes);
    if (!(std::abs(x.s.norm() - 1) * shortest < start_tolerance * bowl.R))
        lie::reject(where, "the contact point must be on the bowl", start.p.transpose());
    x.s.normalize();
    const Vec3 n = bowl.normal(start.p);
    if (!(std::abs(n.dot(start.rdot)) <= start_tolerance * start.rdot.norm()))
        lie::reject(where,
                    "the initial velocity must be tangent to the bowl; component along the normal [m/s]",
                    n.dot(start.rdot));
    x.rdot = start.rdot - n.dot(start.rdot) * n;
    x.omega = start.spin * n;
    x.A = start.A;
    return x;
}

ContactInstant contact(const BallInBowl& bowl, const BallState& x, const BowlPoint& point, const Vec3& rddot,
                       const Vec3& omegadot)
{
    ContactInstant c;
    c.t = x.t;
    c.n = point.n;
    c.p = bowl.semi_axes.cwiseProduct(x.s);
    c.body.r = c.p + bowl.R * point.n;
    c.body.rdot = x.rdot;
    c.body.rddot = rddot;
    c.body.A = x.A;
    c.body.omega_bar = x.A.transpose() * x.omega;
    c.body.omegadot_bar = x.A.transpose() * omegadot;  // the derivative of Aᵀω, since ω × ω = 0
    c.a_bar = -bowl.R * (x.A.transpose() * point.n);
    const Vec3 F = bowl.m * (rddot - gravity(bowl));
    c.F_N = point.n.dot(F);
    c.F_t = F - c.F_N * point.n;
    return c;
}

/// Sliding without friction: r_qᵀ r̈ = r_qᵀ g
struct SlidingMotion {
    const BallInBowl& bowl;
    Mat3 e = Mat3::Identity();  // the chart, e_3 = s at its reset
    Ode ode;
    Eigen::Vector4d y = Eigen::Vector4d::Zero();  // q, q̇

    SlidingMotion(const BallInBowl& bowl, const OdeTolerance& tolerance)
        : bowl(bowl), ode(
                          4,
                          [this](double, const ConstVectorRef& y, VectorRef ydot) {
                              ydot.head<2>() = y.tail<2>();
                              ydot.tail<2>() = qddot(point_at(y));
                          },
                          tolerance)
    {}

    BowlPoint point_at(const ConstVectorRef& y) const { return {bowl, e, y.head<2>(), y.tail<2>()}; }
    Vec2 qddot(const BowlPoint& point) const
    {
        return point.tangent_coordinates(gravity(bowl) - point.rddot_0);
    }

    void leg(BallState& x, double t_end)
    {
        const double t_0 = x.t;
        e = x.chart();
        y << 0, 0, BowlPoint(bowl, e).tangent_coordinates(x.rdot);
        ode.advance(x.t, y, t_end);
        const BowlPoint point = point_at(y);
        x.s = point.s.normalized();
        x.rdot = point.r_s * point.sdot;
        x.A = lie::orthonormalised(lie::exp((x.t - t_0) * x.omega) * x.A);
    }

    ContactInstant instant(const BallState& x)
    {
        e = x.chart();
        y << 0, 0, BowlPoint(bowl, e).tangent_coordinates(x.rdot);
        const BowlPoint point = point_at(y);
        return contact(bowl, x, point, point.r_q * qddot(point) + point.rddot_0, Vec3::Zero());
    }
};

/// Rolling without slip: ṙ = R ω × n
struct RollingMotion {
    const BallInBowl& bowl;
    Mat3 e = Mat3::Identity();
    Ode ode;
    Eigen::Matrix<double, 8, 1> y = Eigen::Matrix<double, 8, 1>::Zero();  // q, ω, θ with A = exp(θ̃) A_0

    RollingMotion(const BallInBowl& bowl, const OdeTolerance& tolerance)
        : bowl(bowl), ode(
                          8,
                          [this](double, const ConstVectorRef& y, VectorRef ydot) {
                              const Vec3 omega = y.segment<3>(2), theta = y.tail<3>();
                              const BowlPoint point = point_at(y.head<2>(), omega);
                              ydot.head<2>() = point.qdot;
                              ydot.segment<3>(2) = omegadot(point, omega);
                              ydot.tail<3>() = lie::right_jacobian_inverse(-theta) * omega;
                          },
                          tolerance)
    {}

    BowlPoint point_at(const Vec2& q, const Vec3& omega) const
    {
        const BowlPoint at_rest(bowl, e, q);
        return {bowl, e, q, at_rest.tangent_coordinates(bowl.R * omega.cross(at_rest.n))};
    }
    Vec3 omegadot(const BowlPoint& point, const Vec3& omega) const
    {
        const double mR = bowl.m * bowl.R;
        return (mR * point.n.cross(gravity(bowl)) + mR * bowl.R * point.n.dot(omega) * point.ndot) /
               (bowl.J + mR * bowl.R);
    }

    void leg(BallState& x, double t_end)
    {
        e = x.chart();
        y << 0, 0, x.omega, 0, 0, 0;
        ode.advance(x.t, y, t_end);
        x.omega = y.segment<3>(2);
        const BowlPoint point = point_at(y.head<2>(), x.omega);
        x.s = point.s.normalized();
        x.rdot = bowl.R * x.omega.cross(point.n);
        x.A = lie::orthonormalised(lie::exp(y.tail<3>()) * x.A);
    }

    ContactInstant instant(const BallState& x)
    {
        e = x.chart();
        const BowlPoint point = point_at(Vec2::Zero(), x.omega);
        const Vec3 alpha = omegadot(point, x.omega);
        return contact(bowl, x, point, bowl.R * (alpha.cross(point.n) + x.omega.cross(point.ndot)), alpha);
    }
};

template <class MotionLaw>
std::vector<ContactInstant> at(MotionLaw& law, BallState x, const std::vector<double>& instants)
{
    const double shortest = law.bowl.semi_axes.minCoeff(), swing_rate = std::sqrt(law.bowl.g / shortest);
    std::vector<ContactInstant> run;
    for (const double instant : instants) {
        if (!(instant >= x.t))
            lie::reject("reference::BallInBowl", "the instants must ascend and must not be negative",
                        instant);
        while (x.t < instant) {
            const double rate = x.rdot.norm() / (shortest - law.bowl.R) + x.omega.norm() + swing_rate;
            law.leg(x, std::min(instant, x.t + leg_angle / rate));
        }
        run.push_back(law.instant(x));
    }
    return run;
}

}  // namespace

Vec3 BallInBowl::point(double x, double y) const
{
    const double zeta_squared =
        1 - x * x / (semi_axes.x() * semi_axes.x()) - y * y / (semi_axes.y() * semi_axes.y());
    if (!(zeta_squared >= 0))
        lie::reject("reference::BallInBowl", "there is no point of the bowl at this (x, y) [m]",
                    Eigen::RowVector2d(x, y));
    return {x, y, -semi_axes.z() * std::sqrt(zeta_squared)};
}

Vec3 BallInBowl::normal(const Vec3& p) const { return -p.cwiseQuotient(semi_axes.cwiseAbs2()).normalized(); }

double BallInBowl::energy(const Motion& ball) const
{
    return m * (0.5 * ball.rdot.squaredNorm() + g * ball.r.z()) + 0.5 * J * ball.omega_bar.squaredNorm();
}

std::vector<ContactInstant> BallInBowl::slide(const InitialState& start, const std::vector<double>& instants,
                                              const OdeTolerance& tolerance) const
{
    SlidingMotion law(*this, tolerance);
    return at(law, initial_state(*this, start), instants);
}

std::vector<ContactInstant> BallInBowl::roll(const InitialState& start, const std::vector<double>& instants,
                                             const OdeTolerance& tolerance) const
{
    RollingMotion law(*this, tolerance);
    BallState x = initial_state(*this, start);
    const Vec3 n = normal(start.p);
    x.omega += n.cross(x.rdot) / R;
    return at(law, x, instants);
}

}  // namespace hilda::reference
