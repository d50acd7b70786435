// SPDX-License-Identifier: GPL-3.0-or-later
/// A library that takes the place of OpenBLAS in a test. When it is loaded, it prints the number of threads
/// that OpenBLAS would start.

#include <cstdio>
#include <cstdlib>

extern "C" void openblas_set_num_threads(int /*threads*/) {}

namespace {

const bool printed = [] {
    const char* threads = std::getenv("OPENBLAS_NUM_THREADS");
    return std::printf("threads: %s\n", threads != nullptr ? threads : "all") > 0 && std::fflush(stdout) == 0;
}();

}  // namespace
