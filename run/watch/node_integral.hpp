// SPDX-License-Identifier: GPL-3.0-or-later
/// Integrals over the time of a run.

#pragma once

#include <array>

namespace hilda::run {

/// Integral over time of a quantity that is known at equidistant nodes, by the Adams-Moulton formula of
/// fourth order:
///
///     ∫ P dt = h/24 (9 P_n+1 + 19 P_n - 5 P_n-1 + P_n-2)       over [t_n, t_n+1]
///
/// The first three steps together have Simpson's 3/8 rule. After one step and after two steps the value is
/// that of the trapezoidal rule and of Simpson's rule.
class NodeIntegral {
public:
    /// Adds a node. h [s]: the step that ends there, ignored for the first node. A change of h restarts the
    /// formula.
    void add(double value, double h);
    double value() const { return sum; }
    bool is_empty() const { return count == 0; }  ///< no node yet

private:
    std::array<double, 3> last{};  ///< values of the last nodes, the latest first
    long count = 0;                ///< number of nodes since the start of the formula, at most 4
    double step = 0, sum = 0;
    double before = 0;  ///< the integral up to the start of the formula
};

}  // namespace hilda::run
