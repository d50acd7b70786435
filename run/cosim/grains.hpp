// SPDX-License-Identifier: GPL-3.0-or-later
/// What the program hilda takes from grains: co-simulations, the studies granular-NAME, and the names of
/// force laws.
///
/// These functions are in the module hilda-grains.so, which the program loads when a command needs it:
/// without them it is built in three quarters of the time. Programs that link libhilda_studies have them from
/// the start.

#pragma once

#include "run/cosim/check_cosim.hpp"
#include "run/cosim/run_cosim.hpp"

#include <string>
#include <vector>

namespace hilda::run {

struct GrainFunctions {
    int (*run_cosim)(const CosimOptions&);
    int (*check_cosim)(const CheckOptions&);
    std::vector<std::string> (*law_names)(const std::string& kind);  ///< see granular::law_names
    std::string (*vector_instructions)();  ///< of the loops over grains, for hilda info
};

/// The functions of grains; nullptr if there is no module. Loading it registers its studies. Throws
/// io::NotAvailable "WHAT: ..." if it cannot be loaded.
const GrainFunctions* find_grains(const std::string& what);

/// The same; throws io::NotAvailable with the remedy if there is no module.
const GrainFunctions& grains(const std::string& what);

}  // namespace hilda::run
