// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/motions/ellipsoid_on_plane.hpp"

#include "lie/check.hpp"
#include "reference/motions/swing_period.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace hilda::reference {

namespace {

// Largest rotation before the rotation vector is reset [rad]. The chart exp(θ̃) is regular below 2π.
constexpr double ellipsoid_leg_angle = 1;

/// Contact point and height of the centre with their rates: ē, ē̇, ρ, ā, ā̇
struct PlaneContact {
    Vec3 e_bar, edot_bar;
    double rho;
    Vec3 a_bar, adot_bar;

    PlaneContact(const EllipsoidOnPlane& body, const Mat3& A, const Vec3& omega_bar)
        : e_bar(A.row(2)), edot_bar(e_bar.cross(omega_bar))
    {
        const Vec3 squared = body.semi_axes.cwiseAbs2();
        rho = std::sqrt(e_bar.dot(squared.cwiseProduct(e_bar)));
        a_bar = -squared.cwiseProduct(e_bar) / rho;
        const double rhodot = -a_bar.dot(edot_bar);
        adot_bar = -(squared.cwiseProduct(edot_bar) + rhodot * a_bar) / rho;
    }
};

/// Accelerations as functions of A and ω̄
struct Acceleration {
    Vec3 rddot, omegadot_bar;
};

Acceleration sliding(const EllipsoidOnPlane& body, const Mat3& A, const Vec3& omega_bar)
{
    const PlaneContact point(body, A, omega_bar);
    const Vec3 b = point.a_bar.cross(point.e_bar);
    const double known =
        -point.adot_bar.dot(point.edot_bar) - point.a_bar.dot(point.edot_bar.cross(omega_bar));
    const Mat3 inertia = body.J_bar + body.m * b * b.transpose();
    const Vec3 moment = -omega_bar.cross(body.J_bar * omega_bar) + body.m * (body.g + known) * b;
    const Vec3 omegadot_bar = inertia.llt().solve(moment);
    return {(known - b.dot(omegadot_bar)) * Vec3::UnitZ(), omegadot_bar};
}

Acceleration rolling(const EllipsoidOnPlane& body, const Mat3& A, const Vec3& omega_bar)
{
    const PlaneContact point(body, A, omega_bar);
    const Vec3& a = point.a_bar;
    const Vec3 known = omega_bar.cross(a.cross(omega_bar)) + point.adot_bar.cross(omega_bar);
    const Mat3 inertia = body.J_bar - body.m * lie::tilde(a) * lie::tilde(a);
    const Vec3 moment =
        -omega_bar.cross(body.J_bar * omega_bar) + body.m * a.cross(known + body.g * point.e_bar);
    const Vec3 omegadot_bar = inertia.llt().solve(moment);
    return {A * (known + a.cross(omegadot_bar)), omegadot_bar};
}

using AccelerationLaw = Acceleration (*)(const EllipsoidOnPlane&, const Mat3& A, const Vec3& omega_bar);

class EllipsoidMotion {
public:
    /// Unknowns: x, y of the centre, θ of the attitude, ω̄
    EllipsoidMotion(const EllipsoidOnPlane& body, const EllipsoidOnPlane::InitialState& start,
                    bool is_rolling, const OdeTolerance& tolerance)
        : body(body), law(is_rolling ? rolling : sliding), is_rolling(is_rolling),
          v_0(start.xdot, start.ydot, 0),
          ode(
              8,
              [this](double, const ConstVectorRef& y, VectorRef ydot) {
                  const Vec3 theta = y.segment<3>(2), omega_bar = y.tail<3>();
                  const Mat3 A = A_0 * lie::exp(theta);
                  ydot.head<2>() = velocity(PlaneContact(this->body, A, omega_bar), A, omega_bar).head<2>();
                  ydot.segment<3>(2) = lie::right_jacobian_inverse(theta) * omega_bar;
                  ydot.tail<3>() = law(this->body, A, omega_bar).omegadot_bar;
              },
              tolerance)
    {
        const Vec3& s = body.semi_axes;
        for (const double positive : {s.x(), s.y(), s.z(), body.m})
            if (!(positive > 0))
                lie::reject("reference::EllipsoidOnPlane", "semi-axes and mass must be positive", positive);
        if (body.J_bar.llt().info() != Eigen::Success)
            lie::reject("reference::EllipsoidOnPlane", "the inertia must be positive definite",
                        body.J_bar.diagonal().transpose());
        if (!(lie::orthogonality_error(start.A) < 1e-9 && start.A.determinant() > 0))
            lie::reject("reference::EllipsoidOnPlane",
                        "the attitude must be a rotation matrix; orthogonality error",
                        lie::orthogonality_error(start.A));
        A_0 = lie::orthonormalised(start.A);
        y << start.x, start.y, 0, 0, 0, start.omega_bar;
    }

    std::vector<ContactInstant> at(const std::vector<double>& instants)
    {
        const double swing_rate = std::sqrt(body.g / body.semi_axes.minCoeff());
        std::vector<ContactInstant> run;
        double t = 0;
        for (const double instant : instants) {
            if (!(instant >= t))
                lie::reject("reference::EllipsoidOnPlane",
                            "the instants must ascend and must not be negative", instant);
            while (t < instant) {
                ode.advance(t, y,
                            std::min(instant, t + ellipsoid_leg_angle / (y.tail<3>().norm() + swing_rate)));
                A_0 = lie::orthonormalised(A_0 * lie::exp(y.segment<3>(2)));
                y.segment<3>(2).setZero();
            }
            run.push_back(contact(t));
        }
        return run;
    }

private:
    Vec3 velocity(const PlaneContact& point, const Mat3& A, const Vec3& omega_bar) const
    {
        if (is_rolling) return A * point.a_bar.cross(omega_bar);
        return v_0 - point.a_bar.dot(point.edot_bar) * Vec3::UnitZ();
    }

    ContactInstant contact(double t) const  // requires θ = 0, i.e. A = A_0
    {
        const Vec3 omega_bar = y.tail<3>();
        const PlaneContact point(body, A_0, omega_bar);
        const Acceleration acceleration = law(body, A_0, omega_bar);
        ContactInstant c;
        c.t = t;
        c.body.r = Vec3(y[0], y[1], point.rho);
        c.body.rdot = velocity(point, A_0, omega_bar);
        c.body.rddot = acceleration.rddot;
        c.body.A = A_0;
        c.body.omega_bar = omega_bar;
        c.body.omegadot_bar = acceleration.omegadot_bar;
        c.a_bar = point.a_bar;
        c.p = c.body.r + A_0 * point.a_bar;
        const Vec3 F = body.m * (acceleration.rddot + body.g * Vec3::UnitZ());
        c.F_N = F.z();
        c.F_t = Vec3(F.x(), F.y(), 0);
        return c;
    }

    const EllipsoidOnPlane& body;
    const AccelerationLaw law;
    const bool is_rolling;
    Mat3 A_0 = Mat3::Identity();
    const Vec3 v_0;
    Ode ode;
    Eigen::Matrix<double, 8, 1> y;  // r_x, r_y, θ with A = A_0 exp(θ̃), ω̄
};

double period(const EllipsoidOnPlane& body, double theta_0, bool is_rolling)
{
    const double b = body.semi_axes.y(), c = body.semi_axes.z();
    if (!(b > c)) lie::reject("reference::EllipsoidOnPlane", "for rocking b must exceed c", b);
    if (!(0 < theta_0 && theta_0 < std::acos(0.0)))
        lie::reject("reference::EllipsoidOnPlane",
                    "the initial angle must be between zero and a quarter turn", theta_0);
    if (body.J_bar(0, 1) != 0 || body.J_bar(0, 2) != 0)
        lie::reject("reference::EllipsoidOnPlane",
                    "for rocking x must be a principal axis; first row of J_bar", body.J_bar.row(0));
    const auto rho = [&](double theta) { return std::hypot(b * std::sin(theta), c * std::cos(theta)); };
    return swing_period(
        theta_0,
        [&](double theta) {
            const double mu = (b * b - c * c) * std::sin(theta) * std::cos(theta) / rho(theta);
            const double arm = is_rolling ? std::hypot(rho(theta), mu) : mu;
            return body.J_bar(0, 0) + body.m * arm * arm;
        },
        [&](double theta, double remaining) {  // ρ² = c² + (b² - c²) sin²θ
            const double squares = (b * b - c * c) * std::sin(remaining) * std::sin(theta_0 + theta);
            return body.m * body.g * squares / (rho(theta_0) + rho(theta));
        });
}

}  // namespace

Mat3 EllipsoidOnPlane::homogeneous(const Vec3& semi_axes, double m)
{
    const Vec3 squared = semi_axes.cwiseAbs2();
    return (m / 5 * (Vec3::Constant(squared.sum()) - squared)).asDiagonal();
}

double EllipsoidOnPlane::energy(const Motion& body) const
{
    return m * (0.5 * body.rdot.squaredNorm() + g * body.r.z()) +
           0.5 * body.omega_bar.dot(J_bar * body.omega_bar);
}

double EllipsoidOnPlane::L_z(const Motion& body) const { return (body.A * (J_bar * body.omega_bar)).z(); }

std::vector<ContactInstant> EllipsoidOnPlane::slide(const InitialState& start,
                                                    const std::vector<double>& instants,
                                                    const OdeTolerance& tolerance) const
{
    return EllipsoidMotion(*this, start, false, tolerance).at(instants);
}

std::vector<ContactInstant> EllipsoidOnPlane::roll(const InitialState& start,
                                                   const std::vector<double>& instants,
                                                   const OdeTolerance& tolerance) const
{
    return EllipsoidMotion(*this, start, true, tolerance).at(instants);
}

double EllipsoidOnPlane::slide_period(double theta_0) const { return period(*this, theta_0, false); }
double EllipsoidOnPlane::roll_period(double theta_0) const { return period(*this, theta_0, true); }

}  // namespace hilda::reference
