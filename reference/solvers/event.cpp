// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/solvers/event.hpp"

#include "lie/check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hilda::reference {

namespace {

// Regula falsi with halving needs about eight; each bisection beyond would still give a digit in three.
constexpr int most_trials = 100;

/// Leaves t, y at the fall of g between the look (t_a, y_a, g_a > 0) and (t, y, g_b ≤ 0).
void find(Ode& ode, double t_a, const Eigen::VectorXd& y_a, double g_a, double& t, VectorRef& y, double g_b,
          const Event& g)
{
    double left = t_a, right = t;
    int stayed = 0;  // which end the last trial left alone: -1 the left one, 1 the right one
    for (int trial = 0; trial < most_trials && g_b != 0; ++trial) {
        if (right - left <=
            4 * std::numeric_limits<double>::epsilon() * std::max(std::abs(right), right - t_a))
            return;
        double middle = right - g_b * (right - left) / (g_b - g_a);
        if (!(middle > left && middle < right)) middle = left + 0.5 * (right - left);
        Eigen::VectorXd y_m = y_a;
        double t_m = t_a;
        ode.advance(t_m, y_m, middle);
        const double g_m = g(t_m, y_m);
        if (g_m > 0) {
            left = t_m, g_a = g_m;
            if (stayed == 1) g_b /= 2;  // or it would stay for ever (Illinois)
            stayed = 1;
        } else {
            right = t_m, g_b = g_m;
            if (stayed == -1) g_a /= 2;
            stayed = -1;
            t = t_m, y = y_m;
        }
    }
}

}  // namespace

bool advance_to_event(Ode& ode, double& t, VectorRef y, double t_end, double look, const Event& g)
{
    if (!(look > 0))
        lie::reject("reference::advance_to_event", "the time between looks must be positive", look);
    double g_a = g(t, y);
    while (t < t_end) {
        const double t_a = t;
        const Eigen::VectorXd y_a = y;
        ode.advance(t, y, std::min(t + look, t_end));
        const double g_b = g(t, y);
        if (g_a > 0 && !(g_b > 0)) {
            find(ode, t_a, y_a, g_a, t, y, g_b, g);
            return true;
        }
        g_a = g_b;
    }
    return false;
}

}  // namespace hilda::reference
