// SPDX-License-Identifier: GPL-3.0-or-later
/// The choice of the step size from error estimates.

#pragma once

#include "lie/settings.hpp"
#include "lie/state.hpp"

#include <string>

namespace hilda::lie {

constexpr double largest_internal_turn = 2;  ///< of a body in an internal step [rad]; J_r is singular at 2π
/// The same where revolutions are counted: two bodies turn relative to each other by less than 3/8 of a turn.
constexpr double largest_counted_turn = 1;

/// Whether internal steps make progress: a number of them has to cover a fraction of the distance h of two
/// nodes.
class Progress {
public:
    static constexpr long interval = 1000;
    static constexpr double least = 1e-6;

    Progress(double t, double h) : checked(t), h(h) {}
    /// To be called after each internal step, with the time of its end
    bool has_stalled(double t)
    {
        if (++steps % interval != 0) return false;
        const double covered = t - checked;
        checked = t;
        return covered < least * h;
    }

private:
    double checked, h;
    long steps = 0;
};

/// Of the local error, for adaptive steps
struct Tolerances {
    double rtol, atol;
    /// Those of the settings; without atol it is rtol. Throws InvalidInput if one is not in [1e-14, 0.1].
    Tolerances(const Settings& settings, const std::string& scheme);
};

/// A PI controller: Gustafsson (1991), ACM TOMS 17, 533-554; Hairer, Wanner (1996), Solving Ordinary
/// Differential Equations II, Sec. IV.2.
///
///     h_{n+1} = 0.8 h_n err_n^-α err_{n-1}^β,   β = 0.2/q,  α = 1/q - 0.75 β,  h_{n+1}/h_n from 0.2 to 5
///
/// for a method whose error estimate behaves like h^q. err is the estimate divided by the tolerance. A
/// rejected step changes `h` only. The step after it depends on the steps that were accepted, not on those
/// that were rejected.
struct StepControl {
    double h = 0;              ///< length of the next step [s]; 0 before the first one and at a new start
    double last_error = 1e-4;  ///< err of the last accepted step, at least 1e-4

    void accept(double step, double error, int q);
    void reject(double step, double error, int q);
};

/// Sets the tolerance of each component of an error of (r, θ, ṙ, ω̄) for a step between two states:
///
///     atol + rtol max |x|,   |x| the length of r, ṙ or ω̄ of the body; 1 for θ
///
/// A rotation of the global frame does not change the tolerances.
void set_tolerances(const State& from, const State& to, double rtol, double atol, Eigen::VectorXd& out);
/// Root mean square of an error of (r, θ, ṙ, ω̄) over these tolerances
double rms_over(const Eigen::VectorXd& tolerance, const Eigen::VectorXd& error);

/// First step [s] from the sizes of y, ẏ and ÿ, relative to the tolerances. Hairer et al. (1993), Sec. II.4
struct FirstStep {
    double size, rate;  ///< root mean squares of y and ẏ

    /// A step for which explicit Euler changes y by a hundredth of its size
    double euler() const;
    /// The first step, with the root mean square `rate_of_rate` of ÿ
    double of_order(int q, double rate_of_rate) const;
};

}  // namespace hilda::lie
