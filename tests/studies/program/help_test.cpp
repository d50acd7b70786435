// SPDX-License-Identifier: GPL-3.0-or-later
/// The help texts: length of lines, named commands and studies, options and files of studies.

#include "studies/framework/study.hpp"
#include "tests/support/program/program.hpp"
#include "tests/support/program/refused.hpp"

#include <catch2/catch.hpp>

#include <regex>
#include <set>

using namespace hilda;
using namespace hilda::tests;
using Catch::Matchers::Contains;

namespace {

const std::vector<std::string> commands = {"run",      "cosim",       "kinematics", "inverse", "check",
                                           "models",   "integrators", "schema",     "study",   "collect",
                                           "granular", "plot",        "view",       "info",    "new",
                                           "help",     "import",      "export",     "rerun",   "fit"};

/// All help texts, by the call that prints them
std::vector<std::pair<std::string, std::string>> help_texts(const Scratch& in)
{
    std::vector<std::pair<std::string, std::string>> all;
    const auto add = [&](const std::vector<std::string>& arguments) {
        std::string name;
        for (const std::string& word : arguments) name += ' ' + word;
        const Ended ended = call(in, arguments);
        CAPTURE(name, ended.err);
        CHECK(ended.code == 0);
        CHECK(ended.err.empty());
        all.emplace_back(name, ended.out);
    };
    add({"--help"}), add({"help"}), add({"study"}), add({"models"});
    for (const std::string& command : commands) add({"help", command}), add({command, "--help"});
    for (const studies::Study& study : studies::studies()) add({"help", "study", study.name});
    return all;
}

size_t characters(const std::string& line)
{
    return static_cast<size_t>(
        std::count_if(line.begin(), line.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::set<std::string> matches(const std::string& text, const char* pattern)
{
    std::set<std::string> all;
    const std::regex words(pattern);
    for (std::sregex_iterator at(text.begin(), text.end(), words), end; at != end; ++at) all.insert((*at)[1]);
    return all;
}

/// A file name with words in capitals as a regular expression: energy-PROBLEM.png
std::regex pattern_of(const std::string& file)
{
    return std::regex(std::regex_replace(std::regex_replace(file, std::regex("\\."), "\\."),
                                         std::regex("[A-Z]{2,}"), ".+"));
}

}  // namespace

TEST_CASE("no line of a help text is longer than 100 characters, and what it names exists", "[studies][help]")
{
    const Scratch in;
    std::set<std::string> study_names, options;
    for (const studies::Study& study : studies::studies()) study_names.insert(study.name);
    const auto texts = help_texts(in);
    for (const auto& [name, text] : texts)
        options.merge(matches(text, "(?:^|\\n) {2,6}(?:-\\w,)?(--[a-z-]+)"));
    CHECK(options.contains("--figure-format"));
    for (const auto& [name, text] : texts) {
        CAPTURE(name);
        CHECK(text.size() > 20);
        std::istringstream lines(text);
        for (std::string line; std::getline(lines, line);) {
            CAPTURE(line);
            CHECK(characters(line) <= 100);
        }
        for (const std::string& command : matches(text, "hilda ([a-z]+)")) {
            CAPTURE(command);
            CHECK(std::find(commands.begin(), commands.end(), command) != commands.end());
        }
        for (const std::string& study : matches(text, "hilda study ([a-z-]+)"))
            CHECK(study_names.contains(study));
        for (const std::string& option : matches(text, "(--[a-z][a-z-]*)")) {
            CAPTURE(option);
            CHECK(options.contains(option));
        }
    }
}

TEST_CASE("the help of the program lists all commands, and that of granular its options and exit codes",
          "[studies][help]")
{
    const Scratch in;
    const std::string all = call(in, {"help"}).out;
    for (const std::string& command : commands) CHECK(matches(all, "\\n  ([a-z]+) ").contains(command));
    const std::string granular = call(in, {"help", "granular"}).out;
    CHECK(granular == call(in, {"granular", "--help"}).out);
    CHECK_THAT(granular, Contains("--device") && Contains("--checkpoint") && Contains("6 a check"));
}

TEST_CASE("the help of a study has its options, its keys and its files, and no other options",
          "[studies][help]")
{
    const Scratch in;
    for (const studies::Study& study : studies::studies()) {
        const std::string text = call(in, {"help", "study", study.name}).out;
        CAPTURE(study.name, text);
        CHECK(text == call(in, {"study", study.name, "--help"}).out);
        CHECK_THAT(text, Contains("hilda study " + study.name));
        const std::set<std::string> options = matches(text, "\\n  (?:-h,)?(--[a-z-]+)");
        CHECK(options.contains("--reference") == study.lists("--reference"));
        CHECK(options.contains("--shard") == study.lists("--shard"));
        CHECK(options.contains("--seed") == (study.name == "scaling"));
        CHECK(options.contains("--rtol") == (study.name == "compare" || study.name == "sweep"));
        CHECK(options.contains("--integrator") == study.lists("--integrator"));
        CHECK(options.contains("--expect") == !study.keys.empty());
        CHECK(options.contains("--output"));
        for (const std::string& option : study.options) CHECK(options.contains(option));
        for (const std::string& key : study.keys) CHECK_THAT(text, Contains(key));
        for (const std::string& file : study.files) CHECK_THAT(text, Contains(file));
        CHECK_FALSE(study.files.empty());
    }
    const Ended wrong = call(in, {"help", "study", "convergense"});
    CHECK(wrong.code == 2);
    CHECK_THAT(wrong.err, Contains("did you mean 'convergence'?"));
    CHECK(call(in, {"help", "run", "convergence"}).code == 2);
}

TEST_CASE("the files of a study are those that its help names", "[studies][help]")
{
    const Scratch in;
    const std::vector<std::vector<std::string>> calls = {
        {"energy", "--problem", "double_pendulum", "--end", "0.1", "--integrator", "rA-half-1"},
        {"compare", "--end", "0.1"},
        {"convergence", "--problem", "double_pendulum", "--end", "1", "--steps", "1e-2,5e-3", "--integrator",
         "rA-half-1"},
        {"iterations", "--problem", "double_pendulum", "--end", "0.1", "--steps", "1e-2", "--integrator",
         "rA-half-1"},
        {"timing", "--problem", "double_pendulum", "--end", "0.1", "--steps", "1e-2", "--repeats", "1"},
        {"long-time", "--problem", "heavy_top", "--end", "0.2", "--integrator", "rA-rattle"},
        {"tolerance", "--problem", "double_pendulum", "--end", "0.1", "--integrator", "rA-rattle"},
        {"stiffness", "--end", "0.02", "--integrator", "rA-radau-5", "--repeats", "1"},
        {"friction", "--problem", "brick"},
        {"granular-oblique"},
        {"evolving-friction", "--end", "0.1"}};
    for (const auto& arguments : calls) {
        const std::string& name = arguments.front();
        std::vector<std::string> words = {"study"};
        words.insert(words.end(), arguments.begin(), arguments.end());
        words.insert(words.end(), {"--quiet", "--output", name});
        CAPTURE(name);
        CHECK(call(in, words).code == 0);
        const auto study = std::find_if(studies::studies().begin(), studies::studies().end(),
                                        [&](const auto& s) { return s.name == name; });
        REQUIRE(study != studies::studies().end());
        for (const auto& entry : fs::directory_iterator(in / name)) {
            const std::string file = entry.path().filename();
            if (file == "study.csv" || file == "study.json") continue;
            CAPTURE(file);
            CHECK(std::any_of(study->files.begin(), study->files.end(), [&](const std::string& known) {
                return std::regex_match(file, pattern_of(known));
            }));
        }
    }
}

TEST_CASE("an option of the integrators that none of them uses is refused with those that use it",
          "[studies][help]")
{
    const Scratch in;
    const std::vector<std::pair<std::vector<std::string>, std::string>> refused = {
        {{"run", "double_pendulum", "--rtol", "1e-6"},
         "no selected integrator uses --rtol; it is for ida-rp"},
        {{"run", "double_pendulum", "--atol", "1e-6", "--integrator", "rA-half-1,rA-half-2"},
         "--atol; it is for ida-rp"},
        {{"run", "double_pendulum", "--rho-infinity", "0.8"}, "--rho-infinity; it is for rA-genalpha"},
        {{"run", "double_pendulum", "--reparametrise"}, "--reparametrise; it is for reps-half-1"},
        {{"run", "double_pendulum", "--max-iterations", "5", "--integrator", "ida-rp"},
         "no selected integrator uses --max-iterations"},
        {{"run", "double_pendulum", "--max-iterations", "0"}, "--max-iterations"},
        {{"study", "energy", "--rtol", "1e-6"}, "--rtol is for compare"},
        {{"study", "energy", "--atol", "1e-6"}, "--atol is for compare, stiffness, sweep, work-precision"},
        {{"study", "compare", "--rtol", "1e-6"}, "no selected integrator uses --rtol"},
        {{"study", "energy", "--integrator", "rA-half-1", "--rho-infinity", "0.5"}, "it is for rA-genalpha"},
        {{"study", "energy", "--seed", "0"}, "--seed is for scaling"},
        {{"study", "granular-brick", "--seed", "1"}, "--seed is for scaling"},
        {{"study", "friction", "--tolerance", "1e-8"}, "this study defines its own bodies"},
        {{"study", "contact-methods", "--steps", "1e-3"}, "--steps is for"},
        {{"study", "incline-sweep", "--integrator", "rA-half-1"}, "this study defines its own bodies"}};
    for (const auto& [arguments, expected] : refused) check_refused(in, arguments, 2, expected);
    const std::vector<std::vector<std::string>> accepted = {
        {"run", "double_pendulum", "--end", "0.01", "--rho-infinity", "0.8", "--integrator",
         "rA-half-1,rA-genalpha"},
        {"run", "double_pendulum", "--end", "0.01", "--rtol", "1e-6", "--integrator", "ida-rp"},
        {"run", "double_pendulum", "--end", "0.01", "--max-iterations", "10"},
        {"run", "double_pendulum", "--end", "0.01", "--reparametrise", "--integrator", "reps-half-1"},
        {"study", "compare", "--end", "0.1", "--rtol", "1e-6", "--integrator", "ida-rp,rA-half-1",
         "--no-plot"},
        {"study", "energy", "--end", "0.1", "--problem", "double_pendulum", "--rho-infinity", "0.5",
         "--no-plot"}};
    int k = 0;
    for (std::vector<std::string> arguments : accepted) {
        arguments.insert(arguments.end(), {"--quiet", "--output", "a" + std::to_string(k++)});
        const Ended ended = call(in, arguments);
        CAPTURE(arguments, ended.err);
        CHECK(ended.code == 0);
    }
}
