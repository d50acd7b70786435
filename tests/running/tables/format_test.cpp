// SPDX-License-Identifier: GPL-3.0-or-later
/// The option --format of runs.

#include "tests/support/program/program.hpp"

#include <catch2/catch.hpp>

#include <cstdlib>

using namespace hilda::tests;
using Catch::Matchers::Contains;

TEST_CASE("a wrong --format is rejected before any file is written", "[run][hdf5]")
{
    const Scratch in;
    const Ended wrong = call(in, {"run", "double_pendulum", "--format", "hdf", "--output", "a"});
    CHECK(wrong.code == 2);
    CHECK(wrong.err == "hilda: error: --format: must be csv or hdf5, got 'hdf'; did you mean 'hdf5'?\n");
    CHECK_FALSE(fs::exists(in / "a"));
}

TEST_CASE("the format csv is the default, also for --resume", "[run][hdf5]")
{
    const Scratch in;
    REQUIRE(call(in, {"run", "double_pendulum", "--end", "0.1", "--output", "a"}).code == 0);
    REQUIRE(call(in, {"run", "double_pendulum", "--end", "0.1", "--format", "csv", "--output", "b"}).code ==
            0);
    CHECK(read(in / "a/trajectory.csv") == read(in / "b/trajectory.csv"));
    CHECK(call(in, {"run", "double_pendulum", "--end", "0.2", "--resume", "--output", "b"}).code == 0);
}

// A copy of the program does not find its module hilda-hdf5.so.
TEST_CASE("without HDF5 --format hdf5 ends with exit code 7 and says what to install", "[run][hdf5]")
{
    const Scratch in;
    fs::create_directories(in / "bin");
    fs::copy_file(hilda_program, in / "bin/hilda");
    const std::string command =
        "cd '" + in.path.string() + "' && bin/hilda run double_pendulum --format hdf5 --output a >out 2>err";
    const int status = std::system(command.c_str());  // NOLINT(cert-env33-c, concurrency-mt-unsafe)
    CHECK(WEXITSTATUS(status) == 7);
    CHECK_THAT(read(in / "err"), Contains("--format hdf5: needs the module hilda-hdf5.so") &&
                                     Contains("apt-get install libhdf5-dev"));
    CHECK_FALSE(fs::exists(in / "a"));
}
