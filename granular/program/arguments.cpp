// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/program/arguments.hpp"

#include "granular/program/provenance.hpp"

#include <CLI/CLI.hpp>

#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>

namespace hilda::granular {

namespace {

/// The number that is all of the text
template <class Number>
std::optional<Number> number_in(std::string_view text)
{
    Number value = 0;
    const char* const end = text.data() + text.size();
    const auto [at, error] = std::from_chars(text.data(), end, value);
    return error == std::errc() && at == end ? std::optional(value) : std::nullopt;
}

std::optional<Device> device_of(const std::string& name)
{
    if (name == "cpu") return Device{};
    if (name == "cuda") return Device{.kind = Device::cuda};
    const auto number = number_in<int>(name.starts_with("cuda:") ? name.substr(5) : "");
    if (number && *number >= 0) return Device{.kind = Device::cuda, .number = *number};
    return {};
}

/// Refuses what is not so.
CLI::Validator must(const std::string& be, bool (*is)(const std::string&))
{
    return {[=](const std::string& text) { return is(text) ? "" : "must be " + be + ", got '" + text + "'"; },
            ""};
}

bool is_finite(const std::string& text)
{
    const auto value = number_in<double>(text);
    return value && std::isfinite(*value);
}

Setting setting_of(const std::string& text)
{
    const std::size_t equals = text.find('=');
    return {.pointer = text.substr(0, equals),
            .value = text.substr(equals + 1),
            .asked = "--set '" + text + '\''};
}

/// As a shell would take it again
std::string in_one_line(int argc, char** argv)
{
    std::string line;
    for (int k = 0; k < argc; ++k) {
        const std::string word = argv[k];
        const bool plain = !word.empty() && word.find_first_not_of(
                                                "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                                "0123456789_-+=/.,:@%") == std::string::npos;
        std::string quoted = word;
        if (!plain && k > 0) {  // the first may be "hilda granular"
            quoted = "'";
            for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
            quoted += '\'';
        }
        line += (k > 0 ? " " : "") + quoted;
    }
    return line;
}

}  // namespace

std::optional<int> read_arguments(int argc, char** argv, Options& o)
{
    const CLI::Validator positive = must("a positive, finite number", [](const std::string& s) {
        return is_finite(s) && *number_in<double>(s) > 0;
    });
    std::string threads, checkpoint, seed;
    std::vector<std::string> set;
    std::vector<std::pair<const char*, std::string>> entries = {{"step", ""}, {"end", ""}, {"every", ""}};

    CLI::App app("hilda-granular: a granular case");
    app.set_version_flag("--version", version_line());
    const auto value = [&](const char* name, const char* kind, std::string& to, const char* what) {
        return app.add_option(name, to, what)->type_name(kind);
    };
    app.add_option("CASE", o.file, "a case file in JSON, or the name of a validation")
        ->required()
        ->type_name("");
    value("--step", "H", entries[0].second, "step in s, by default the case's")->check(positive);
    value("--end", "T", entries[1].second, "end in s, by default the case's")->check(positive);
    value("--every", "DT", entries[2].second, "s between rows of run.csv, by default the case's, or end/1000")
        ->check(positive);
    app.add_option("--set", set, "change one entry of the case; repeatable")
        ->type_name("/json/pointer=VALUE")
        ->allow_extra_args(false)
        ->check(must("/json/pointer=VALUE, such as /laws/0/mu=0.5", [](const std::string& s) {
            return s.starts_with('/') && s.find('=') != std::string::npos;
        }));
    value("--seed", "N", seed,
          "of what is random in the first fill, the next has N + 1; by default the case's")
        ->check(must("a whole number from 0 to 2^53", [](const std::string& s) {
            const auto n = number_in<std::uint64_t>(s);
            return n && *n <= std::uint64_t{1} << 53;
        }));
    value("--output", "DIR", o.output, "by default out/ and the name of the file")
        ->check(must("a directory", [](const std::string& s) { return !s.empty(); }));
    app.add_flag("--force", o.force,
                 "writes into a directory that is not empty; takes a step at which contacts are not stable");
    app.add_flag("--resume", o.resume, "goes on from the last checkpoint in the directory");
    value("--checkpoint", "S", checkpoint, "wall seconds between checkpoints, by default 0: none")
        ->check(must("a finite number, not negative",
                     [](const std::string& s) { return is_finite(s) && *number_in<double>(s) >= 0; }));
    value("--threads", "N", threads, "of the CPU, by default 1; results are the same for any")
        ->check(must("a whole number from 1 to 1024", [](const std::string& s) {
            const auto n = number_in<int>(s);
            return n && *n >= 1 && *n <= 1024;
        }));
    value("--device", "cpu|cuda[:N]", o.device_name, "by default cpu")
        ->check(must("cpu, cuda or cuda:N", [](const std::string& s) { return device_of(s).has_value(); }));
    app.add_flag("--no-vtk", o.no_vtk, "writes no particles for ParaView");
    app.add_flag("--full", o.full, "all values of a validation, not only those that say most");
    app.add_flag("--json", o.json, "the summary as JSON on stdout, and nothing else there");
    app.add_flag("--quiet", o.quiet, "prints neither result nor warnings nor progress");
    app.add_flag("-v,--verbose", o.verbose, "says what is done");
    app.footer(
        "Exit codes: 0 done, 1 internal error, 2 wrong command line, 3 invalid case, 4 numerical failure,\n"
        "5 input/output, 7 device not available, 130/143 interrupted.");
    try {
        app.parse(argc, argv);
        if (o.force && o.resume) throw CLI::ValidationError("--force and --resume exclude each other");
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0) return app.exit(e);
        std::fprintf(stderr, "hilda: error: granular: %s\n", e.what());
        return usage;
    }
    const std::set<std::string> of_all = {"CASE", "--threads", "--device", "--full", "--quiet", "--verbose"};
    for (const CLI::Option* option : app.get_options())
        if (option->count() > 0 && !of_all.contains(option->get_name()) && o.for_cases.empty())
            o.for_cases = option->get_name();
    for (const std::string& s : set) o.settings.push_back(setting_of(s));
    for (const auto& [key, given] : entries)
        if (!given.empty())
            o.settings.push_back({.pointer = std::string("/") + key,
                                  .value = CaseText::Json(*number_in<double>(given)).dump(),
                                  .asked = std::string("--") + key + ' ' + given});
    if (!seed.empty()) o.seed = number_in<std::uint64_t>(seed);
    if (!threads.empty()) o.threads = *number_in<int>(threads);
    if (!checkpoint.empty()) o.checkpoint = *number_in<double>(checkpoint);
    o.device = *device_of(o.device_name);
    if (o.output.empty()) o.output = "out/" + std::filesystem::path(o.file).stem().string();
    o.command_line = in_one_line(argc, argv);
    return {};
}

}  // namespace hilda::granular
