// SPDX-License-Identifier: GPL-3.0-or-later
/// The program hilda.

#include "io/program.hpp"
#include "studies/program/command_line.hpp"

#include <stdexcept>

namespace {

/// False if denormal numbers are flushed to zero. A shared library built with -ffast-math sets this mode for
/// the whole process.
bool keeps_denormals()
{
    volatile double tiny = 1e-300;
    tiny = tiny * 1e-10;
    return tiny != 0;
}

}  // namespace

int main(int argc, char** argv)
{
    return hilda::io::run_program([&] {
        if (!keeps_denormals())
            throw std::runtime_error("a library of this process flushes denormal numbers to zero");
        return hilda::studies::command_line(argc, argv);
    });
}
