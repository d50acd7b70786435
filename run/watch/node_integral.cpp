// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/watch/node_integral.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::run {

void NodeIntegral::add(double value, double h)
{
    if (count > 1 && std::abs(h - step) > 1e-9 * h) count = 1;
    step = h;
    if (count <= 1) before = sum;
    if (count == 1)
        sum = before + h / 2 * (value + last[0]);
    else if (count == 2)
        sum = before + h / 3 * (value + 4 * last[0] + last[1]);
    else if (count == 3)
        sum = before + 3 * h / 8 * (value + 3 * last[0] + 3 * last[1] + last[2]);
    else if (count > 3)
        sum += h / 24 * (9 * value + 19 * last[0] - 5 * last[1] + last[2]);
    last = {value, last[0], last[1]};
    count = std::min(count + 1, 4L);
}

}  // namespace hilda::run
