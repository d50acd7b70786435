// SPDX-License-Identifier: GPL-3.0-or-later
/// A run that is ended by signals and resumed writes the same files as an uninterrupted run.

#pragma once

#include "tests/support/program/program.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>

namespace hilda::tests {

inline nlohmann::ordered_json summary(const fs::path& directory)
{
    return nlohmann::ordered_json::parse(read(directory / "summary.json"));
}

/// A table without its last column
inline std::string without_last_column(const std::string& table)
{
    std::istringstream in(table);
    std::string all;
    for (std::string line; std::getline(in, line);) all += line.substr(0, line.rfind(',')) + '\n';
    return all;
}

/// The files of a run and of its subdirectories, by name, without checkpoints and without all that differs
/// between two executions: wall times and the command line
inline std::map<std::string, std::string> results(const fs::path& directory)
{
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(directory)) {
        const std::string name = fs::relative(entry.path(), directory).string();
        if (!entry.is_regular_file() || name.starts_with("checkpoint")) continue;
        std::string text = read(entry.path());
        if (name == "steps.csv") text = without_last_column(text);
        if (name == "summary.json") {
            auto record = nlohmann::ordered_json::parse(text);
            record.erase("timing"), record.erase("provenance");
            text = record.dump(1);
        }
        files[name] = std::move(text);
    }
    return files;
}

/// Requires that two runs have written the same files.
inline void check_same_results(const fs::path& a, const fs::path& b)
{
    const auto of_a = results(a), of_b = results(b);
    for (const auto* one : {&of_a, &of_b})
        for (const auto& [name, text] : *one) {
            CAPTURE(name);
            REQUIRE((of_a.contains(name) && of_b.contains(name)));
            const bool same = of_a.at(name) == of_b.at(name);
            CHECK(same);
        }
    CHECK(of_a.contains("trajectory.csv"));
}

/// A signal in a step of a run, while the checkpoint of this step is written
struct EndOfPart {
    int signal;
    long steps;  ///< after the start or the resumption of the run
};

/// Executes a run at once in the directory "whole", and in the directory "parts" with these ends, after each
/// of which it is resumed. Requires that each part has ended before the end of the run, and that the files
/// are the same at the end. `run`: the command without --output and --checkpoint.
inline void check_resumed(const Scratch& in, const std::vector<std::string>& run,
                          const std::vector<EndOfPart>& parts = {{SIGINT, 90}, {SIGKILL, 60}, {SIGKILL, 75}})
{
    const Ended at_once = call(in, with(run, {"--quiet", "--output", "whole"}));
    CAPTURE(at_once.err);
    REQUIRE(at_once.code == 0);
    const std::vector<std::string> in_parts = with(run, {"--quiet", "--output", "parts"});
    bool resumed = false;
    for (const EndOfPart& part : parts) {
        // A checkpoint after each step, and one at the start of a new run
        const long checkpoints = part.steps + (resumed ? 0 : 1);
        std::vector<std::string> words = with(in_parts, {"--checkpoint", "1e-9"});
        if (resumed) words.emplace_back("--resume");
        const Ended ended =
            call(in, words,
                 {.end_at = {.signal = part.signal, .write = checkpoints, .file = "checkpoint.new.tmp"}});
        CAPTURE(part.signal, ended.err);
        REQUIRE(ended.code == 128 + part.signal);
        REQUIRE(fs::exists(in / "parts/checkpoint"));
        REQUIRE(fs::file_size(in / "parts/trajectory.csv") < fs::file_size(in / "whole/trajectory.csv"));
        if (part.signal != SIGKILL || fs::exists(in / "parts/summary.json"))
            CHECK(summary(in / "parts")["status"] == "interrupted");
        resumed = true;
    }
    const Ended last = call(in, with(in_parts, {"--resume"}));
    CAPTURE(last.err);
    REQUIRE(last.code == 0);
    CHECK(summary(in / "parts")["provenance"]["resumed_at_step"] > 0);
    CHECK_FALSE(fs::exists(in / "parts/checkpoint"));
    check_same_results(in / "parts", in / "whole");
}

}  // namespace hilda::tests
