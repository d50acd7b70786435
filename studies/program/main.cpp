// SPDX-License-Identifier: GPL-3.0-or-later
/// The program hilda.

#include "io/error.hpp"
#include "io/message.hpp"
#include "studies/program/command_line.hpp"

#include <csignal>
#include <iostream>

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
    using namespace hilda::studies;
    std::signal(SIGXFSZ, SIG_IGN);  // write() then fails with EFBIG, and the message names the file
    try {
        if (!keeps_denormals())
            throw std::runtime_error("a library of this process flushes denormal numbers to zero");
        const int code = command_line(argc, argv);
        if (!std::cout.flush()) throw hilda::io::IoError("standard output: cannot be written");
        return code;
    } catch (const std::exception& error) {
        std::cout.flush();
        return hilda::io::report(error);
    }
}
