// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/motions/ball_in_cylinder.hpp"

#include "lie/check.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::reference {

namespace {

// Largest rotation before the rotation vector is reset [rad]. The chart exp(θ̃) is regular below 2π.
constexpr double cylinder_leg_angle = 0.5;

void check(const BallInCylinder& c)
{
    for (const double positive : {c.rho, c.R, c.m, c.J})
        if (!(positive > 0))
            lie::reject("reference::BallInCylinder", "lengths, mass and inertia must be positive", positive);
    if (!(c.R < c.rho))
        lie::reject("reference::BallInCylinder",
                    "the ball must fit into the cylinder: R must be smaller than rho", c.R);
    if (c.Omega == 0) lie::reject("reference::BallInCylinder", "Omega must not be zero", c.Omega);
}

Vec3 e_r(const BallInCylinder& c, double t) { return {std::cos(c.Omega * t), std::sin(c.Omega * t), 0}; }

/// State at t for the height z with its derivatives, and the attitude with ω and ω̇ (global)
ContactInstant instant(const BallInCylinder& c, double t, double z, double zdot, double zddot, const Mat3& A,
                       const Vec3& omega, const Vec3& omegadot)
{
    const double d = c.rho - c.R;
    const Vec3 radial = e_r(c, t), tangential = Vec3::UnitZ().cross(radial);
    ContactInstant x;
    x.t = t;
    x.n = -radial;
    x.p = c.rho * radial + z * Vec3::UnitZ();
    x.body.r = d * radial + z * Vec3::UnitZ();
    x.body.rdot = d * c.Omega * tangential + zdot * Vec3::UnitZ();
    x.body.rddot = -d * c.Omega * c.Omega * radial + zddot * Vec3::UnitZ();
    x.body.A = A;
    x.body.omega_bar = A.transpose() * omega;
    x.body.omegadot_bar = A.transpose() * omegadot;
    x.a_bar = A.transpose() * (c.R * radial);
    x.F_N = c.m * c.Omega * c.Omega * d;
    x.F_t = c.m * (zddot + c.g) * Vec3::UnitZ();
    return x;
}

/// Closed form of rolling: z with its derivatives, ω and ω̇ in the global frame
struct RollingState {
    double z, zdot, zddot;
    Vec3 omega, omegadot;

    RollingState(const BallInCylinder& c, double t)
    {
        const double nu = c.nu(), z_eq = c.z_eq(), s = std::sin(nu * t), half = std::sin(nu * t / 2);
        z = c.zdot / nu * s + z_eq * 2 * half * half;
        zdot = c.zdot * std::cos(nu * t) + z_eq * nu * s;
        zddot = -c.zdot * nu * s + z_eq * nu * nu * std::cos(nu * t);
        const Vec3 radial = e_r(c, t), tangential = Vec3::UnitZ().cross(radial);
        const double omega_r = -c.spin + c.Omega * z / c.R, omega_theta = zdot / c.R;
        omega = omega_r * radial + omega_theta * tangential - (c.rho - c.R) * c.Omega / c.R * Vec3::UnitZ();
        // The component along e_r is zero: ω̇_r - Ω ω_θ = 0.
        omegadot = (zddot / c.R + c.Omega * omega_r) * tangential;
    }
};

}  // namespace

double BallInCylinder::nu() const { return std::abs(Omega) * std::sqrt(J / (J + m * R * R)); }

double BallInCylinder::z_eq() const
{
    const double beta = m * R * R / (J + m * R * R);
    return -beta * g / (nu() * nu()) + R * spin / Omega;
}

std::vector<ContactInstant> BallInCylinder::slide(const std::vector<double>& instants) const
{
    check(*this);
    const Vec3 omega = -spin * Vec3::UnitX();
    std::vector<ContactInstant> run;
    run.reserve(instants.size());
    for (const double t : instants)
        run.push_back(instant(*this, t, t * (zdot - g * t / 2), zdot - g * t, -g, lie::exp(t * omega), omega,
                              Vec3::Zero()));
    return run;
}

std::vector<ContactInstant> BallInCylinder::roll(const std::vector<double>& instants,
                                                 const OdeTolerance& tolerance) const
{
    check(*this);
    Ode ode(
        3,
        [this](double t, const ConstVectorRef& theta, VectorRef thetadot) {  // A = exp(θ̃) A_0
            thetadot = lie::right_jacobian_inverse(-theta) * RollingState(*this, t).omega;
        },
        tolerance);
    Mat3 A = Mat3::Identity();
    double t = 0;
    std::vector<ContactInstant> run;
    for (const double t_k : instants) {
        if (!(t_k >= t))
            lie::reject("reference::BallInCylinder", "the instants must ascend and must not be negative",
                        t_k);
        while (t < t_k) {
            Eigen::VectorXd theta = Eigen::VectorXd::Zero(3);
            const double rate = RollingState(*this, t).omega.norm() + std::abs(Omega);
            ode.advance(t, theta, std::min(t_k, t + cylinder_leg_angle / rate));
            A = lie::orthonormalised(lie::exp(theta) * A);
        }
        const RollingState x(*this, t);
        run.push_back(instant(*this, t, x.z, x.zdot, x.zddot, A, x.omega, x.omegadot));
    }
    return run;
}

}  // namespace hilda::reference
