// SPDX-License-Identifier: GPL-3.0-or-later
// The component studies of an installed HILDA: its library contains the studies and problems, which register themselves.
#include <algorithm>
#include <cstdio>

#include "studies/framework/problem.hpp"
#include "studies/framework/study.hpp"

int main()
{
    const auto named = [](const auto& list, const char* name) {
        return std::any_of(list.begin(), list.end(), [&](const auto& one) { return one.name == name; });
    };
    const auto& studies = hilda::studies::studies();
    std::printf("studies: %zu studies, %zu problems\n", studies.size(), hilda::studies::problems().size());
    return named(studies, "convergence") && named(studies, "granular-head-on") &&
                   named(hilda::studies::problems(), "double_pendulum")
               ? 0
               : 1;
}
