// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/linear_springs.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hilda::lie {

template <int n>
bool LinearSprings<n>::is_stable(double h, double damping_factor) const
{
    if (!K.allFinite() || !D.allFinite() || !W.allFinite()) return false;
    const Vector P = K.binaryExpr(D, [&](double k, double c) {
        const double at = k < 0 ? std::clamp(-damping_factor * c / k, 0., h) : h;
        return std::max(0., 2 * damping_factor * at * c + at * at * k);
    });
    if (P.dot(W.diagonal()) < 4) return true;  // the trace of W P is an upper limit
    if (!P.allFinite()) return false;
    const Vector root = P.cwiseSqrt();
    // has the eigenvalues 4 - λ with those λ of W P: positive definite if all are below 4
    Matrix remainder = -(root.asDiagonal() * W * root.asDiagonal());
    remainder.diagonal().array() += 4;
    return remainder.allFinite() && Eigen::LLT<Matrix>(remainder).info() == Eigen::Success;
}

template <int n>
double LinearSprings<n>::stable_step(double damping_factor) const
{
    double lower = 1e-15, upper = 1e6;  // [s]
    if (is_stable(upper, damping_factor)) return std::numeric_limits<double>::infinity();
    while (upper > lower * (1 + 1e-12)) {
        const double middle = std::sqrt(lower * upper);
        (is_stable(middle, damping_factor) ? lower : upper) = middle;
    }
    return lower;
}

template struct LinearSprings<6>;
template struct LinearSprings<Eigen::Dynamic>;

}  // namespace hilda::lie
