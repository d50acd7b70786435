// SPDX-License-Identifier: GPL-3.0-or-later
// Adds the studies of the module hilda-grains.so to the list of studies.
#include "run/cosim/grains.hpp"
#include "studies/framework/study.hpp"

namespace hilda::studies {

namespace {

/// The studies of the module register themselves when it is loaded.
std::vector<Study> load_studies()
{
    run::find_grains("studies of grains");
    return {};
}

const bool registered_grains = register_studies(load_studies);

}  // namespace

}  // namespace hilda::studies
