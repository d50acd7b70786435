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

// A leg is at most about this long [rad]; the charts reach to π.
constexpr double leg_angle = 0.5;
// Of a start, relative to R and to the speed: input is written with so many decimals.
constexpr double off_the_bowl = 1e-9;

/// s, its derivatives along q(t) without the part of q̈, and s_q
struct Stereographic {
    Vec2 qdot;
    Vec3 s, sdot, sddot_0;
    Mat32 s_q;

    Stereographic(const Mat3& e, const Vec2& q, const Vec2& qdot) : qdot(qdot)
    {
        const double d = 1 + q.squaredNorm(), along = q.dot(qdot);
        const Vec3 u = 2 / d * (e * Vec3(q.x(), q.y(), 1));
        s = u - e.col(2);
        s_q = 2 / d * (e.leftCols<2>() - u * q.transpose());
        sdot = s_q * qdot;
        sddot_0 = -4 * along / d * sdot - 2 * qdot.squaredNorm() / d * u;
    }
};

/// The bowl and the path of the centre over a chart
struct Place : Stereographic {
    Vec3 n, ndot;
    Mat3 r_s;  // ṙ = r_s ṡ, r̈ = r_s s̈ + rddot_0
    Mat32 r_q;
    Vec3 rddot_0;  // of r̈, what does not hang on q̈

    Place(const BallInBowl& bowl, const Mat3& e, const Vec2& q = Vec2::Zero(),
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

    /// The x with r_qᵀ r_q x = r_qᵀ v: what v is along the two coordinates
    Vec2 along(const Vec3& v) const { return (r_q.transpose() * r_q).llt().solve(r_q.transpose() * v); }
};

/// What a leg starts from: all of the motion, without a chart
struct Node {
    double t = 0;
    Vec3 s = Vec3::Zero(), rdot = Vec3::Zero(), omega = Vec3::Zero();
    Mat3 A = Mat3::Identity();

    Mat3 chart() const  // s last
    {
        Mat3 e;
        e.col(0) = s.unitOrthogonal();
        e.col(1) = s.cross(e.col(0));
        e.col(2) = s;
        return e;
    }
};

Vec3 gravity(const BallInBowl& bowl) { return {0, 0, -bowl.g}; }

Node ready(const BallInBowl& bowl, const BallInBowl::InitialState& start)
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
    Node x;
    x.s = start.p.cwiseQuotient(bowl.semi_axes);
    if (!(std::abs(x.s.norm() - 1) * shortest < off_the_bowl * bowl.R))
        lie::reject(where, "the contact point must be on the bowl", start.p.transpose());
    x.s.normalize();
    const Vec3 n = bowl.normal(start.p);
    if (!(std::abs(n.dot(start.rdot)) <= off_the_bowl * start.rdot.norm()))
        lie::reject(where, "the ball must start along the bowl: its velocity has a part along the normal",
                    n.dot(start.rdot));
    x.rdot = start.rdot - n.dot(start.rdot) * n;
    x.omega = start.spin * n;
    x.A = start.A;
    return x;
}

ContactInstant contact(const BallInBowl& bowl, const Node& x, const Place& here, const Vec3& rddot,
                       const Vec3& omegadot)
{
    ContactInstant c;
    c.t = x.t;
    c.n = here.n;
    c.p = bowl.semi_axes.cwiseProduct(x.s);
    c.body.r = c.p + bowl.R * here.n;
    c.body.rdot = x.rdot;
    c.body.rddot = rddot;
    c.body.A = x.A;
    c.body.omega_bar = x.A.transpose() * x.omega;
    c.body.omegadot_bar = x.A.transpose() * omegadot;  // the derivative of Aᵀω, since ω × ω = 0
    c.a_bar = -bowl.R * (x.A.transpose() * here.n);
    const Vec3 F = bowl.m * (rddot - gravity(bowl));
    c.F_N = here.n.dot(F);
    c.F_t = F - c.F_N * here.n;
    return c;
}

/// Without friction: r_qᵀ r̈ = r_qᵀ g
struct Sliding {
    const BallInBowl& bowl;
    Mat3 e = Mat3::Identity();  // the chart of this leg
    Ode ode;
    Eigen::Vector4d y = Eigen::Vector4d::Zero();  // q, q̇

    Sliding(const BallInBowl& bowl, const OdeTolerance& tolerance)
        : bowl(bowl), ode(
                          4,
                          [this](double, const ConstVectorRef& y, VectorRef ydot) {
                              ydot.head<2>() = y.tail<2>();
                              ydot.tail<2>() = qddot(place(y));
                          },
                          tolerance)
    {}

    Place place(const ConstVectorRef& y) const { return {bowl, e, y.head<2>(), y.tail<2>()}; }
    Vec2 qddot(const Place& here) const { return here.along(gravity(bowl) - here.rddot_0); }

    void leg(Node& x, double t_end)
    {
        const double t_0 = x.t;
        e = x.chart();
        y << 0, 0, Place(bowl, e).along(x.rdot);
        ode.advance(x.t, y, t_end);
        const Place here = place(y);
        x.s = here.s.normalized();
        x.rdot = here.r_s * here.sdot;
        x.A = lie::orthonormalised(lie::exp((x.t - t_0) * x.omega) * x.A);
    }

    ContactInstant instant(const Node& x)
    {
        e = x.chart();
        y << 0, 0, Place(bowl, e).along(x.rdot);
        const Place here = place(y);
        return contact(bowl, x, here, here.r_q * qddot(here) + here.rddot_0, Vec3::Zero());
    }
};

/// Without slip: ṙ = R ω × n
struct Rolling {
    const BallInBowl& bowl;
    Mat3 e = Mat3::Identity();
    Ode ode;
    Eigen::Matrix<double, 8, 1> y = Eigen::Matrix<double, 8, 1>::Zero();  // q, ω, θ with A = exp(θ̃) A_0

    Rolling(const BallInBowl& bowl, const OdeTolerance& tolerance)
        : bowl(bowl), ode(
                          8,
                          [this](double, const ConstVectorRef& y, VectorRef ydot) {
                              const Vec3 omega = y.segment<3>(2), theta = y.tail<3>();
                              const Place here = place(y.head<2>(), omega);
                              ydot.head<2>() = here.qdot;
                              ydot.segment<3>(2) = omegadot(here, omega);
                              ydot.tail<3>() = lie::right_jacobian_inverse(-theta) * omega;
                          },
                          tolerance)
    {}

    Place place(const Vec2& q, const Vec3& omega) const
    {
        const Place still(bowl, e, q);
        return {bowl, e, q, still.along(bowl.R * omega.cross(still.n))};
    }
    Vec3 omegadot(const Place& here, const Vec3& omega) const
    {
        const double mR = bowl.m * bowl.R;
        return (mR * here.n.cross(gravity(bowl)) + mR * bowl.R * here.n.dot(omega) * here.ndot) /
               (bowl.J + mR * bowl.R);
    }

    void leg(Node& x, double t_end)
    {
        e = x.chart();
        y << 0, 0, x.omega, 0, 0, 0;
        ode.advance(x.t, y, t_end);
        x.omega = y.segment<3>(2);
        const Place here = place(y.head<2>(), x.omega);
        x.s = here.s.normalized();
        x.rdot = bowl.R * x.omega.cross(here.n);
        x.A = lie::orthonormalised(lie::exp(y.tail<3>()) * x.A);
    }

    ContactInstant instant(const Node& x)
    {
        e = x.chart();
        const Place here = place(Vec2::Zero(), x.omega);
        const Vec3 omega_2 = omegadot(here, x.omega);
        return contact(bowl, x, here, bowl.R * (omega_2.cross(here.n) + x.omega.cross(here.ndot)), omega_2);
    }
};

template <class Law>
std::vector<ContactInstant> at(Law& law, Node x, const std::vector<double>& instants)
{
    const double shortest = law.bowl.semi_axes.minCoeff(), swing = std::sqrt(law.bowl.g / shortest);
    std::vector<ContactInstant> run;
    for (const double instant : instants) {
        if (!(instant >= x.t))
            lie::reject("reference::BallInBowl", "the instants must ascend from zero", instant);
        while (x.t < instant) {
            const double rate = x.rdot.norm() / (shortest - law.bowl.R) + x.omega.norm() + swing;
            law.leg(x, std::min(instant, x.t + leg_angle / rate));
        }
        run.push_back(law.instant(x));
    }
    return run;
}

}  // namespace

Vec3 BallInBowl::point(double x, double y) const
{
    const double rest = 1 - x * x / (semi_axes.x() * semi_axes.x()) - y * y / (semi_axes.y() * semi_axes.y());
    if (!(rest >= 0))
        lie::reject("reference::BallInBowl", "there is no bowl below this point", Eigen::RowVector2d(x, y));
    return {x, y, -semi_axes.z() * std::sqrt(rest)};
}

Vec3 BallInBowl::normal(const Vec3& p) const { return -p.cwiseQuotient(semi_axes.cwiseAbs2()).normalized(); }

double BallInBowl::energy(const Motion& ball) const
{
    return m * (0.5 * ball.rdot.squaredNorm() + g * ball.r.z()) + 0.5 * J * ball.omega_bar.squaredNorm();
}

std::vector<ContactInstant> BallInBowl::slide(const InitialState& start, const std::vector<double>& instants,
                                              const OdeTolerance& tolerance) const
{
    Sliding law(*this, tolerance);
    return at(law, ready(*this, start), instants);
}

std::vector<ContactInstant> BallInBowl::roll(const InitialState& start, const std::vector<double>& instants,
                                             const OdeTolerance& tolerance) const
{
    Rolling law(*this, tolerance);
    Node x = ready(*this, start);
    const Vec3 n = normal(start.p);
    x.omega += n.cross(x.rdot) / R;
    return at(law, x, instants);
}

}  // namespace hilda::reference
