// SPDX-License-Identifier: GPL-3.0-or-later
// The component studies of an installed HILDA: its library contains the studies and problems, which register
// themselves. With the argument hdf5 it also loads the module for HDF5 files, which must be installed.
#include <algorithm>
#include <cstdio>

#include "run/tables/run_table.hpp"
#include "studies/framework/problem.hpp"
#include "studies/framework/study.hpp"

int main(int argc, char**)
{
    if (argc > 1) hilda::run::hdf5_tables(".", {});  // throws without the module
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
