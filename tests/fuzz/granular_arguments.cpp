// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/program/arguments.hpp"
#include "io/error.hpp"
#include "tests/fuzz/targets.hpp"

namespace hilda::fuzz {

void granular_arguments(std::string_view input)
{
    CommandLine line("hilda-granular", input);
    granular::Options options;
    try {
        granular::read_arguments(line.argc(), line.argv(), options);
    } catch (const io::UsageError&) {
    }
}

}  // namespace hilda::fuzz
