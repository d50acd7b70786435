// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/solvers/event.hpp"

#include "lie/bracket.hpp"
#include "lie/check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hilda::reference {

namespace {

/// Locates the zero of g between (t_a, y_a) with g_a > 0 and (t, y) with g_b ≤ 0. On return t, y is the right
/// end of the last bracket.
void locate_zero(Ode& ode, double t_a, const Eigen::VectorXd& y_a, double g_a, double& t, VectorRef& y,
                 double g_b, const Event& g)
{
    if (g_b == 0) return;
    lie::Bracket bracket(t_a, g_a, t, g_b);
    const double tolerance = 4 * std::numeric_limits<double>::epsilon() * std::max(std::abs(t), t - t_a);
    lie::narrow(bracket, tolerance, [&](double s) {
        Eigen::VectorXd y_m = y_a;
        double t_m = t_a;
        ode.advance(t_m, y_m, s);
        const double g_m = g(t_m, y_m);
        if (g_m <= 0) t = t_m, y = y_m;
        return g_m;
    });
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
