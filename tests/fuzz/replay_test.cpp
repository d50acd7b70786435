// SPDX-License-Identifier: GPL-3.0-or-later
/// The kept inputs of the fuzz targets, and random changes of them, are accepted or refused without a fault.

#include "io/files.hpp"
#include "tests/fuzz/targets.hpp"
#include "tests/support/paths.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <random>

using namespace hilda;
namespace fs = std::filesystem;

namespace {

struct Target {
    const char* name;
    void (*run)(std::string_view);
};

constexpr Target targets[] = {{"expression", fuzz::expression},
                              {"model", fuzz::model},
                              {"granular_case", fuzz::granular_case},
                              {"checkpoint", fuzz::checkpoint},
                              {"granular_checkpoint", fuzz::granular_checkpoint},
                              {"particles", fuzz::particles},
                              {"mesh", fuzz::mesh},
                              {"table", fuzz::table},
                              {"samples", fuzz::samples},
                              {"words", fuzz::words},
                              {"xml", fuzz::xml},
                              {"arguments", fuzz::arguments},
                              {"granular_arguments", fuzz::granular_arguments}};

fs::path corpus(const std::string& target)
{
    return fs::path(tests::source_dir) / "tests/fuzz/corpus" / target;
}

/// The inputs of a target, in the order of their names. Those of `model` are also the models of the examples
/// and tests.
std::vector<std::string> inputs(const std::string& target)
{
    std::vector<fs::path> folders = {corpus(target)};
    if (target == "model")
        for (const char* models : {"examples/models", "tests/data/models"})
            folders.push_back(fs::path(tests::source_dir) / models);
    std::vector<fs::path> files;
    for (const fs::path& folder : folders)
        if (fs::exists(folder))
            for (const auto& entry : fs::directory_iterator(folder))
                if (entry.is_regular_file()) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    std::vector<std::string> all;
    for (const fs::path& file : files) all.push_back(io::read_file(file.string(), std::size_t{1} << 20));
    return all;
}

/// One random change of an input: of a bit, a word or the length, or a part of another input
std::string changed(std::string input, const std::string& other, std::mt19937& random)
{
    const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
    const std::size_t at = below(input.size()), length = below(16) + 1;
    switch (below(5)) {
        case 0:
            if (!input.empty()) input[at] = static_cast<char>(input[at] ^ (1 << below(8)));
            break;
        case 1:
            input.resize(at);
            break;
        case 2:
            input.erase(at, length);
            break;
        case 3:
            input.insert(at, other, below(other.size()), length);
            break;
        default:
            for (std::size_t k = at; k < std::min(at + 4, input.size()); ++k)
                input[k] = static_cast<char>(0xff);
    }
    return input;
}

}  // namespace

TEST_CASE("the kept inputs of the fuzz targets are accepted or refused", "[fuzz]")
{
    for (const Target& target : targets) {
        const std::vector<std::string> all = inputs(target.name);
        INFO(target.name);
        CHECK_FALSE(all.empty());
        CHECK_NOTHROW(target.run(""));
        for (const std::string& input : all) CHECK_NOTHROW(target.run(input));
    }
}

TEST_CASE("random changes of the kept inputs are accepted or refused", "[fuzz]")
{
    std::mt19937 random(1);
    for (const Target& target : targets) {
        const std::vector<std::string> all = inputs(target.name);
        REQUIRE_FALSE(all.empty());
        constexpr int changes = 100;
        for (int k = 0; k < changes; ++k) {
            std::string input = all.at(random() % all.size());
            for (std::size_t times = random() % 3 + 1; times > 0; --times)
                input = changed(std::move(input), all[random() % all.size()], random);
            CAPTURE(target.name, input);
            CHECK_NOTHROW(target.run(input));
        }
    }
}

// hilda_test_fuzz "[.seeds]" writes them again after a change of the format.
TEST_CASE("the seeds of the checkpoints are written", "[.seeds]")
{
    io::write_file((corpus("checkpoint") / "seed").string(), fuzz::checkpoint_seed());
    io::write_file((corpus("granular_checkpoint") / "seed").string(), fuzz::granular_checkpoint_seed());
    CHECK(fs::file_size(corpus("granular_checkpoint") / "seed") > 1000);
}
