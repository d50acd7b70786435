// SPDX-License-Identifier: GPL-3.0-or-later
/// Derivatives by differences with an estimate of their error.

#pragma once

#include "dae/constraint.hpp"
#include "dae/force.hpp"
#include "lie/check.hpp"

#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

namespace hilda::lie {
struct LoadVariation;
}

namespace hilda::dae {

/// The values of the rows of a constraint
using RowValues = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, Constraint::max_rows, 1>;

/// The first or second derivative of f at 0, by differences of fourth order. The step begins with h and is
/// halved while that reduces the difference of two results, which is the estimate of the error: the motion
/// may be curved within a much smaller length than h.
///
/// Throws lie::NumericalFailure "differences" if the estimate exceeds `most` relative to the derivative.
template <class Function>
RowValues derivative(const Function& f, int order, double h, const std::string& what)
{
    constexpr int halvings = 14;
    constexpr double enough = 1e-11, most = 1e-5, least = 1e-7;
    const RowValues zero = order == 2 ? RowValues(f(0)) : RowValues();
    RowValues far_plus = f(2 * h), far_minus = f(-2 * h), best;
    double error = std::numeric_limits<double>::infinity(), size = 0;
    RowValues before;
    for (int k = 0; k < halvings; ++k, h *= 0.5) {
        const RowValues plus = f(h), minus = f(-h);
        RowValues now =
            order == 1 ? RowValues((8 * (plus - minus) - (far_plus - far_minus)) / (12 * h))
                       : RowValues((16 * (plus + minus) - (far_plus + far_minus) - 30 * zero) / (12 * h * h));
        far_plus = plus, far_minus = minus;
        if (k > 0) {
            const double change = (now - before).template lpNorm<Eigen::Infinity>();
            if (change >= error && error <= most * size + least) break;  // rounding errors
            if (change < error) {
                error = change, best = now;
                size = now.template lpNorm<Eigen::Infinity>();
            }
            if (error <= enough * size) break;
        }
        before = std::move(now);
    }
    if (!(error <= most * size + least)) {
        std::ostringstream text;
        text.precision(2);
        text << what << " by differences has an error of " << error << "; give the function";
        throw lie::NumericalFailure("differences", text.str());
    }
    return best;
}

/// The motion after a time s with constant velocities
inline Motion after(const Motion& from, double s)
{
    Motion to = from;
    to.r += s * from.rdot;
    to.A = from.A * lie::exp(s * from.omega_bar);
    return to;
}

/// The derivatives of the loads of a force by central differences. out.x is x on entry and on return.
void difference_loads(const Force& f, const State& x, lie::LoadVariation& out, Force::LoadDerivatives& d);

}  // namespace hilda::dae
