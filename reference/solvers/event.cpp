// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/solvers/event.hpp"

#include "lie/bracket.hpp"
#include "lie/check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hilda::reference {

namespace {

// Regula falsi needs about eight evaluations. 100 bisections alone would reduce the bracket by 2^100.
constexpr int max_trials = 100;

/// Locates the zero of g between (t_a, y_a) with g_a > 0 and (t, y) with g_b ≤ 0. On return t, y is the right
/// end of the last bracket.
void locate_zero(Ode& ode, double t_a, const Eigen::VectorXd& y_a, double g_a, double& t, VectorRef& y,
                 double g_b, const Event& g)
{
    lie::Bracket bracket(t_a, g_a, t, g_b);
    for (int trial = 0; trial < max_trials && g_b != 0; ++trial) {
        if (bracket.b - bracket.a <=
            4 * std::numeric_limits<double>::epsilon() * std::max(std::abs(bracket.b), bracket.b - t_a))
            return;
        Eigen::VectorXd y_m = y_a;
        double t_m = t_a;
        ode.advance(t_m, y_m, bracket.next());
        const double g_m = g(t_m, y_m);
        if (bracket.add(t_m, g_m)) t = t_m, y = y_m, g_b = g_m;
    }
}

}  // namespace

bool advance_to_event(Ode& ode, double& t, VectorRef y, double t_end, double interval, const Event& g)
{
    if (!(interval > 0))
        lie::reject("reference::advance_to_event",
                    "the interval between evaluations of the event function must be positive", interval);
    double g_a = g(t, y);
    while (t < t_end) {
        const double t_a = t;
        const Eigen::VectorXd y_a = y;
        ode.advance(t, y, std::min(t + interval, t_end));
        const double g_b = g(t, y);
        if (g_a > 0 && !(g_b > 0)) {
            locate_zero(ode, t_a, y_a, g_a, t, y, g_b, g);
            return true;
        }
        g_a = g_b;
    }
    return false;
}

}  // namespace hilda::reference
