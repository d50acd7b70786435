// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/motions/closed_form.hpp"

#include "lie/check.hpp"
#include "reference/solvers/gsl_errors.hpp"

#include <gsl/gsl_sf_elljac.h>
#include <Eigen/Cholesky>

namespace hilda::reference {

namespace {

// Relative tolerance for equal moments of inertia. It covers the rounding of decimal input.
constexpr double same_moment = 1e-12;

/// Constant coefficients of a planar chain (c, S, m, J) and its angular accelerations
class ChainEquations {
public:
    explicit ChainEquations(const PlanarChain& chain)
        : chain(chain), n(static_cast<int>(chain.bar.size())), c(Eigen::MatrixXd::Zero(n, n)), m(n), J(n)
    {
        for (int k = 0; k < n; ++k) {
            const PlanarBar& bar = chain.bar[k];
            if (!(bar.length > 0 && bar.m > 0 && bar.J > 0))
                lie::reject("reference::PlanarChain",
                            "length, mass and inertia of a bar must be positive; index of the bar", k);
            m[k] = bar.m, J[k] = bar.J;
            for (int j = 0; j < k; ++j) c(k, j) = chain.bar[j].length;
            c(k, k) = bar.length / 2;
        }
        S = c.transpose() * m.asDiagonal() * c;
        first_moment = c.transpose() * m;
    }

    Vec3 u(double theta) const
    {
        return std::cos(theta) * chain.e + std::sin(theta) * chain.axis.cross(chain.e);
    }

    Eigen::VectorXd thetaddot(const ConstVectorRef& theta, const ConstVectorRef& thetadot) const
    {
        Eigen::MatrixXd M = J.asDiagonal();
        Eigen::VectorXd Q(n);
        for (int i = 0; i < n; ++i) {
            Q[i] = first_moment[i] * chain.gravity.dot(chain.axis.cross(u(theta[i])));
            for (int j = 0; j < n; ++j) {
                M(i, j) += S(i, j) * std::cos(theta[i] - theta[j]);
                Q[i] -= S(i, j) * std::sin(theta[i] - theta[j]) * thetadot[j] * thetadot[j];
            }
        }
        return M.llt().solve(Q);
    }

    lie::State state(double t, const ConstVectorRef& theta, const ConstVectorRef& thetadot) const
    {
        const Eigen::VectorXd acceleration = thetaddot(theta, thetadot);
        lie::State x;
        x.t = t;
        x.body.resize(n);
        for (int k = 0; k < n; ++k) {
            Motion& body = x.body[k];
            body.r = chain.origin;
            for (int j = 0; j <= k; ++j) {
                const Vec3 u_j = u(theta[j]), n_j = chain.axis.cross(u_j);
                body.r += c(k, j) * u_j;
                body.rdot += c(k, j) * thetadot[j] * n_j;
                body.rddot += c(k, j) * (acceleration[j] * n_j - thetadot[j] * thetadot[j] * u_j);
            }
            body.A << u(theta[k]), chain.axis.cross(u(theta[k])), chain.axis;
            body.omega_bar = Vec3(0, 0, thetadot[k]);
            body.omegadot_bar = Vec3(0, 0, acceleration[k]);
        }
        return x;
    }

private:
    const PlanarChain& chain;
    const int n;
    Eigen::MatrixXd c, S;
    Eigen::VectorXd m, J, first_moment;
};

}  // namespace

lie::Trajectory PlanarChain::at(const std::vector<double>& instants, const OdeTolerance& tolerance) const
{
    const ChainEquations equations(*this);
    const auto n = static_cast<Eigen::Index>(bar.size());
    Ode ode(
        static_cast<int>(2 * n),
        [&](double, const ConstVectorRef& y, VectorRef ydot) {
            ydot.head(n) = y.tail(n);
            ydot.tail(n) = equations.thetaddot(y.head(n), y.tail(n));
        },
        tolerance);

    Eigen::VectorXd y(2 * n);
    for (Eigen::Index k = 0; k < n; ++k) y[k] = bar[k].theta, y[n + k] = bar[k].thetadot;
    lie::Trajectory run;
    double t = t_0;
    for (const double instant : instants) {
        ode.advance(t, y, instant);
        run.row.push_back(equations.state(t, y.head(n), y.tail(n)));
    }
    return run;
}

Motion RegularPrecession::attitude(const Mat3& A_0, double t) const
{
    Motion body;
    body.A = lie::exp(t * a) * A_0 * lie::exp(t * b_bar);
    const Vec3 a_bar = body.A.transpose() * a;
    body.omega_bar = a_bar + b_bar;
    body.omegadot_bar = a_bar.cross(b_bar);
    return body;
}

FreeTop::FreeTop(const Vec3& J_bar, const Motion& start, const Vec3& gravity, double t_0)
    : start(start), gravity(gravity), t_0(t_0)
{
    for (int axis = 0; axis < 3; ++axis) {
        const double J_1 = J_bar[(axis + 1) % 3], J_2 = J_bar[(axis + 2) % 3], J_3 = J_bar[axis];
        if (std::abs(J_1 - J_2) > same_moment * J_1) continue;
        precession.a = start.A * J_bar.cwiseProduct(start.omega_bar) / J_1;
        precession.b_bar = (J_1 - J_3) / J_1 * start.omega_bar[axis] * Vec3::Unit(axis);
        return;
    }
    lie::reject("reference::FreeTop", "two principal moments must be equal; moments [kg m²]",
                J_bar.transpose());
}

Motion FreeTop::at(double t) const
{
    t -= t_0;
    Motion body = precession.attitude(start.A, t);
    body.r = start.r + t * start.rdot + 0.5 * t * t * gravity;
    body.rdot = start.rdot + t * gravity;
    body.rddot = gravity;
    return body;
}

double HeavyTop::omega_bar_3() const
{
    return (m * g * l / Omega + (J_1 + m * l * l) * Omega * std::cos(theta)) / J_3;
}

Motion HeavyTop::at(double t) const
{
    const Vec3 a = Omega * Vec3::UnitZ();
    const double psidot = omega_bar_3() - Omega * std::cos(theta);
    Motion body = RegularPrecession{.a = a, .b_bar = psidot * Vec3::UnitZ()}.attitude(
        lie::exp(theta * Vec3::UnitX()), t);
    body.r = l * body.A.col(2);
    body.rdot = a.cross(body.r);
    body.rddot = a.cross(body.rdot);
    return body;
}

Vec3 asymmetric_top(const Vec3& J_bar, double w_1, double w_3, double t)
{
    const double J_1 = J_bar.x(), J_2 = J_bar.y(), J_3 = J_bar.z();
    if (!(0 < J_1 && J_1 < J_2 && J_2 < J_3))
        lie::reject("reference::asymmetric_top",
                    "the principal moments must be positive and in ascending order", J_bar.transpose());
    if (!(w_1 > 0 && w_3 > 0))
        lie::reject("reference::asymmetric_top", "w_1 and w_3 must be positive",
                    Vec3(w_1, 0, w_3).transpose());
    const double k_squared = w_1 * w_1 * J_1 * (J_2 - J_1) / (w_3 * w_3 * J_3 * (J_3 - J_2));
    if (k_squared > 1)
        lie::reject("reference::asymmetric_top",
                    "the polhode must encircle the axis of J_3: k² at most one; k²", k_squared);
    const double w_2 = w_1 * std::sqrt(J_1 * (J_3 - J_1) / (J_2 * (J_3 - J_2)));
    const double tau = t * w_3 * std::sqrt((J_3 - J_2) * (J_3 - J_1) / (J_1 * J_2));
    double sn = 0, cn = 0, dn = 0;
    disable_gsl_error_handler();
    if (const int code = gsl_sf_elljac_e(tau, k_squared, &sn, &cn, &dn); code != GSL_SUCCESS)
        throw lie::NumericalFailure(
            "gsl_failed", "reference::asymmetric_top: Jacobi's elliptic functions failed at tau = " +
                              std::to_string(tau) + ": " + gsl_strerror(code));
    return {w_1 * cn, w_2 * sn, w_3 * dn};
}

}  // namespace hilda::reference
