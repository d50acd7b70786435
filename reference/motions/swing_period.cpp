// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/motions/swing_period.hpp"

#include "lie/check.hpp"

#include <cmath>

namespace hilda::reference {

namespace {

constexpr double pi = 3.14159265358979323846;

constexpr int max_nodes = 1 << 14;
constexpr double converged = 1e-14;

}  // namespace

double swing_period(double q_0, const std::function<double(double)>& M,
                    const std::function<double(double, double)>& drop)
{
    if (!(q_0 > 0)) lie::reject("reference::swing_period", "the amplitude must be positive", q_0);
    double previous = 0;
    for (int N = 16; N <= max_nodes; N *= 2) {
        double sum = 0;
        for (int k = 0; k < N; ++k) {
            const double chi = (k + 0.5) * pi / (2 * N), half_sine = std::sin((pi / 2 - chi) / 2);
            const double q = q_0 * std::sin(chi), dropped = drop(q, 2 * q_0 * half_sine * half_sine);
            if (!(dropped > 0))
                lie::reject("reference::swing_period",
                            "the potential must be lower than at the amplitude; coordinate", q);
            sum += std::cos(chi) * std::sqrt(M(q) / (2 * dropped));
        }
        const double T = 4 * q_0 * sum * pi / (2 * N);
        if (std::abs(T - previous) < converged * T) return T;
        previous = T;
    }
    throw lie::NumericalFailure(
        "quadrature_failed", "reference::swing_period: the quadrature does not converge for the amplitude " +
                                 std::to_string(q_0) + "; the amplitude must not be an equilibrium");
}

}  // namespace hilda::reference
