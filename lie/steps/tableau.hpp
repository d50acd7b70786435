// SPDX-License-Identifier: GPL-3.0-or-later
/// Tableaux of explicit Runge-Kutta methods with error estimates and continuous extensions.

#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace hilda::lie {

/// An explicit Runge-Kutta method with a continuous extension, in the form of Hairer, Nørsett, Wanner (1993),
/// Solving Ordinary Differential Equations I, Secs. II.5, II.6 and II.10.
///
///     Y_i = y_n + h Σ a_ij k_j,   k_i = f(t_n + c_i h, Y_i),   y_{n+1} = Y_s
///
/// Row s of a, s = stages(), holds the weights b of the step. k_s is the slope at its end, which is the first
/// slope of the next step. The rows after it are stages that only the continuous extension needs. Rows are as
/// long as their last coefficient that is not zero.
struct Tableau {
    using Coefficients = std::vector<std::vector<double>>;

    std::string name;  ///< of the scheme
    int order = 0;
    std::vector<double> c;
    Coefficients a;
    /// Weights e of h Σ e_i k_i, the estimate of the local error. A second row is that of a lower order; the
    /// two are combined as in DOP853.
    Coefficients error;
    /// Weights of the terms of the continuous extension beyond the cubic Hermite polynomial
    Coefficients dense;

    int all_stages() const { return static_cast<int>(c.size()); }
    int stages() const { return all_stages() - 1 - extra; }
    int extra = 0;  ///< number of stages after the end of the step

    /// Weights b_i(s) of the continuous extension y_n + h Σ b_i(s) k_i at t_n + s h, 0 ≤ s ≤ 1:
    ///
    ///     Σ b_i(s) k_i = s (u_1 + (1-s) (u_2 + s (u_3 + (1-s) (u_4 + s (…)))))
    ///
    /// with u_1 = Σ b_i k_i, u_2 = k_0 - u_1, u_3 = u_1 - k_s - u_2 and u_4, … by the rows of `dense`.
    /// `out` has all_stages() components.
    void interpolation(double s, std::vector<double>& out) const;

    /// Entry (row, column); 0 beyond the end of a row
    static double entry(const std::vector<double>& row, int column)
    {
        return static_cast<std::size_t>(column) < row.size() ? row[static_cast<std::size_t>(column)] : 0;
    }
};

/// Dormand and Prince's method of order 5 with an error estimate of order 4        lie/integrators/dp_5.cpp
const Tableau& dormand_prince_5();
/// Hairer's DOP853 of order 8 with error estimates of orders 5 and 3               lie/integrators/dop853.cpp
const Tableau& dop853();

}  // namespace hilda::lie
