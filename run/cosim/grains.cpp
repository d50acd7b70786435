// SPDX-License-Identifier: GPL-3.0-or-later
// Loads hilda-grains.so.
#include "run/cosim/grains.hpp"

#include "io/error.hpp"
#include "io/module.hpp"

/// Defined in programs that link grains (grains_module.cpp)
extern "C" __attribute__((weak)) const hilda::run::GrainFunctions* hilda_grain_functions();

namespace hilda::run {

const GrainFunctions* find_grains(const std::string& what)
{
    if (hilda_grain_functions != nullptr) return hilda_grain_functions();
    void* const symbol = io::module_symbol(what,
                                           {.name = "hilda-grains.so",
                                            .library_folder = HILDA_LIBRARY_FOLDER,
                                            .caller = reinterpret_cast<const void*>(&find_grains)},
                                           "hilda_grain_functions");
    return symbol == nullptr ? nullptr : reinterpret_cast<const GrainFunctions* (*)()>(symbol)();
}

const GrainFunctions& grains(const std::string& what)
{
    const GrainFunctions* const found = find_grains(what);
    if (found == nullptr)
        throw io::NotAvailable(
            what +
            ": needs the module hilda-grains.so, which was not built; "
            "'./studies/run granular laws' in the source tree builds it (target hilda_grains), "
            "and the Debian package hilda has it");
    return *found;
}

}  // namespace hilda::run
