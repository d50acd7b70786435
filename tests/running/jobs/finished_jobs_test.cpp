// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/jobs/finished_jobs.hpp"

#include "tests/support/program/program.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::tests;
using Catch::Matchers::Contains;
using run::FinishedJobs;

namespace {

const FinishedJobs::Identity identity = {{"study", "convergence"}, {"--steps", "0.001"}};

struct Result {
    double value = 0;
    std::string status = {};

    void transfer(io::Archive& a) { a.value(value), a.list(status); }
};

FinishedJobs::Transfer of(Result& result)
{
    return [&](io::Archive& a) { result.transfer(a); };
}

/// Keeps the results of jobs 0 … count - 1 of pool 0.
void keep(const Scratch& in, int count)
{
    FinishedJobs jobs(in.path, identity, false);
    for (int k = 0; k < count; ++k) {
        Result result{k / 3.0, std::string(static_cast<size_t>(k), 'x')};
        jobs.keep({0, k}, of(result));
    }
}

/// The number of results that are read; each must be the one that was kept.
int restored(const Scratch& in)
{
    const FinishedJobs jobs(in.path, identity, true);
    int count = 0;
    for (int k = 0; k < 100; ++k) {
        Result result;
        if (!jobs.restore({0, k}, of(result))) continue;
        CHECK(result.value == k / 3.0);
        CHECK(result.status == std::string(static_cast<size_t>(k), 'x'));
        ++count;
    }
    return count;
}

}  // namespace

TEST_CASE("results of finished jobs are read back to the bit", "[run][resume]")
{
    const Scratch in;
    keep(in, 7);
    CHECK(restored(in) == 7);
    CHECK(restored(in) == 7);  // reading does not change the file

    FinishedJobs jobs(in.path, identity, true);
    Result result;
    CHECK(!jobs.restore({1, 0}, of(result)));  // another pool
    jobs.remove();
    CHECK(!FinishedJobs::in(in.path));
}

TEST_CASE("a study that was interrupted before its first record starts from the beginning", "[run][resume]")
{
    const Scratch in;
    write(in / "study.part", "");
    {
        FinishedJobs jobs(in.path, identity, true);
        CHECK(jobs.count() == 0);
        Result result{1. / 3, "x"};
        jobs.keep({0, 1}, of(result));
    }
    CHECK(restored(in) == 1);
}

TEST_CASE("a record that was cut off or damaged is dropped, and the preceding ones are kept", "[run][resume]")
{
    const Scratch in;
    keep(in, 7);
    const fs::path file = in / "study.part";
    const std::string whole = read(file);
    int last = -1;
    for (size_t length = whole.size(); length > 120; --length) {
        write(file, whole.substr(0, length));
        const int count = restored(in);
        CHECK((last < 0 || count == last || count == last - 1));
        last = count;
    }
    CHECK(last < 7);

    std::string damaged = whole;
    damaged.back() ^= 1;
    write(file, damaged);
    CHECK(restored(in) == 6);
    Result again{2, "xxxxxx"};
    {
        FinishedJobs jobs(in.path, identity, true);  // continues after the last whole record
        jobs.keep({0, 6}, of(again));
    }
    CHECK(restored(in) == 7);
}

TEST_CASE("an interrupted study continues with the same options only", "[run][resume]")
{
    const Scratch in;
    write(in / "other.txt", "");
    CHECK_THROWS_WITH(FinishedJobs(in.path, identity, true), Contains("has no interrupted study"));
    fs::remove(in / "other.txt");
    CHECK(FinishedJobs(in.path, identity, true).count() == 0);  // an empty directory: the study begins
    keep(in, 1);
    FinishedJobs::Identity other = identity;
    other["--steps"] = "0.002";
    CHECK_THROWS_WITH(
        FinishedJobs(in.path, other, true),
        Contains("needs the same --steps") && Contains("has '0.001', this command has '0.002'"));
    other["--steps"] = "0.002\n0.001";  // a message has one line
    CHECK_THROWS_WITH(FinishedJobs(in.path, other, true), Contains("this command has '0.002, 0.001'"));
    other = identity;
    other["--problem"] = "four_link";
    CHECK_THROWS_WITH(FinishedJobs(in.path, other, true),
                      Contains("has the default, this command has 'four_link'"));
    write(in / "study.part", "something else");
    CHECK_THROWS_AS(FinishedJobs(in.path, identity, true), io::IoError);
}

TEST_CASE("a study without a finished job leaves no file", "[run][resume]")
{
    const Scratch in;
    keep(in, 0);
    CHECK(!FinishedJobs::in(in.path));
}
