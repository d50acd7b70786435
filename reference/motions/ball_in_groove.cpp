// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/motions/ball_in_groove.hpp"

#include "lie/check.hpp"

#include <cmath>

namespace hilda::reference {

namespace {

enum Unknown { beta, betadot, phi, phidot, unknowns };

void check(const BallInGroove& groove)
{
    for (const double positive : {groove.R, groove.m, groove.J})
        if (!(positive > 0))
            lie::reject("reference::BallInGroove", "radius, mass and inertia must be positive", positive);
    if (!(groove.R < groove.a && groove.a < groove.R_t))
        lie::reject("reference::BallInGroove",
                    "the ball must fit into the tube and the tube into the ring: R < a < R_t; R, a, R_t [m]",
                    Vec3(groove.R, groove.a, groove.R_t).transpose());
}

void rates(const BallInGroove& groove, const ConstVectorRef& y, VectorRef& ydot)
{
    const double q = groove.a - groove.R, P = groove.R_t + q * std::sin(y[beta]);
    ydot[beta] = y[betadot];
    ydot[betadot] = (P * y[phidot] * y[phidot] * std::cos(y[beta]) - groove.g * std::sin(y[beta])) / q;
    ydot[phi] = y[phidot];
    ydot[phidot] = -2 * q * y[betadot] * y[phidot] * std::cos(y[beta]) / P;
}

ContactInstant instant(const BallInGroove& groove, const Vec3& omega, double t, const ConstVectorRef& y)
{
    const double q = groove.a - groove.R, s = std::sin(y[beta]), c = std::cos(y[beta]),
                 P = groove.R_t + q * s;
    const Vec3 e_r(std::cos(y[phi]), std::sin(y[phi]), 0), e_phi = Vec3::UnitZ().cross(e_r);
    const Vec3 e_beta = c * e_r + s * Vec3::UnitZ();
    ContactInstant x;
    x.t = t;
    x.n = c * Vec3::UnitZ() - s * e_r;
    x.F_N = groove.m * (q * y[betadot] * y[betadot] + P * y[phidot] * y[phidot] * s + groove.g * c);
    x.body.r = groove.R_t * e_r - q * x.n;
    x.p = groove.R_t * e_r - groove.a * x.n;
    x.body.rdot = P * y[phidot] * e_phi + q * y[betadot] * e_beta;
    x.body.rddot = x.F_N / groove.m * x.n - groove.g * Vec3::UnitZ();
    x.body.A = lie::exp(t * omega);
    x.body.omega_bar = omega;  // Aᵀω = ω, because A is a rotation about ω
    x.a_bar = -groove.R * (x.body.A.transpose() * x.n);
    return x;
}

}  // namespace

double BallInGroove::steady_rate(double beta) const
{
    check(*this);
    if (!(beta >= 0 && beta < std::acos(0.0)))
        lie::reject("reference::BallInGroove", "a steady orbit requires 0 <= beta < pi/2", beta);
    return std::sqrt(g * std::tan(beta) / (R_t + (a - R) * std::sin(beta)));
}

std::vector<ContactInstant> BallInGroove::slide(const InitialState& start,
                                                const std::vector<double>& instants,
                                                const OdeTolerance& tolerance) const
{
    check(*this);
    Ode ode(
        unknowns, [this](double, const ConstVectorRef& y, VectorRef ydot) { rates(*this, y, ydot); },
        tolerance);
    Eigen::VectorXd y = Eigen::VectorXd::Zero(unknowns);
    y[beta] = start.beta, y[betadot] = start.betadot, y[phidot] = start.phidot;
    std::vector<ContactInstant> run;
    double t = 0;
    for (const double t_k : instants) {
        ode.advance(t, y, t_k);
        run.push_back(instant(*this, start.omega, t, y));
    }
    return run;
}

}  // namespace hilda::reference
