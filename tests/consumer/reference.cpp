// SPDX-License-Identifier: GPL-3.0-or-later
// The component reference of an installed HILDA: the period of a pendulum at 90 degrees is 4 K(1/2) √(l/g)
// with K = 1.8540747.
#include <cmath>
#include <cstdio>

#include "reference/motions/swing_period.hpp"

int main()
{
    const double l = 2, g = 9.81, q_0 = std::acos(-1) / 2;
    const double T = hilda::reference::swing_period(
        q_0, [&](double) { return l * l; },
        [&](double q, double left) { return 2 * g * l * std::sin(q + left / 2) * std::sin(left / 2); });
    std::printf("reference: T = %.9f s\n", T);
    return std::abs(T - 4 * 1.854074677301372 * std::sqrt(l / g)) < 1e-9 ? 0 : 1;
}
