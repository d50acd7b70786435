// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/study_context.hpp"

#include "dae/model_file.hpp"
#include "io/error.hpp"
#include "io/files.hpp"
#include "io/message.hpp"
#include "io/nearest.hpp"
#include "io/program.hpp"
#include "io/provenance.hpp"
#include "run/figures.hpp"
#include "run/named_model.hpp"
#include "run/provenance.hpp"
#include "run/recording/setting_options.hpp"
#include "studies/framework/latex.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>

namespace hilda::studies {

namespace {

template <class Value>
std::string joined(const std::vector<Value>& list)
{
    return fmt::format("{}", fmt::join(list, "\n"));
}
template <class Value>
std::string text_of(const std::optional<Value>& value)
{
    return value ? fmt::format("{}", *value) : "";
}

/// The options on which the rows of a study depend, with the contents of its files
run::FinishedJobs::Identity identity(const std::string& study, const StudyOptions& o)
{
    run::FinishedJobs::Identity all = {{"study", study},
                                       {"version of the program", run::version_line()},
                                       {"--problem", joined(o.problems)},
                                       {"--integrator", joined(o.integrators)},
                                       {"--steps", joined(o.steps)},
                                       {"--rtols", joined(o.rtols)},
                                       {"--bars", joined(o.bars)},
                                       {"--end", text_of(o.end)},
                                       {"--set", joined(o.set)},
                                       {"--fix-initial", o.fix_initial ? "yes" : "no"},
                                       {"--sweep", joined(o.sweep)},
                                       {"--observable", o.observable},
                                       {"--keep", o.keep ? "yes" : "no"},
                                       {"--format", o.format},
                                       {"--reference", o.reference},
                                       {"--reference-step", text_of(o.reference_step)},
                                       {"--reference-rtol", text_of(o.reference_rtol)},
                                       {"--preset", o.preset},
                                       {"--normal-rows", o.normal_rows},
                                       {"--grid", o.grid},
                                       {"--vtk", std::to_string(o.vtk)},
                                       {"--repeats", std::to_string(o.repeats)},
                                       {"--seed", std::to_string(o.seed.value_or(0))},
                                       {"--check", o.check ? "yes" : "no"},
                                       {"--all", o.all ? "yes" : "no"},
                                       {"--shard", o.shard.is_part() ? o.shard.text() : ""},
                                       {"plug-ins (--load)", o.plugins.empty() ? "none" : joined(o.plugins)}};
    for (const run::SettingOption& setting : run::setting_options())
        all[setting.name] = io::written(setting.get(o.settings));
    constexpr size_t most = 64 << 20;  // as for a model file
    std::error_code error;             // of names that the file system does not accept
    for (const std::string& problem : o.problems)
        if (run::is_model_path(problem) && std::filesystem::is_regular_file(problem, error)) {
            std::string text = io::read_file(problem, most);
            try {  // the canonical form contains the meshes that the model names
                text += run::named_model(problem, o.set, "").text;
            } catch (const io::InvalidInput&) {
                // reported when the study reads the model
            }
            all["content of " + problem] = std::to_string(io::checksum(text.data(), text.size()));
        }
    return all;
}

/// The words of the command line for hilda collect; empty if there is no shard
std::string command_of(const StudyOptions& o)
{
    std::string all;
    if (o.shard.is_part())
        for (const std::string& word : o.arguments) all += word + '\0';
    return all;
}

}  // namespace

StudyContext::StudyContext(const Study& study, const StudyOptions& options, const run::JobRecords* collected)
    : name(study.name), keys(study.keys), options(options), answers(study.answers)
{
    for (const Expectation& e : options.expect) {
        if (std::find(keys.begin(), keys.end(), e.key) != keys.end()) continue;
        if (keys.empty()) refuse("--expect is not an option of this study");
        std::string all;
        for (const std::string& key : keys) all += (all.empty() ? "" : ", ") + key;
        refuse("--expect: unknown key" + io::with_nearest(e.key, keys) + "; known keys: " + all);
    }
    if (options.vtk > 0 && options.output.empty())
        refuse("--vtk writes files: with --json it needs --output");
    if (collected != nullptr)
        finished = std::make_unique<run::FinishedJobs>(*collected, identity(name, options));
    else if (!options.output.empty())
        finished = std::make_unique<run::FinishedJobs>(options.output, identity(name, options),
                                                       options.resume, command_of(options));
    sharing = std::make_unique<run::JobSharing>(
        run::JobSharing{.finished = finished.get(), .shard = options.shard});
    if (options.resume && !options.quiet && collected == nullptr)
        io::message(fmt::format(
            "hilda: {} read from {}\n",
            io::counted(static_cast<long>(finished->count()), "finished job is", "finished jobs are"),
            options.output));
}

void StudyContext::refuse(const std::string& what) const
{
    throw io::UsageError("study " + name + ": " + what);
}

Schemes StudyContext::schemes(const std::vector<std::string>& defaults) const
{
    Schemes selected;
    for (const std::string& scheme : options.integrators) selected.push_back(&lie::scheme(scheme));
    if (selected.empty()) {
        for (const std::string& scheme : defaults)
            for (const lie::Scheme& s : lie::schemes())
                if (s.name == scheme) selected.push_back(&s);
        if (defaults.empty())
            for (const lie::Scheme& s : lie::schemes()) selected.push_back(&s);
    }
    for (const lie::Scheme*& scheme : selected)
        for (const std::string& option : options.given_settings)
            if (!scheme->uses_option(option) && scheme->with_adaptive_steps().uses_option(option))
                scheme = &scheme->with_adaptive_steps();
    Schemes users = selected;
    if (!options.reference.empty()) users.push_back(&lie::scheme(options.reference).with_adaptive_steps());
    run::refuse_unused_settings("study " + name, options.given_settings, users);
    return selected;
}

Schemes StudyContext::fixed_step_schemes(const std::vector<std::string>& defaults) const
{
    Schemes fixed;
    for (const lie::Scheme* s : schemes(defaults)) {
        if (!s->adaptive)
            fixed.push_back(s);
        else if (!options.integrators.empty())
            refuse(s->name +
                   " chooses its own steps by --rtol and --atol; hilda study "
                   "work-precision compares it with the others");
    }
    return fixed;
}

std::vector<double> StudyContext::steps(const std::vector<double>& defaults) const
{
    std::vector<double> all = options.steps.empty() ? defaults : options.steps;
    std::sort(all.rbegin(), all.rend());
    return all;
}

double StudyContext::one_step(double defaults) const
{
    if (options.steps.size() > 1)
        refuse("--steps takes one step, got " + std::to_string(options.steps.size()));
    return options.steps.empty() ? defaults : options.steps.front();
}

std::vector<Benchmark> StudyContext::benchmarks(const std::vector<std::string>& defaults,
                                                const std::vector<double>& steps, const DefaultEnd& end) const
{
    std::vector<Benchmark> all = studies::benchmarks(name, options, defaults, end);
    for (const Benchmark& c : all) check_steps(name, c, steps);
    return all;
}

run::Pool StudyContext::pool(size_t jobs, const std::string& label, int threads) const
{
    return {threads > 0 ? threads : options.jobs, options.quiet ? "" : name + label, static_cast<long>(jobs),
            sharing.get()};
}

void StudyContext::job(const std::function<void()>& job,
                       const std::function<void(io::Archive&)>& transfer) const
{
    run::JobSharing here{.finished = finished.get()};
    run::Pool(1, "", 1, &here).run([&](long) { job(); }, [&](io::Archive& a, long) { transfer(a); });
}

void StudyContext::jobs(long count, const std::function<void(long)>& job,
                        const run::Pool::Transfer& transfer) const
{
    run::Pool(1, "", count, sharing.get()).run(job, transfer);
}

void StudyContext::evaluate(const std::vector<Criterion>& criteria)
{
    if (criteria.empty())
        io::message("hilda: warning: --check: there is no criterion for these problems and integrators\n");
    criteria_passed = studies::evaluate(criteria, text, json);
}

io::Json StudyContext::measure(const std::string& of,
                               const std::vector<std::pair<std::string, double>>& values)
{
    Measured& m = measured.emplace_back(Measured{.of = of, .value = {}});
    io::Json object = io::Json::object();
    for (const auto& [key, value] : values) m.value[key] = value, object[key] = value;
    return object;
}

void StudyContext::end_of_runs(const std::vector<const Run*>& runs)
{
    failed_runs = failures(runs);
    for (const Run* run : runs)
        if (const size_t end = run->findings.find(": "); end != std::string::npos)
            warned(run->findings.substr(0, end),
                   run->name() + run->findings.substr(end, run->findings.find('\n') - end));
    const auto has_failed = [](const Run* run) { return run->failed(); };
    const auto failed = static_cast<size_t>(std::count_if(runs.begin(), runs.end(), has_failed));
    if (failed == 0 || (failed < runs.size() && !every_run_must_succeed)) return;
    const Run& first = **std::find_if(runs.begin(), runs.end(), has_failed);
    const std::string all = io::counted(static_cast<long>(runs.size()), "run");
    numerical_failure = fmt::format("hilda: error[{}]: study {}: {} failed; {}: {}\n", first.status, name,
                                    runs.size() == 1       ? "its run"
                                    : failed < runs.size() ? fmt::format("{} of {}", failed, all)
                                                           : "all " + all,
                                    first.name(), first.message);
}

void StudyContext::warned(const std::string& warning, const std::string& text)
{
    if (options.strict && numerical_failure.empty())
        numerical_failure =
            fmt::format("hilda: error[{}]: study {}: {} (a warning, with --strict)\n", warning, name, text);
}

io::Json StudyContext::whole() const
{
    io::Json all = {{"study", name},
                    {"tolerance", options.settings.tolerance},
                    {"settings", run::settings_json(options.settings)},
                    {"seed", options.seed.value_or(0)},
                    {"set", options.set},
                    {"provenance", run::provenance(options.command_line, options.jobs)}};
    std::vector<std::string> models;
    for (const std::string& problem : options.problems)
        if (run::is_model_path(problem)) models.push_back(problem);
    all["provenance"]["inputs"] = io::inputs(models);
    if (options.fix_initial) all["fix_initial"] = true;
    if (options.repeats > 0) all["repeats"] = options.repeats;
    all.update(json);
    return all;
}

/// The tables of the text, to be read by the command input of a LaTeX document
std::string StudyContext::latex_tables() const
{
    std::string command = options.command_line;
    std::replace_if(
        command.begin(), command.end(), [](unsigned char c) { return c < ' '; }, ' ');
    std::string out = "% " + command + "\n% needs \\usepackage{booktabs}\n";
    for (size_t k = 0; k < text.tables.size(); ++k) {
        const StudyText::PrintedTable& table = text.tables[k];
        std::string caption = answers + (table.title.empty() ? "" : ". ");
        caption.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(caption.front())));
        for (const char c : table.title) caption += c == '\n' ? std::string("; ") : std::string(1, c);
        out += '\n' + latex_table(table.rows, caption, fmt::format("{}-{}", name, k + 1));
    }
    return out;
}

void StudyContext::write(const io::Json& whole_json) const
{
    const std::string in = options.output + "/";
    std::vector<std::string> written = {"study.csv", "study.json"};
    io::write_file(in + "study.csv", table);
    io::write_file(in + "study.json", whole_json.text());
    if (options.latex) {
        io::write_file(in + "study.tex", latex_tables());
        written.emplace_back("study.tex");
    } else {
        std::error_code error;
        std::filesystem::remove(in + "study.tex", error);  // that of an earlier run
    }
    for (const auto& [file, content] : files) {
        io::write_file(in + file, content);
        written.push_back(file);
    }
    for (const std::string& figure : figures)
        run::remove_figure(options.output, figure);  // those of an earlier run
    if (options.plot && options.draw &&
        !options.draw(name + ".py", options.output, options.figure_formats).empty())
        for (const std::string& figure : figures)
            for (const std::string& file :
                 run::existing_figures(options.output, figure, options.figure_formats))
                written.push_back(file);
    if (options.json || options.quiet) return;
    std::cout << "\nwritten to " << options.output << ":";
    for (const std::string& file : written) std::cout << ' ' << file;
    std::cout << '\n';
}

/// Compares all expectations with all measured values of their keys. Prints a line on stderr for each
/// difference above the tolerance and for each key that was not measured.
bool StudyContext::as_expected() const
{
    bool passed = true;
    const auto fails = [&](const std::string& message) {
        passed = false;
        io::message("hilda: error: expected " + message + "\n");
    };
    for (const Expectation& e : options.expect) {
        bool seen = false;
        for (const Measured& m : measured) {
            const auto found = m.value.find(e.key);
            if (found == m.value.end()) continue;
            seen = true;
            if (!(std::abs(found->second - e.value) <= e.tolerance))
                fails(fmt::format("{}, got {:.6g} for {}", e.text, found->second, m.of));
        }
        if (!seen) fails(fmt::format("{}, but no run has a value of '{}'", e.text, e.key));
    }
    return passed;
}

int StudyContext::finish()
{
    const io::Json all = whole();
    if (options.json)
        std::cout << all.text();
    else if (!options.quiet)
        std::cout << text.str() << failed_runs;
    if (!options.output.empty()) write(all);
    if (finished) {
        io::EndOnSignal::ignore();  // the results are complete, there is nothing left to resume
        finished->remove();
    }
    if (!numerical_failure.empty()) {
        io::message(numerical_failure);
        return io::exit_code::numerical_failure;
    }
    const bool passed = as_expected() && (criteria_passed || !options.check);
    return passed ? io::exit_code::done : io::exit_code::expectation_failed;
}

int StudyContext::finish_shard()
{
    finished->end_shard();
    if (!options.quiet)
        std::cout << fmt::format(
            "shard {} of study {} is complete: {}\nhilda collect, with the folders of all {} shards, writes "
            "the results\n",
            options.shard.text(), name, run::FinishedJobs::shard_file(options.output), options.shard.count);
    return io::exit_code::done;
}

void check_parts(const StudyContext& study, const std::string& what, const std::vector<std::string>& known)
{
    for (const std::string& name : study.options.problems)
        if (std::find(known.begin(), known.end(), name) == known.end())
            study.refuse("unknown " + what + io::with_nearest(name, known));
}

}  // namespace hilda::studies
