// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/studies/program.hpp"

#include <catch2/catch.hpp>

using namespace hilda::tests;
using Catch::Matchers::Contains;

namespace {

/// Calls of studies of a second or so, with the columns of study.csv that are not times
struct Call {
    std::vector<std::string> arguments;
    std::vector<std::string> without;
};

const std::vector<Call> calls = {
    {{"study", "convergence", "--problem", "double_pendulum_moving,slider_crank", "--integrator",
      "rA-half-1,rA-half-2,rA-full-1", "--steps", "4e-3,2e-3,1e-3,5e-4", "--no-plot"},
     {"cpu_seconds"}},
    {{"study", "iterations", "--problem", "four_link", "--steps", "1e-2,1e-3,2e-4", "--no-plot"},
     {"cpu_seconds"}},
    {{"study", "energy", "--steps", "1e-3,5e-4", "--no-plot"}, {"cpu_seconds"}},
    {{"study", "compare", "--problem", "slider_crank", "--steps", "1e-4", "--no-plot"}, {"cpu_seconds"}},
    {{"study", "friction", "--no-plot"}, {}}};

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

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more)
{
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

}  // namespace

TEST_CASE("an interrupted study, resumed, gives the table of an uninterrupted study (long)",
          "[studies][resume]")
{
    const Call& c = calls[static_cast<size_t>(GENERATE(range(0, 5)))];
    CAPTURE(c.arguments[1]);
    const Scratch in;
    REQUIRE(call(in, with(c.arguments, {"--quiet", "--output", "whole"})).code == 0);

    const std::vector<std::string> parts = with(c.arguments, {"--jobs", "2", "--output", "parts"});
    // A signal after the last line of the study finds complete results.
    const auto is_complete = [&] {
        return fs::exists(in / "parts/study.csv") && !fs::exists(in / "parts/study.part");
    };
    int code = 137, interruptions = 0, messages = 0;
    for (int k = 0; k < 30 && code >= 128 && !is_complete(); ++k) {
        const Program part(in, fs::exists(in / "parts/study.part") ? with(parts, {"--resume"}) : parts);
        std::this_thread::sleep_for(std::chrono::milliseconds(20 + 37 * k));
        const int signal = k % 3 == 0 ? SIGINT : k % 3 == 1 ? SIGKILL : SIGTERM;
        part.send(signal);
        const Ended ended = part.wait();
        code = ended.code;
        if (code < 128) break;
        CHECK(code == 128 + signal);
        // A signal before the first line of the program ends it without a message.
        if (signal != SIGKILL && !ended.err.empty())
            CHECK_THAT(ended.err, Contains("the same command with --resume continues"));
        messages += !ended.err.empty();
        ++interruptions;
    }
    if (code >= 128 && !is_complete()) code = call(in, with(parts, {"--resume"})).code;
    CHECK((code == 0 || is_complete()));
    CHECK(interruptions > 0);
    CHECK((messages > 0 || interruptions < 6));
    CHECK(!fs::exists(in / "parts/study.part"));
    CHECK(table(in / "parts/study.csv", c.without) == table(in / "whole/study.csv", c.without));
}

TEST_CASE("the option --resume of a study needs an interrupted study and the same options",
          "[studies][resume]")
{
    const Scratch in;
    const std::vector<std::string> study = {"study", "energy", "--steps", "1e-2", "--no-plot", "--quiet"};
    const Ended nothing = call(in, with(study, {"--resume", "--output", "a"}));
    CHECK(nothing.code == 2);
    CHECK_THAT(nothing.err, Contains("a: has no interrupted study"));
    CHECK(!fs::exists(in / "a"));
    CHECK(call(in, with(study, {"--resume", "--json"})).code == 2);
    CHECK(call(in, with(study, {"--resume", "--force"})).code == 2);
    REQUIRE(call(in, with(study, {"--output", "a"})).code == 0);
    CHECK(call(in, with(study, {"--resume", "--output", "a"})).code == 2);  // it has ended
}
