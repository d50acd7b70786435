// SPDX-License-Identifier: GPL-3.0-or-later
// The function that the program looks up in the module hilda-grains.so.
#include "run/cosim/grains.hpp"

#include "granular/backend/instruction_set.hpp"
#include "granular/case/law_list.hpp"

extern "C" const hilda::run::GrainFunctions* hilda_grain_functions()
{
    using namespace hilda;
    static const run::GrainFunctions functions{
        .run_cosim = run::run_cosim,
        .check_cosim = run::check_cosim,
        .law_names = [](const std::string& kind) { return granular::law_names(kind); },
        .vector_instructions = granular::described_instruction_set};
    return &functions;
}
