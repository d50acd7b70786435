// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/study_results.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/message.hpp"
#include "io/program.hpp"
#include "io/provenance.hpp"
#include "run/figures.hpp"
#include "run/named_model.hpp"
#include "run/provenance.hpp"
#include "run/recording/setting_options.hpp"
#include "studies/framework/latex.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>

namespace hilda::studies {

namespace {

/// The contents of study.json
io::Json whole(const StudyContext& results, const StudyArguments& arguments)
{
    const StudyOptions& options = arguments.options;
    io::Json all = {{"study", results.name},
                    {"tolerance", options.settings.tolerance},
                    {"settings", run::settings_json(options.settings)},
                    {"seed", options.seed},
                    {"set", options.set},
                    {"provenance", run::provenance(arguments.command_line, options.jobs)}};
    std::vector<std::string> models;
    for (const std::string& problem : options.problems)
        if (run::is_model_path(problem)) models.push_back(problem);
    all["provenance"]["inputs"] = io::inputs(models);
    if (options.fix_initial) all["fix_initial"] = true;
    if (options.repeats > 0) all["repeats"] = options.repeats;
    all.update(results.json);
    return all;
}

/// The tables of the text, to be read by the command input of a LaTeX document
std::string latex_tables(const Study& study, const StudyContext& results, std::string command)
{
    std::replace_if(
        command.begin(), command.end(), [](unsigned char c) { return c < ' '; }, ' ');
    std::string out = "% " + command + "\n% needs \\usepackage{booktabs}\n";
    for (size_t k = 0; k < results.text.tables.size(); ++k) {
        const StudyText::PrintedTable& table = results.text.tables[k];
        std::string caption = study.answers + (table.title.empty() ? "" : ". ");
        caption.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(caption.front())));
        for (const char c : table.title) caption += c == '\n' ? std::string("; ") : std::string(1, c);
        out += '\n' + latex_table(table.rows, caption, fmt::format("{}-{}", study.name, k + 1));
    }
    return out;
}

void write(const Study& study, const StudyContext& results, const StudyArguments& arguments,
           const io::Json& whole_json)
{
    const std::string& output = arguments.options.output;
    const std::string in = output + "/";
    std::vector<std::string> written = {"study.csv", "study.json"};
    io::write_file(in + "study.csv", results.table);
    io::write_file(in + "study.json", whole_json.text());
    if (arguments.latex) {
        io::write_file(in + "study.tex", latex_tables(study, results, arguments.command_line));
        written.emplace_back("study.tex");
    } else {
        std::error_code error;
        std::filesystem::remove(in + "study.tex", error);  // that of an earlier run
    }
    for (const auto& [file, content] : results.files) {
        io::write_file(in + file, content);
        written.push_back(file);
    }
    for (const std::string& figure : results.figures)
        run::remove_figure(output, figure);  // those of an earlier run
    const bool all_failed = !results.numerical_failure.empty();
    if (arguments.plot && arguments.draw && !all_failed &&
        !arguments.draw(study.name + ".py", output, arguments.figure_formats).empty())
        for (const std::string& figure : results.figures)
            for (const std::string& file : run::existing_figures(output, figure, arguments.figure_formats))
                written.push_back(file);
    if (arguments.json || arguments.options.quiet) return;
    std::cout << "\nwritten to " << output << ":";
    for (const std::string& file : written) std::cout << ' ' << file;
    std::cout << '\n';
}

/// Compares all expectations with all measured values of their keys. Prints a line on stderr for each
/// difference above the tolerance and for each key that was not measured.
bool as_expected(const std::vector<Expectation>& expected, const std::vector<Measured>& measured)
{
    bool passed = true;
    const auto fails = [&](const std::string& message) {
        passed = false;
        io::message("hilda: error: expected " + message + "\n");
    };
    for (const Expectation& e : expected) {
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

}  // namespace

int finish(const Study& study, const StudyContext& results, const StudyArguments& arguments,
           run::FinishedJobs* finished)
{
    const StudyOptions& options = arguments.options;
    const io::Json all = whole(results, arguments);
    if (arguments.json)
        std::cout << all.text();
    else if (!options.quiet)
        std::cout << results.text.str() << results.failed_runs;
    if (!options.output.empty()) write(study, results, arguments, all);
    if (finished != nullptr) {
        io::EndOnSignal::ignore();  // the results are complete, there is nothing left to resume
        finished->remove();
    }
    if (!results.numerical_failure.empty()) {
        io::message(results.numerical_failure);
        return io::exit_code::numerical_failure;
    }
    const bool passed =
        as_expected(options.expect, results.measured) && (results.criteria_passed || !options.check);
    return passed ? io::exit_code::done : io::exit_code::expectation_failed;
}

int finish_shard(const Study& study, const StudyArguments& arguments, run::FinishedJobs& finished)
{
    finished.end_shard();
    const StudyOptions& options = arguments.options;
    if (!options.quiet)
        std::cout << fmt::format(
            "shard {} of study {} is complete: {}\nhilda collect, with the folders of all {} shards, writes "
            "the results\n",
            options.shard.text(), study.name, run::FinishedJobs::shard_file(options.output),
            options.shard.count);
    return io::exit_code::done;
}

}  // namespace hilda::studies
