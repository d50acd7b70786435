// SPDX-License-Identifier: GPL-3.0-or-later
/// hilda study --shard I/N and hilda collect.
#include "tests/studies/program/divided_studies.hpp"
#include "tests/support/program/csv.hpp"
#include "tests/support/program/refused.hpp"
#include "tests/support/program/resumed_run.hpp"

#include <catch2/catch.hpp>

#include <cstdlib>

using namespace hilda::tests;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

std::string folder(const std::string& begin, int index, int count)
{
    return begin + '-' + std::to_string(index) + "-of-" + std::to_string(count);
}

/// Computes the shard of a study in the folder BEGIN-I-of-N.
Ended compute(const Scratch& in, const std::vector<std::string>& study, const std::string& begin, int index,
              int count, const Limits& limits = {})
{
    return call(in,
                with(study, {"--shard", std::to_string(index) + '/' + std::to_string(count), "--output",
                             folder(begin, index, count)}),
                limits);
}

/// study.json without what differs between two calls
std::string record(const fs::path& directory)
{
    auto all = nlohmann::ordered_json::parse(read(directory / "study.json"));
    all.erase("provenance");
    return all.dump(1);
}

}  // namespace

TEST_CASE("the shards of a study, collected, give the files of the study byte for byte", "[studies][shard]")
{
    const Scratch in;
    const Ended whole = call(in, with(incline, {"--output", "whole"}));
    REQUIRE(whole.code == 0);
    for (const int count : {1, 2, 5}) {
        CAPTURE(count);
        std::vector<std::string> collect = {"collect", "--no-plot", "--output",
                                            "all-" + std::to_string(count)};
        for (int k = count; k >= 1; --k) {
            const Ended shard = compute(in, incline, "part", k, count);
            CAPTURE(shard.err);
            REQUIRE(shard.code == 0);
            CHECK(shard.err.empty());
            collect.push_back(folder("part", k, count));
            if (count > 1) {
                CHECK_THAT(shard.out, Contains("is complete") && Contains("hilda collect"));
                CHECK(fs::exists(in / collect.back() / "study.shard"));
                CHECK_FALSE(fs::exists(in / collect.back() / "study.csv"));
            }
        }
        if (count == 1) {  // the whole study
            CHECK(read(in / "part-1-of-1/study.csv") == read(in / "whole/study.csv"));
            continue;
        }
        const Ended collected = call(in, collect);
        CAPTURE(collected.err);
        CHECK(collected.code == 0);
        CHECK(collected.err.empty());
        const fs::path all = in / collect[3];
        CHECK(read(all / "study.csv") == read(in / "whole/study.csv"));
        CHECK(record(all) == record(in / "whole"));
        const auto text = [](const Ended& ended) {
            return ended.out.substr(0, ended.out.find("written to"));
        };
        CHECK(text(collected) == text(whole));
        CHECK_FALSE(fs::exists(all / "study.part"));
        CHECK_FALSE(fs::exists(all / "study.shard"));
    }
}

TEST_CASE("hilda collect copies the motions of the runs; an interrupted shard continues", "[studies][shard]")
{
    const Scratch in;
    write(in / "swing.json", pendulum());
    REQUIRE(call(in, with(swing, {"--output", "whole"})).code == 0);
    REQUIRE(compute(in, swing, "part", 1, 2).code == 0);
    const Ended cut = compute(in, swing, "part", 2, 2, {.end_at = {SIGKILL, 4, "study.part"}});
    CHECK(cut.code == 128 + SIGKILL);
    const std::vector<std::string> collect = {"collect",   "part-1-of-2", "part-2-of-2",
                                              "--no-plot", "--output",    "all"};
    check_refused(in, collect, 2, "part-2-of-2: shard 2/2 has not ended; its command with --resume");
    REQUIRE(compute(in, with(swing, {"--resume"}), "part", 2, 2).code == 0);
    const Ended collected = call(in, collect);
    CAPTURE(collected.err);
    REQUIRE(collected.code == 0);
    std::vector<CsvRow> a = csv(in / "all/study.csv"), b = csv(in / "whole/study.csv");
    for (auto* rows : {&a, &b})
        for (CsvRow& row : *rows) row.erase("cpu_seconds");
    CHECK(a == b);
    CHECK(a.size() == 5);
    for (const char* run : {"0001", "0002", "0003", "0004", "0005"}) {
        const std::string motion = read(in / "all/runs" / run / "trajectory.csv");
        CHECK_FALSE(motion.empty());
        CHECK(motion == read(in / "whole/runs" / run / "trajectory.csv"));
    }
    check_refused(in, collect, 2, "all: is not empty; --force overwrites it");
    for (const char* wrong : {"part-1-of-2", "part-2-of-2/all"})
        check_refused(in, {"collect", "part-1-of-2", "part-2-of-2", "--output", wrong, "--force"}, 2,
                      "--output: must not be the folder of a shard or in one");
    // A table of an earlier study in the folder of a shard is not copied.
    write(in / "part-1-of-2/study.csv", "of another study");
    REQUIRE(call(in, with(collect, {"--force"})).code == 0);
    CHECK(read(in / "all/study.csv") != "of another study");
    CHECK(call(in, with(collect, {"--force", "--quiet"})).code == 0);

    write(in / "swing.json", pendulum("", R"({"type": "gravity"})"));
    check_refused(in, {"collect", "part-1-of-2", "part-2-of-2", "--output", "other"}, 2,
                  "needs the same content of swing.json");
}

TEST_CASE("the shards of a validation of grains give its tables and criteria (long)", "[studies][shard]")
{
    const Scratch in;
    const std::vector<std::string> brick = {"study", "granular-brick", "--no-plot", "--check"};
    REQUIRE(call(in, with(brick, {"--output", "whole"})).code == 0);
    for (int k = 1; k <= 3; ++k) REQUIRE(compute(in, brick, "part", k, 3).code == 0);
    const Ended all = call(in, {"collect", folder("part", 1, 3), folder("part", 2, 3), folder("part", 3, 3),
                                "--no-plot", "--output", "all"});
    CAPTURE(all.err);
    CHECK(all.code == 0);
    for (const char* file : {"study.csv", "motion.csv"})
        CHECK(read(in / "all" / file) == read(in / "whole" / file));
    CHECK(record(in / "all") == record(in / "whole"));
}

TEST_CASE("more shards than runs are allowed", "[studies][shard]")
{
    const Scratch in;
    write(in / "swing.json", pendulum());
    std::vector<std::string> collect = {"collect", "--quiet", "--no-plot", "--output", "all"};
    for (int k = 1; k <= 7; ++k) {
        REQUIRE(compute(in, swing, "part", k, 7).code == 0);
        collect.push_back(folder("part", k, 7));
    }
    CHECK(call(in, collect).code == 0);
    CHECK(csv(in / "all/study.csv").size() == 5);
}

TEST_CASE("wrong shards are refused", "[studies][shard]")
{
    const Scratch in;
    for (const char* shard :
         {"0/4", "5/4", "a/b", "1", "1/0", "-1/3", "1/2/3", "1.5/2", "1/", "/2", "1/2000000"})
        check_refused(in, with(incline, {"--shard", shard}), 2,
                      std::string("--shard: must be I/N, part I of N with 1 <= I <= N <= 1000000, got '") +
                          shard + "'");
    for (const char* study : {"timing", "contact-methods", "granular-oblique"})
        check_refused(in, {"study", study, "--shard", "1/2"}, 2,
                      std::string("study ") + study + ": --shard is for compare, convergence, ");
    check_refused(in, with(incline, {"--shard", "1/2", "--json"}), 2, "--shard writes a file");

    for (const int k : {1, 2, 3}) REQUIRE(compute(in, incline, "a", k, 3).code == 0);
    REQUIRE(compute(in, incline, "a", 1, 2).code == 0);
    REQUIRE(compute(in, with(incline, {"--end", "0.5"}), "b", 2, 3).code == 0);
    REQUIRE(call(in, with(incline, {"--output", "whole"})).code == 0);
    fs::copy(in / "a-1-of-3", in / "copy");
    const auto refused = [&](const std::vector<std::string>& directories, const std::string& message) {
        check_refused(in, with({"collect", "--output", "all"}, directories), 2, message);
    };
    refused({"a-1-of-3", "a-3-of-3"}, "shards are missing: 2/3");
    refused({"a-2-of-3"}, "shards are missing: 1/3, 3/3");
    refused({"a-1-of-3", "a-2-of-3", "a-3-of-3", "copy"},
            "shard 1/3 is there twice: a-1-of-3/study.shard and copy/study.shard");
    refused({"a-1-of-3", "b-2-of-3", "a-3-of-3"},
            "the shards differ in --end: the default in a-1-of-3/study.shard, '0.5' in b-2-of-3/study.shard");
    refused({"a-1-of-2", "a-2-of-3"},
            "divided in two ways: a-1-of-2/study.shard has shard 1/2, a-2-of-3/study.shard has shard 2/3");
    refused({"whole"}, "whole: is not the output of hilda study --shard");
    refused({"missing"}, "missing: is not the output of hilda study --shard");
    check_refused(in, {"collect"}, 2, "DIR is required");

    write(in / "copy/study.shard", read(in / "a-1-of-3/study.shard").substr(0, 20));
    check_refused(in, {"collect", "copy"}, 5, "copy/study.shard: is not the file");
}

TEST_CASE("a study under mpirun is refused without --shard", "[studies][shard]")
{
    const Scratch in;
    setenv("OMPI_COMM_WORLD_SIZE", "2", 1);
    check_refused(in, incline, 2,
                  "study incline-sweep: each of the 2 processes of mpirun would compute the whole study; use "
                  "--shard I/N and hilda collect");
    CHECK(compute(in, incline, "part", 1, 2).code == 0);
    unsetenv("OMPI_COMM_WORLD_SIZE");
}
