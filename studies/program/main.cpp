// SPDX-License-Identifier: GPL-3.0-or-later
/// The program hilda.

#include "io/program.hpp"
#include "studies/program/command_line.hpp"

#include <dlfcn.h>
#include <malloc.h>
#include <unistd.h>

#include <array>
#include <climits>
#include <cstdlib>
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

/// Restarts the program with OpenBLAS limited to one thread, if this library is the BLAS of the system.
///
/// OpenBLAS starts its threads when it is loaded, before main(), and reads their number from the environment
/// only then. Where the memory is limited (ulimit -v) they cannot start, and the process would wait for them
/// for ever at its end. The factorisations of this program are too small for threads.
void limit_blas_threads(char** argv)
{
    constexpr const char* variable = "OPENBLAS_NUM_THREADS";
    if (std::getenv(variable) != nullptr || dlsym(RTLD_DEFAULT, "openblas_set_num_threads") == nullptr)
        return;
    std::array<char, PATH_MAX> program{};  // not /proc/self/exe itself: its name would be that of the process
    if (readlink("/proc/self/exe", program.data(), program.size() - 1) <= 0) return;
    setenv(variable, "1", 0);
    execv(program.data(), argv);  // returns on failure only: the program then goes on as it is
}

/// Keeps freed memory for later allocations of the process. The C library otherwise returns large blocks to
/// the system, which clears each page again: a sixth of the time to read a model of 100 000 bodies.
void keep_freed_memory()
{
#ifdef __GLIBC__
    mallopt(M_MMAP_MAX, 0);
    mallopt(M_TRIM_THRESHOLD, INT_MAX);
#endif
}

}  // namespace

int main(int argc, char** argv)
{
    limit_blas_threads(argv);
    keep_freed_memory();
    return hilda::io::run_program([&] {
        if (!keeps_denormals())
            throw std::runtime_error("a library of this process flushes denormal numbers to zero");
        return hilda::studies::command_line(argc, argv);
    });
}
