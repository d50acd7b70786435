// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/motions/ball_in_cylinder.hpp"

#include "lie/check.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::reference {

namespace {

// Of one leg of the attitude [rad]; the chart exp(θ̃) reaches to 2π.
constexpr double leg_angle = 0.5;

void check(const BallInCylinder& c)
{
    for (const double positive : {c.rho, c.R, c.m, c.J})
        if (!(positive > 0))
            lie::reject("reference::BallInCylinder", "lengths, mass and inertia must be positive", positive);
    if (!(c.R < c.rho)) lie::reject("reference::BallInCylinder", "the ball must fit into the cylinder", c.R);
    if (c.Omega == 0) lie::reject("reference::BallInCylinder", "the ball must go round", c.Omega);
}

Vec3 e_r(const BallInCylinder& c, double t) { return {std::cos(c.Omega * t), std::sin(c.Omega * t), 0}; }

/// At t with the height z and its derivatives
ContactInstant instant(const BallInCylinder& c, double t, double z, double zdot, double zddot, const Mat3& A,
                       const Vec3& omega, const Vec3& omegadot)
{
    const double d = c.rho - c.R;
    const Vec3 outwards = e_r(c, t), onwards = Vec3::UnitZ().cross(outwards);
    ContactInstant x;
    x.t = t;
    x.n = -outwards;
    x.p = c.rho * outwards + z * Vec3::UnitZ();
    x.body.r = d * outwards + z * Vec3::UnitZ();
    x.body.rdot = d * c.Omega * onwards + zdot * Vec3::UnitZ();
    x.body.rddot = -d * c.Omega * c.Omega * outwards + zddot * Vec3::UnitZ();
    x.body.A = A;
    x.body.omega_bar = A.transpose() * omega;
    x.body.omegadot_bar = A.transpose() * omegadot;
    x.a_bar = A.transpose() * (c.R * outwards);
    x.F_N = c.m * c.Omega * c.Omega * d;
    x.F_t = c.m * (zddot + c.g) * Vec3::UnitZ();
    return x;
}

/// ω and ω̇ in the global frame, and z with its derivatives, of rolling
struct Rolling {
    double z, zdot, zddot;
    Vec3 omega, omegadot;

    Rolling(const BallInCylinder& c, double t)
    {
        const double nu = c.nu(), z_eq = c.z_eq(), s = std::sin(nu * t), half = std::sin(nu * t / 2);
        z = c.zdot / nu * s + z_eq * 2 * half * half;
        zdot = c.zdot * std::cos(nu * t) + z_eq * nu * s;
        zddot = -c.zdot * nu * s + z_eq * nu * nu * std::cos(nu * t);
        const Vec3 outwards = e_r(c, t), onwards = Vec3::UnitZ().cross(outwards);
        const double omega_r = -c.spin + c.Omega * z / c.R, omega_theta = zdot / c.R;
        omega = omega_r * outwards + omega_theta * onwards - (c.rho - c.R) * c.Omega / c.R * Vec3::UnitZ();
        // ω̇_r - Ω ω_θ = 0 is the part along e_r
        omegadot = (zddot / c.R + c.Omega * omega_r) * onwards;
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
            thetadot = lie::right_jacobian_inverse(-theta) * Rolling(*this, t).omega;
        },
        tolerance);
    Mat3 A = Mat3::Identity();
    double t = 0;
    std::vector<ContactInstant> run;
    for (const double t_k : instants) {
        if (!(t_k >= t)) lie::reject("reference::BallInCylinder", "the instants must ascend from zero", t_k);
        while (t < t_k) {
            Eigen::VectorXd theta = Eigen::VectorXd::Zero(3);
            const double rate = Rolling(*this, t).omega.norm() + std::abs(Omega);
            ode.advance(t, theta, std::min(t_k, t + leg_angle / rate));
            A = lie::orthonormalised(lie::exp(theta) * A);
        }
        const Rolling x(*this, t);
        run.push_back(instant(*this, t, x.z, x.zdot, x.zddot, A, x.omega, x.omegadot));
    }
    return run;
}

}  // namespace hilda::reference
