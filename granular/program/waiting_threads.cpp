// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/program/waiting_threads.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace hilda::granular {

void let_threads_sleep(int argc, char** argv)
{
    constexpr const char* spins = "3000";  // of about 10 ns; the default is 300000
    const bool has_threads = std::any_of(argv, argv + argc, [](const char* argument) {
        return std::string_view(argument).starts_with("--threads");
    });
    if (!has_threads || std::getenv("GOMP_SPINCOUNT") != nullptr ||
        std::getenv("OMP_WAIT_POLICY") != nullptr || setenv("GOMP_SPINCOUNT", spins, 1) != 0)
        return;
    execv("/proc/self/exe", argv);  // returns only if it fails
}

}  // namespace hilda::granular
