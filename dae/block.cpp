// SPDX-License-Identifier: GPL-3.0-or-later
/// Default variations of a block by central differences.
#include "dae/block.hpp"

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

template <class F>
auto central_difference(F f, const Motion& bi, const Motion& bj, int c)
{
    Motion plus_i = bi, plus_j = bj, minus_i = bi, minus_j = bj;
    displace(plus_i, plus_j, c, h);
    displace(minus_i, minus_j, c, -h);
    return ((f(plus_i, plus_j) - f(minus_i, minus_j)) / (2 * h));
}

}  // namespace

Mat12 Block::second_variation(const Motion& bi, const Motion& bj, double t) const
{
    using Vec12 = Eigen::Matrix<double, 12, 1>;
    const auto stacked = [&](const Motion& a, const Motion& b) {
        const Variation v = variation(a, b, t);
        Vec12 all;
        all << v.r_i, v.pi_i, v.r_j, v.pi_j;
        return all;
    };
    Mat12 out;
    for (int c = 0; c < 12; ++c) {
        Motion plus_i = bi, plus_j = bj, minus_i = bi, minus_j = bj;
        displace(plus_i, plus_j, c, h);
        displace(minus_i, minus_j, c, -h);
        out.col(c) = (stacked(plus_i, plus_j) - stacked(minus_i, minus_j)) / (2 * h);
    }
    return out;
}

Variation Block::nu_variation(const Motion& bi, const Motion& bj, double t) const
{
    const auto f = [&](const Motion& a, const Motion& b) { return nu(a, b, t); };
    Variation out;
    Vec3* const part[] = {&out.r_i, &out.pi_i, &out.r_j, &out.pi_j};
    for (int c = 0; c < 12; ++c) (*part[c / 3])[c % 3] = central_difference(f, bi, bj, c);
    return out;
}

GammaDerivatives Block::gamma_variation(const Motion& bi, const Motion& bj, double t) const
{
    const auto f = [&](const Motion& a, const Motion& b) { return gamma(a, b, t); };
    GammaDerivatives out;
    Vec3* const part[] = {&out.i.r,    &out.i.theta, &out.j.r,    &out.j.theta,
                          &out.i.rdot, &out.i.omega, &out.j.rdot, &out.j.omega};
    for (int c = 0; c < 24; ++c) (*part[c / 3])[c % 3] = central_difference(f, bi, bj, c);
    return out;
}

}  // namespace hilda::dae
