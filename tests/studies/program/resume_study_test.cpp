// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/program/refused.hpp"

#include <catch2/catch.hpp>

using namespace hilda::tests;
using Catch::Matchers::Contains;

namespace {

/// A call of a study of a second or so
struct Call {
    std::vector<std::string> arguments;
    std::vector<std::string> without;  ///< columns of study.csv that are times
    std::vector<long> writes;          ///< to study.part in each part; the first part begins with its options
};

const std::vector<Call> calls = {
    {{"study", "convergence", "--problem", "double_pendulum_moving,slider_crank", "--integrator",
      "rA-half-1,rA-half-2,rA-full-1", "--steps", "4e-3,2e-3,1e-3,5e-4", "--no-plot"},
     {"cpu_seconds"},
     {3, 4, 5}},
    {{"study", "iterations", "--problem", "four_link", "--steps", "1e-2,1e-3,2e-4", "--no-plot"},
     {"cpu_seconds"},
     {3, 4, 5}},
    {{"study", "energy", "--steps", "1e-3,5e-4", "--end", "1", "--no-plot"}, {"cpu_seconds"}, {3, 4, 5}},
    {{"study", "compare", "--problem", "slider_crank", "--steps", "1e-4", "--no-plot"},
     {"cpu_seconds"},
     {2, 2}},
    {{"study", "friction", "--no-plot"}, {}, {3, 4, 5}},
    {{"study", "granular-oblique", "--no-plot"}, {}, {4, 50, 30}}};

/// A CSV file without these columns
std::string table(const fs::path& file, const std::vector<std::string>& without)
{
    std::istringstream in(read(file));
    std::vector<bool> kept;
    std::string all;
    for (std::string line; std::getline(in, line); all += '\n') {
        std::istringstream cells(line);
        size_t k = 0;
        for (std::string cell; std::getline(cells, cell, ','); ++k) {
            if (kept.size() == k)
                kept.push_back(std::find(without.begin(), without.end(), cell) == without.end());
            if (kept[k]) all += cell + ',';
        }
    }
    return all;
}

}  // namespace

TEST_CASE("an interrupted study, resumed, gives the table of an uninterrupted study (long)",
          "[studies][resume]")
{
    const Call& c = calls[static_cast<size_t>(GENERATE(range(0, 6)))];
    CAPTURE(c.arguments[1]);
    const Scratch in;
    REQUIRE(call(in, with(c.arguments, {"--quiet", "--output", "whole"})).code == 0);

    // Each signal comes in the middle of a record. The last one comes after the last record.
    const int signals[] = {SIGINT, SIGKILL, SIGTERM};
    std::vector<EndAt> ends;
    for (const long write : c.writes) ends.push_back({signals[ends.size() % 3], write, "parts/study.part"});
    ends.push_back({SIGKILL, 1, "parts/study.csv.tmp"});
    std::vector<std::string> parts = with(c.arguments, {"--jobs", "2", "--output", "parts"});
    for (const EndAt& end : ends) {
        const Ended ended = call(in, parts, {.end_at = end});
        CAPTURE(end.signal, end.write, ended.err);
        REQUIRE(ended.code == 128 + end.signal);
        if (end.signal != SIGKILL)
            CHECK_THAT(ended.err, Contains("the same command with --resume continues"));
        CHECK(fs::exists(in / "parts/study.part"));
        CHECK_FALSE(fs::exists(in / "parts/study.csv"));
        if (&end == &ends.front()) parts.emplace_back("--resume");
    }
    const Ended last = call(in, parts);
    CAPTURE(last.err);
    CHECK(last.code == 0);
    CHECK(!fs::exists(in / "parts/study.part"));
    CHECK(table(in / "parts/study.csv", c.without) == table(in / "whole/study.csv", c.without));
}

TEST_CASE("the option --resume of a study needs an interrupted study and the same options",
          "[studies][resume]")
{
    const Scratch in;
    const std::vector<std::string> study = {"study", "energy", "--steps", "1e-2", "--no-plot", "--quiet"};
    check_refused(in, with(study, {"--resume", "--json"}), 2, "--resume");
    check_refused(in, with(study, {"--resume", "--force"}), 2, "--resume");
    REQUIRE(call(in, with(study, {"--resume", "--output", "a"})).code == 0);  // an empty directory: it begins
    check_refused(in, with(study, {"--resume", "--output", "a"}), 2,
                  "has no interrupted study");  // it has ended
}
