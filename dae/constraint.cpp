// SPDX-License-Identifier: GPL-3.0-or-later
/// Defaults of a constraint: variations by central differences.
#include "dae/constraint.hpp"

#include "dae/block.hpp"

#include <algorithm>

namespace hilda::dae {

namespace {

constexpr double h = 6e-6;  // balances the truncation error h² and the rounding error 1e-16/h

/// Adds `by` to component c of (δr_i, δθ_i, δr_j, δθ_j, δṙ_i, δω̄_i, δṙ_j, δω̄_j).
void displace(Motion& bi, Motion& bj, int c, double by)
{
    Motion& body = c % 12 < 6 ? bi : bj;
    const int k = c % 6, axis = k % 3;
    if (c < 12 && k < 3)
        body.r[axis] += by;
    else if (c < 12)
        body.A = body.A * lie::exp(by * Vec3::Unit(axis));
    else
        (k < 3 ? body.rdot : body.omega_bar)[axis] += by;
}

/// Central difference of f(arguments) for component c
template <class F>
auto central_difference(F f, const Constraint::Arguments& x, int c)
{
    const auto displaced = [&](double by) {
        Motion bi = x.bi, bj = x.bj;
        displace(bi, bj, c, by);
        return f(Constraint::Arguments{bi, bj, x.t, x.alpha, x.internal_state, x.mode, x.lambda, x.row,
                                       x.velocity_row});
    };
    using Value = decltype(displaced(h));  // a value, not an expression of Eigen that refers to temporaries
    return Value((displaced(h) - displaced(-h)) / (2 * h));
}

}  // namespace

void Constraint::nu(const Arguments&, double* out) const
{
    std::fill_n(out, position_rows() + velocity_rows(), 0.0);
}

Mat12 Constraint::second_variation(const Arguments& x, int row) const
{
    using Vec12 = Eigen::Matrix<double, 12, 1>;
    Derivatives d;
    d.set_zero(*this);
    Mat12 out;
    for (int c = 0; c < 12; ++c)
        out.col(c) = central_difference(
            [&](const Arguments& y) {
                variation(y, d);
                Vec12 all;
                all << d.C_i.row(row).transpose(), d.C_j.row(row).transpose();
                return all;
            },
            x, c);
    return out;
}

Variation Constraint::nu_variation(const Arguments& x, int row) const
{
    double all[max_rows];
    Variation out;
    Vec3* const part[] = {&out.r_i, &out.pi_i, &out.r_j, &out.pi_j};
    for (int c = 0; c < 12; ++c)
        (*part[c / 3])[c % 3] =
            central_difference([&](const Arguments& y) { return nu(y, all), all[row]; }, x, c);
    return out;
}

GammaDerivatives Constraint::gamma_variation(const Arguments& x, int row) const
{
    double all[max_rows];
    GammaDerivatives out;
    Vec3* const part[] = {&out.i.r,    &out.i.theta, &out.j.r,    &out.j.theta,
                          &out.i.rdot, &out.i.omega, &out.j.rdot, &out.j.omega};
    for (int c = 0; c < 24; ++c)
        (*part[c / 3])[c % 3] =
            central_difference([&](const Arguments& y) { return gamma(y, all), all[row]; }, x, c);
    return out;
}

void Block::variation(const Arguments& x, Derivatives& out) const
{
    const Variation v = variation(x);
    out.C_i << v.r_i.transpose(), v.pi_i.transpose();
    out.C_j << v.r_j.transpose(), v.pi_j.transpose();
}

}  // namespace hilda::dae
