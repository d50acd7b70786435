// SPDX-License-Identifier: GPL-3.0-or-later
/// Studies granular-NAME: the validations of `granular` (Fang 2022, Ch. 7), run through the study framework.
///
/// The tables of a validation become files, its checks become acceptance criteria.

#include "io/archive.hpp"
#include "io/error.hpp"
#include "io/message.hpp"
#include "io/progress.hpp"
#include "run/provenance.hpp"
#include "studies/framework/study_context.hpp"
#include "studies/framework/study_options.hpp"
#include "studies/framework/table.hpp"

#include "granular/validations/validation.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>

namespace hilda::studies {

namespace {

using granular::Validation;
using granular::ValidationTable;

constexpr std::size_t most_rows = 60;  // longer tables (curves) are only written to files

Table as_table(const ValidationTable& validation_table)
{
    std::vector<Table::Column> columns;
    for (const std::string& name : validation_table.columns) columns.push_back({name, "{:.6g}"});
    Table table(columns);
    for (const auto& row : validation_table.rows) {
        std::vector<Table::Cell> cells;
        for (const auto& cell : row) std::visit([&](const auto& value) { cells.emplace_back(value); }, cell);
        table.add(cells);
    }
    return table;
}

/// Keeps the results of the parts with their warnings in the file of the finished jobs, and the state of a
/// long part in a checkpoint of the output directory. Shards share independent parts. `of_part`
/// receives the warnings of a part.
granular::ValidationProgress kept_by(const StudyContext& study, granular::ValidationWarnings& warnings,
                                     granular::ValidationWarnings& of_part)
{
    granular::ValidationProgress kept;
    kept.part = [&](const auto& compute, const auto& transfer) {
        of_part = {};
        study.job(compute, [&](io::Archive& a) { transfer(a), of_part.transfer(a); });
        warnings.include(of_part);
    };
    kept.parts = [&](long count, const auto& compute, const auto& transfer) {
        std::vector<granular::ValidationWarnings> of_parts(static_cast<std::size_t>(count));
        const auto job = [&](long k) {
            of_part = {};
            compute(k);
            of_parts[static_cast<std::size_t>(k)] = of_part;
        };
        study.jobs(count, job, [&](io::Archive& a, long k) {
            transfer(a, k), of_parts[static_cast<std::size_t>(k)].transfer(a);
        });
        for (const granular::ValidationWarnings& of : of_parts) warnings.include(of);
    };
    if (study.output.empty()) return kept;
    const auto files = std::make_shared<io::CheckpointFiles>(study.output);  // load and save share it
    if (!study.options.resume) files->remove();
    kept.load = [=](const auto& read) { files->load(read); };
    kept.save = [=](const std::string& bytes) { files->save(bytes); };
    return kept;
}

/// The folder "settled" beside the output directory; empty without an output directory
std::string folder_of_beds(const std::string& output)
{
    if (output.empty()) return {};
    std::filesystem::path path = std::filesystem::absolute(output).lexically_normal();
    if (!path.has_filename()) path = path.parent_path();  // of "DIR/"
    return (path.parent_path() / "settled").string();
}

granular::ValidationResult result_of(const Validation& validation, const StudyContext& study,
                                     granular::ValidationWarnings& warnings)
{
    granular::ValidationWarnings of_part;
    granular::ValidationOptions options;
    options.full = study.grid == "full";
    options.warnings = &of_part;
    options.kept = kept_by(study, warnings, of_part);
    options.beds = {.folder = folder_of_beds(study.output), .program = run::version_line()};
    if (!study.quiet)
        options.announce = [&](const std::string& text) {
            io::message("hilda: study " + study.name + ": " + text + '\n');
        };
    io::ProgressLine line(study.quiet);
    std::optional<double> at_begin;  // of a resumed study
    options.progress = [&](double share) {
        if (!at_begin) at_begin = share;
        line.completed(share, *at_begin);
        if (line.is_due()) line.show(fmt::format("{} {:.1f} s", study.name, line.seconds()));
    };
    try {
        granular::ValidationResult result = validation.run(options);
        if (!study.output.empty()) io::CheckpointFiles(study.output).remove();
        return result;
    } catch (const io::NumericalFailure& e) {
        throw io::NumericalFailure(e.status, "study " + study.name + ": " + e.what());
    }
}

/// Prints the largest warning of each kind on stderr and adds the warnings of all runs to study.json.
void report(const granular::ValidationWarnings& warnings, StudyContext& s)
{
    if (!s.quiet)
        for (const granular::ValidationWarning& w : warnings.largest())
            io::warning("study " + s.name + ": " + w.text);
    for (const granular::ValidationWarning& w : warnings.all()) {
        s.json["warnings"].push_back(w.name + ": " + w.text);
        s.warned(w.name, w.text);
    }
}

void validate(const Validation& validation, StudyContext& s)
{
    if (!s.grid.empty()) io::one_of("--grid", s.grid, std::vector<std::string>{"full"});
    granular::ValidationWarnings warnings;
    const granular::ValidationResult result = result_of(validation, s, warnings);
    s.json["grid"] = s.grid.empty() ? "quick" : s.grid;
    report(warnings, s);
    s.text << validation.description << '\n';
    for (const ValidationTable& t : result.tables) {
        const Table table = as_table(t);
        const bool first = &t == &result.tables.front();
        if (first)
            s.table = table.csv();
        else
            s.files.emplace_back(t.name + ".csv", table.csv());
        if (!first && table.rows() > most_rows) continue;
        s.text << '\n' << (first ? "" : t.name + '\n');
        table.print(s.text);
    }
    std::vector<Criterion> criteria;
    for (const granular::ValidationCheck& c : result.checks)
        criteria.push_back(between(c.what, c.measured, c.lower, c.upper));
    s.evaluate(criteria);
    s.figures = {s.name + ".png"};
}

/// For the help: the tables after the first one, and the figure
std::vector<std::string> files_of(const std::string& study)
{
    const std::map<std::string, std::vector<std::string>> tables = {
        {"granular-head-on", {"refinement.csv", "clamped.csv"}},
        {"granular-brick", {"motion.csv"}},
        {"granular-comparison-drum", {"motion.csv", "grains.csv"}},
        {"granular-comparison-penetration", {"motion.csv"}},
        {"granular-comparison-silo", {"motion.csv"}},
        {"granular-cratering", {"motion.csv"}},
        {"granular-hopper", {"motion.csv"}},
        {"granular-drum", {"surface.csv", "grains.csv"}},
        {"granular-low-velocity-cratering", {"motion.csv"}},
        {"granular-oblique", {"reference.csv", "steps.csv", "levers.csv"}},
        {"granular-repose", {"heaps.csv", "surface.csv", "spheres.csv"}},
        {"granular-shear", {"motion.csv"}},
        {"granular-stacking", {"friction.csv"}},
        {"granular-waves", {"profiles.csv"}},
        {"granular-wheel", {"motion.csv", "grains.csv"}}};
    const auto found = tables.find(study);
    std::vector<std::string> files = found == tables.end() ? std::vector<std::string>{} : found->second;
    files.push_back(study + ".png");
    return files;
}

OptionNames options_of(const Validation& validation)
{
    OptionNames names = {"--check", "--grid", "--strict"};
    if (validation.independent_parts) names.emplace_back("--shard");
    return names;
}

std::vector<Study> all()
{
    std::vector<Study> studies;
    for (const Validation& v : io::Registry<Validation>::all())
        studies.push_back({.name = "granular-" + v.name,
                           .answers = v.description,
                           .options = options_of(v),
                           .files = files_of("granular-" + v.name),
                           .run = [v](StudyContext& study) { validate(v, study); }});
    return studies;
}

const bool registered_granular_validation = register_studies(all);

}  // namespace

}  // namespace hilda::studies
