// SPDX-License-Identifier: GPL-3.0-or-later
/// Studies granular-NAME: the validations of `granular` (Fang 2022, Ch. 7), run through the study framework.
///
/// The tables of a validation become files, its checks become acceptance criteria.

#include "io/error.hpp"
#include "io/progress.hpp"
#include "studies/framework/acceptance.hpp"
#include "studies/framework/study_output.hpp"
#include "studies/program/arguments.hpp"

#include "granular/validations/validation.hpp"

#include <fmt/format.h>

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
    for (const auto& row : validation_table.rows) table.add(row);
    return table;
}

/// io::UsageError for options that a validation does not have.
void reject_unused_options(const std::string& kind, const StudyOptions& options)
{
    const auto reject_if = [&](bool given, const std::string& name) {
        if (given) throw io::UsageError("study " + kind + ": " + name + " is not an option of this study");
    };
    reject_if(!options.problems.empty(), "--problem");
    reject_if(!options.integrators.empty(), "--integrator");
    reject_if(!options.steps.empty(), "--steps");
    reject_if(options.end.has_value(), "--end");
    reject_if(!options.set.empty(), "--set");
    reject_if(!options.expect.empty(), "--expect");
    if (!options.grid.empty()) one_of("--grid", options.grid, std::vector<std::string>{"full"});
}

granular::ValidationResult result_of(const Validation& validation, const std::string& kind,
                                     const StudyOptions& options)
{
    granular::ValidationOptions validation_options;
    validation_options.full = options.grid == "full";
    io::ProgressLine line(options.quiet);
    validation_options.progress = [&](double share) {
        if (line.is_due()) line.show(fmt::format("{} {:.0f} %, {:.1f} s", kind, 100 * share, line.seconds()));
    };
    try {
        return validation.run(validation_options);
    } catch (const io::NumericalFailure& e) {
        throw io::NumericalFailure(e.status, "study " + kind + ": " + e.what());
    }
}

int study(const Validation& validation, const StudyOptions& options)
{
    StudyOutput output;
    output.kind = "granular-" + validation.name;
    reject_unused_options(output.kind, options);
    const granular::ValidationResult result = result_of(validation, output.kind, options);

    output.json["grid"] = options.grid.empty() ? "quick" : options.grid;
    output.text << validation.description << '\n';
    for (const ValidationTable& t : result.tables) {
        const Table table = as_table(t);
        const bool first = &t == &result.tables.front();
        if (first)
            output.table = table.csv();
        else
            output.files.emplace_back(t.name + ".csv", table.csv());
        if (!first && table.rows() > most_rows) continue;
        output.text << '\n' << (first ? "" : t.name + '\n');
        table.print(output.text);
    }
    std::vector<Criterion> criteria;
    for (const granular::ValidationCheck& c : result.checks)
        criteria.push_back(between(c.what, c.measured, c.lower, c.upper));
    const bool passed = evaluate(criteria, output.text, output.json);
    output.figures = {output.kind + ".png"};
    const int code = finish(options, output, {}, {});
    return code == io::exit_code::done && options.check && !passed ? io::exit_code::expectation_failed : code;
}

std::vector<Study> all()
{
    std::vector<Study> studies;
    for (const Validation& v : granular::validations())
        studies.push_back({.kind = "granular-" + v.name,
                           .answers = v.description,
                           .accepted = takes::check | takes::grid,
                           .run = [v](const StudyOptions& options) { return study(v, options); }});
    return studies;
}

const bool registered = register_studies(all);

}  // namespace

}  // namespace hilda::studies
