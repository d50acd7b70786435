// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/error.hpp"
#include "studies/program/command_line.hpp"
#include "tests/fuzz/targets.hpp"

namespace hilda::fuzz {

void arguments(std::string_view input)
{
    CommandLine line("hilda", input);
    try {
        studies::read_command_line(line.argc(), line.argv());  // the command is not executed
    } catch (const io::UsageError&) {
    }
}

}  // namespace hilda::fuzz
