// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/program/arguments.hpp"

#include "granular/program/provenance.hpp"
#include "io/error.hpp"
#include "io/message.hpp"
#include "io/provenance.hpp"

#include <CLI/CLI.hpp>

#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>

namespace hilda::granular {

namespace {

/// The number, if the whole text is one
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

/// Validator with the message "must be BE, got 'TEXT'"
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
            .origin = "--set '" + text + '\''};
}

}  // namespace

std::optional<int> read_arguments(int argc, char** argv, Options& o)
{
    const CLI::Validator positive = must("a positive, finite number", [](const std::string& s) {
        return is_finite(s) && *number_in<double>(s) > 0;
    });
    std::string threads, checkpoint, seed, every;
    std::vector<std::string> set;
    std::vector<std::pair<const char*, std::string>> entries = {{"step", ""}, {"end", ""}, {"interval", ""}};

    CLI::App app("hilda-granular: runs a granular case or a validation");
    app.set_version_flag("--version", version_line());
    const auto value = [&](const char* name, const char* kind, std::string& to, const char* what) {
        return app.add_option(name, to, what)->type_name(kind);
    };
    app.add_option("CASE", o.file, "case file (JSON), or name of a validation")->required()->type_name("");
    value("--step", "H", entries[0].second, "time step [s]; default: that of the case")->check(positive);
    value("--end", "T", entries[1].second, "end time [s]; default: that of the case")->check(positive);
    value("--interval", "DT", entries[2].second,
          "time between rows of run.csv [s]; default: that of the case, or end/1000")
        ->check(positive);
    value("--every", "DT", every, "old name of --interval")->group("");  // not in the help
    app.add_option("--set", set, "change one entry of the case, for example /laws/0/mu=0.5; repeatable")
        ->type_name("/json/pointer=VALUE")
        ->allow_extra_args(false)
        ->check(must("/json/pointer=VALUE, such as /laws/0/mu=0.5", [](const std::string& s) {
            return s.starts_with('/') && s.find('=') != std::string::npos;
        }));
    value(
        "--seed", "N", seed,
        "seeds of the random numbers of the fills: N, N + 1, ... in their order; default: those of the case")
        ->check(must("a whole number from 0 to 2^53", [](const std::string& s) {
            const auto n = number_in<std::uint64_t>(s);
            return n && *n <= std::uint64_t{1} << 53;
        }));
    value(
        "--output", "DIR", o.output,
        "output directory, new or empty unless --force or --resume is given; default: out/NAME for NAME.json")
        ->check(must("a directory", [](const std::string& s) { return !s.empty(); }));
    app.add_flag("--force", o.force,
                 "overwrite an output directory that is not empty; accept a step above the stability limit");
    app.add_flag("--resume", o.resume, "continue the run in the output directory from its last checkpoint");
    value("--checkpoint", "S", checkpoint, "wall time between checkpoints [s]; default: 0, no checkpoints")
        ->check(must("a finite number, not negative",
                     [](const std::string& s) { return is_finite(s) && *number_in<double>(s) >= 0; }));
    value("--threads", "N", threads, "number of CPU threads, without influence on the results; default: 1")
        ->check(must("a whole number from 1 to 1024", [](const std::string& s) {
            const auto n = number_in<int>(s);
            return n && *n >= 1 && *n <= 1024;
        }));
    value("--device", "cpu|cuda[:N]", o.device_name,
          "device: the CPU, or the GPU with number N; default: cpu")
        ->check(must("cpu, cuda or cuda:N", [](const std::string& s) { return device_of(s).has_value(); }));
    app.add_flag("--no-vtk", o.no_vtk, "write no frames for ParaView");
    app.add_flag("--full", o.full, "run a validation with all parameter values of the dissertation");
    app.add_flag("--json", o.json, "print the summary as JSON on stdout, and nothing else");
    app.add_flag("--quiet", o.quiet, "print no result, no warnings and no progress");
    app.add_flag("-v,--verbose", o.verbose, "report steps, checkpoints and resumption on stderr");
    app.footer(
        "Exit codes: 0 done, 1 internal error, 2 wrong command line, 3 invalid case, 4 numerical failure,\n"
        "5 input/output, 6 a check of a validation failed, 7 device not available, 130/143 interrupted.");
    try {
        app.parse(argc, argv);
        if (o.force && o.resume) throw CLI::ValidationError("--force and --resume exclude each other");
        if (const std::string error = every.empty() ? "" : positive(every); !error.empty())
            throw CLI::ValidationError("--every", error);
        if (!every.empty() && !entries[2].second.empty())
            throw CLI::ValidationError("--every is the old name of --interval; give only one of them");
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0) return app.exit(e);
        return io::report(io::UsageError(std::string("granular: ") + e.what()));
    }
    if (!every.empty()) {
        entries[2].second = every;  // the origin in messages is then --interval
        if (!o.quiet) io::warning("--every was renamed to --interval; the old name is still read");
    }
    const std::set<std::string> of_all = {"CASE", "--threads", "--device", "--full", "--quiet", "--verbose"};
    for (const CLI::Option* option : app.get_options())
        if (option->count() > 0 && !of_all.contains(option->get_name()) && o.case_only_option.empty())
            o.case_only_option = option->get_name();
    if (!every.empty())
        o.case_only_option = "--every";  // CLI11 gives no name for options that are not in the help
    for (const std::string& s : set) o.settings.push_back(setting_of(s));
    for (const auto& [key, given] : entries)
        if (!given.empty())
            o.settings.push_back({.pointer = std::string("/") + key,
                                  .value = CaseText::Json(*number_in<double>(given)).dump(),
                                  .origin = std::string("--") + key + ' ' + given});
    if (!seed.empty()) o.seed = number_in<std::uint64_t>(seed);
    if (!threads.empty()) o.threads = *number_in<int>(threads);
    if (!checkpoint.empty()) o.checkpoint = *number_in<double>(checkpoint);
    o.device = *device_of(o.device_name);
    if (o.output.empty()) o.output = "out/" + std::filesystem::path(o.file).stem().string();
    o.command_line = argv[0];  // may be "hilda granular"
    if (argc > 1) o.command_line += ' ' + io::shell_quoted(argc - 1, argv + 1);
    return {};
}

}  // namespace hilda::granular
