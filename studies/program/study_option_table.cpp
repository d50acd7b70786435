// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/study_option_table.hpp"

#include "dae/model_file.hpp"
#include "io/archive.hpp"
#include "io/error.hpp"
#include "io/files.hpp"
#include "io/json_source.hpp"
#include "lie/schemes.hpp"
#include "run/named_model.hpp"
#include "run/provenance.hpp"
#include "run/recording/setting_options.hpp"
#include "run/tables/run_table.hpp"
#include "studies/framework/study.hpp"
#include "studies/program/arguments.hpp"
#include "studies/program/command_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

namespace hilda::studies {

namespace {

using Text = const std::string&;
using io::Scope;

// Values in the identity of jobs
std::string identity_text(const std::string& value) { return value; }
std::string identity_text(std::same_as<bool> auto value) { return value ? "yes" : "no"; }
std::string identity_text(std::integral auto value) requires(!std::same_as<decltype(value), bool>)
{
    return std::to_string(value);
}
std::string identity_text(const run::Shard& value) { return value.is_part() ? value.text() : ""; }
template <class Value>
std::string identity_text(const std::optional<Value>& value)
{
    return value ? fmt::format("{}", *value) : "";
}
template <class Value>
std::string identity_text(const std::vector<Value>& value) requires(fmt::is_formattable<Value>::value)
{
    return fmt::format("{}", fmt::join(value, "\n"));
}

template <class Value>
Value& member_of(StudyArguments& of, Value StudyOptions::*member)
{
    return of.options.*member;
}
template <class Value>
Value& member_of(StudyArguments& of, Value StudyArguments::*member)
{
    return of.*member;
}

/// An option whose texts store(member, option, text) stores
template <class Owner, class Value, class Store>
StudyOption option_of(io::Option option, Value Owner::*member, bool repeatable, Store store)
{
    const std::string name = option.name;
    const auto read = [member, store](StudyArguments& to, Text given, Text text) {
        store(member_of(to, member), given, text);
    };
    StudyOption all{std::move(option), name, repeatable, read, {}};
    if constexpr (std::same_as<Owner, StudyOptions>)
        if constexpr (requires(const StudyOptions& o) { identity_text(o.*member); })
            all.identity = [member](const StudyOptions& o) { return identity_text(o.*member); };
    return all;
}

/// An option with one value
template <class Member, class Read>
StudyOption one(io::Option option, Member member, Read read)
{
    return option_of(std::move(option), member, false,
                     [read](auto& to, Text name, Text text) { to = read(name, text); });
}
/// A repeatable option whose value is an element of a list, and one whose value is a list
template <class Member, class Read>
StudyOption each(io::Option option, Member member, Read read)
{
    return option_of(std::move(option), member, true,
                     [read](auto& to, Text name, Text text) { to.push_back(read(name, text)); });
}
template <class Member, class Read>
StudyOption lists(io::Option option, Member member, Read read)
{
    return option_of(std::move(option), member, true, [read](auto& to, Text name, Text text) {
        for (auto& element : read(name, text)) to.push_back(std::move(element));
    });
}
/// A switch
template <class Member>
StudyOption flag(io::Option option, Member member, bool value = true)
{
    return option_of(std::move(option), member, false, [value](auto& to, Text, Text) { to = value; });
}

StudyOption with(const std::string& leader, StudyOption option)
{
    option.with = leader;
    return option;
}
StudyOption of_all(StudyOption option) { return with("", std::move(option)); }

/// An option of lie::Settings. A study with --integrator has it, unless it is of adaptive steps.
StudyOption setting_option(const run::SettingOption& setting)
{
    const auto read = [set = setting.set](StudyArguments& to, Text option, Text text) {
        set(to.options.settings, option, text);
    };
    const auto identity = [get = setting.get](const StudyOptions& o) { return io::written(get(o.settings)); };
    const std::vector<lie::Scheme>& schemes = lie::schemes();
    const bool is_adaptive = std::none_of(schemes.begin(), schemes.end(), [&](const lie::Scheme& scheme) {
        return !scheme.adaptive && scheme.uses_option(setting.name);
    });
    return {static_cast<const io::Option&>(setting), is_adaptive ? setting.name : "--integrator", false, read,
            identity};
}

/// Models, integrators, steps and parameters of a model
std::vector<StudyOption> options_of_selection()
{
    using O = StudyOptions;
    constexpr Scope numerical = Scope::numerical;
    return {
        lists(
            {.name = "--problem",
             .value = "NAME[,NAME...]",
             .help = "built-in models or model files, or the cases of the study; default: those of the study",
             .scope = numerical},
            &O::problems, list),
        lists({.name = "--integrator",
               .value = "NAME[,NAME...]",
               .help = "integrators; default: those of the study",
               .scope = numerical},
              &O::integrators, integrators),
        one({.name = "--steps",
             .value = "H1,H2,...",
             .help = "step sizes [s]; default: those of the study",
             .scope = numerical},
            &O::steps, steps),
        one({.name = "--rtols",
             .value = "R1,R2,...",
             .help = "relative tolerances of integrators with adaptive steps; default: those of the study",
             .scope = numerical},
            &O::rtols, relative_tolerances),
        one({.name = "--bars",
             .value = "N1,N2,...",
             .help = "numbers of bars of the chains of study scaling; default: 1,2,4,...,1024",
             .scope = numerical},
            &O::bars, bars),
        one({.name = "--end",
             .value = "T",
             .help = "end time [s]; default: that of the study or of the model",
             .scope = numerical},
            &O::end, positive_number),
        with("--integrator", each({.name = "--set",
                                   .value = "/json/pointer=VALUE",
                                   .help = help_of_set("each model"),
                                   .scope = numerical},
                                  &O::set, setting)),
        each({.name = "--sweep",
              .value = "/json/pointer=VALUES",
              .help =
                  "values of an entry of the model of study sweep: V1,V2,..., or A:B:N for N numbers from A "
                  "to B, or A:B:N:log; repeatable, for all combinations",
              .scope = numerical},
             &O::sweep, unchanged),
        with("--sweep",
             one({.name = "--observable",
                  .value = "COLUMN",
                  .help =
                      "quantity that study sweep tabulates and draws: a column of hilda help outputs, such "
                      "as BODY.rz; default: that of the model",
                  .scope = numerical},
                 &O::observable, unchanged)),
        with("--sweep", flag({.name = "--keep",
                              .help = "write the motion of each run of study sweep to runs/NUMBER as well",
                              .scope = numerical},
                             &O::keep)),
        with("--sweep",
             one({.name = "--format",
                  .value = "csv|hdf5",
                  .help = "format of the motions of --keep: trajectory.csv, or run.h5; default: csv",
                  .scope = numerical},
                 &O::format, run::table_format)),
        with("--integrator",
             flag({.name = "--fix-initial", .help = help_of_fix_initial(""), .scope = numerical},
                  &O::fix_initial)),
        with(
            "--problem",
            flag({.name = "--allow-paths", .help = help_of_allow_paths("a model file"), .scope = Scope::none},
                 &O::allow_paths))};
}

/// Reference solution, parameters of experiments, criteria and the output directory
std::vector<StudyOption> options_of_experiment()
{
    using O = StudyOptions;
    constexpr Scope numerical = Scope::numerical;
    return {
        of_all(one({.name = "--output",
                    .value = "DIR",
                    .help = help_of_output("--force or --resume", "out/KIND"),
                    .scope = Scope::none},
                   &O::output, io::path)),
        of_all(flag({.name = "--resume",
                     .help = "continue the interrupted study in the output directory; its finished runs are "
                             "not computed again",
                     .scope = Scope::none},
                    &O::resume)),
        one({.name = "--reference",
             .value = "NAME",
             .help = "integrator of the reference solution; default: the reference solution of each problem",
             .scope = numerical},
            &O::reference, integrator),
        with(
            "--reference",
            one({.name = "--reference-step",
                 .value = "H",
                 .help = "step of the reference integrator [s]; default: a tenth of the smallest step of the "
                         "study",
                 .scope = numerical},
                &O::reference_step, positive_number)),
        with("--reference",
             one({.name = "--reference-rtol",
                  .value = "R",
                  .help = "relative tolerance of a reference integrator with adaptive steps; default: 1e-12",
                  .scope = numerical},
                 &O::reference_rtol, relative_tolerance)),
        one({.name = "--preset",
             .value = "balanced|dissertation",
             .help = "parameter set of the friction law; default: that of the study",
             .scope = numerical},
            &O::preset, preset),
        one({.name = "--normal-rows",
             .value = "tangent|fixed-xy",
             .help = help_of_normal_rows("tangent"),
             .scope = numerical},
            &O::normal_rows, normal_rows),
        flag({.name = "--all",
              .help =
                  "study convergence with every problem, integrator and step instead of the short selection",
              .scope = numerical},
             &O::all),
        flag({.name = "--check",
              .help = "evaluate all acceptance criteria of the study; exit code 6 if one fails",
              .scope = numerical},
             &O::check),
        flag(
            {.name = "--strict",
             .help = "exit code 4, after the results are written, if a run has a warning about its solution"},
            &O::strict),
        one({.name = "--against", .value = "FILE", .help = "CSV table to compare the result with"},
            &O::against, io::path),
        one({.name = "--grid",
             .value = "NAME",
             .help = "parameter grid of a sweep; default: the finest",
             .scope = numerical},
            &O::grid, unchanged),
        one({.name = "--vtk",
             .value = "N",
             .help = "number of ParaView frames of each run; default: no frames",
             .scope = numerical},
            &O::vtk, frames),
        one({.name = "--repeats",
             .value = "N",
             .help = "repetitions of each time measurement; default: 5",
             .scope = numerical},
            &O::repeats, positive_count),
        one({.name = "--seed",
             .value = "N",
             .help = "seed of random initial velocities; default: 0",
             .scope = numerical},
            &O::seed, io::seed),
        of_all(flag({.name = "--force",
                     .help = "overwrite an output directory that is not empty",
                     .scope = Scope::none},
                    &O::force)),
        with(
            "--reference",
            flag({.name = "--accept-reference",
                  .help =
                      "accept a reference solution that is coarser than the runs, or whose step is above the "
                      "stability limit of a force",
                  .scope = Scope::none},
                 &O::accept_reference)),
        of_all(one({.name = "--jobs",
                    .value = "N",
                    .help = "number of concurrent runs; default: the number of cores, or 1 in a study that "
                            "measures time",
                    .scope = Scope::none},
                   &O::jobs, positive_count)),
        one({.name = "--shard",
             .value = "I/N",
             .help =
                 "compute part I of N of the runs, for a job array; hilda collect then writes the results "
                 "of all parts",
             .scope = numerical},
            &O::shard, shard)};
}

/// What is printed, written and drawn
std::vector<StudyOption> options_of_results()
{
    using A = StudyArguments;
    return {
        each({.name = "--expect",
              .value = "KEY=VALUE[+-TOL]",
              .help = "expected value of a result; exit code 6 if the result differs by more than TOL; "
                      "repeatable"},
             &StudyOptions::expect, expectation),
        flag({.name = "--no-plot", .help = "draw no figures"}, &A::plot, false),
        one({.name = "--figure-format", .value = "F[,F...]", .help = help_of_figure_format()},
            &A::figure_formats, formats_of_figures),
        flag({.name = "--latex",
              .help = "write study.tex as well: the tables of the text for LaTeX, with the package booktabs"},
             &A::latex),
        flag({.name = "--quiet", .help = "print no result, no warnings and no progress"},
             &StudyOptions::quiet),
        flag({.name = "--json", .help = "print the result as JSON on stdout; write files only with --output"},
             &A::json)};
}

}  // namespace

bool StudyOption::is_of(const Study& study) const { return with.empty() || study.lists(with); }

std::vector<StudyOption> study_options()
{
    std::vector<StudyOption> all = options_of_selection();
    for (const run::SettingOption& setting : run::setting_options()) all.push_back(setting_option(setting));
    for (StudyOption& option : options_of_experiment()) all.push_back(std::move(option));
    for (StudyOption& option : options_of_results()) all.push_back(of_all(std::move(option)));
    return all;
}

void refuse_options_of_others(const Study& study, const StudyOptions& options)
{
    for (const StudyOption& option : study_options()) {
        if (std::find(options.given.begin(), options.given.end(), option.name) == options.given.end() ||
            option.is_of(study))
            continue;
        const bool has_models = study.lists("--integrator");
        // the study itself refuses with the option to use instead
        if (option.name == "--problem" && has_models) continue;
        const bool is_of_models = option.with == "--integrator" || option.name == "--problem";
        std::string those;
        for (const Study& other : studies())
            if (option.is_of(other)) those += (those.empty() ? "" : ", ") + other.name;
        throw io::UsageError("study " + study.name + ": " + option.name + " is for " +
                             (is_of_models && !has_models
                                  ? "studies of models; this study defines its own bodies"
                                  : (those.empty() ? "other studies" : those)));
    }
}

run::FinishedJobs::Identity identity_of_jobs(const Study& study, const StudyArguments& arguments)
{
    const StudyOptions& o = arguments.options;
    run::FinishedJobs::Identity all = {
        {"study", study.name},
        {"version of the program", run::version_line()},
        {"plug-ins (--load)", arguments.plugins.empty() ? "none" : identity_text(arguments.plugins)}};
    for (const StudyOption& option : study_options())
        if (option.scope == Scope::numerical) all[option.name] = option.identity(o);
    constexpr size_t most = 64 << 20;  // as for a model file
    std::error_code error;             // of names that the file system does not accept
    for (const std::string& problem : o.problems)
        if (run::is_model_path(problem) && std::filesystem::is_regular_file(problem, error)) {
            std::string text = io::read_file(problem, most);
            try {  // the canonical form contains the meshes that the model names
                text += run::named_model(problem, o.set, "", o.allow_paths).text;
            } catch (const io::InvalidInput&) {
                // reported when the study reads the model
            }
            all["content of " + problem] = std::to_string(io::checksum(text.data(), text.size()));
        }
    return all;
}

}  // namespace hilda::studies
