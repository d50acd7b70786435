// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/work_needed.hpp"

#include <cmath>

namespace hilda::studies {

WorkNeeded work_needed(const std::vector<double>& error, const std::vector<double>& seconds, double accuracy)
{
    for (size_t k = 0; k < error.size(); ++k) {
        if (!(error[k] <= accuracy)) continue;
        if (k == 0 || std::isnan(error[k - 1]))
            return {.seconds = seconds[k], .at_most = error[k] < accuracy};
        const double part = std::log(accuracy / error[k - 1]) / std::log(error[k] / error[k - 1]);
        return {.seconds = seconds[k - 1] * std::pow(seconds[k] / seconds[k - 1], part)};
    }
    return {.seconds = std::nan("")};
}

}  // namespace hilda::studies
