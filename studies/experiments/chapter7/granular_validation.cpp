// SPDX-License-Identifier: GPL-3.0-or-later
/// The validations of the granular room as studies, granular-NAME: their tables as files, their checks as demands.

#include "studies/exit_codes.hpp"
#include "studies/framework/acceptance.hpp"
#include "studies/framework/study_output.hpp"
#include "studies/message.hpp"
#include "studies/program/arguments.hpp"

#include "granular/validations/validation.hpp"
#include "lie/check.hpp"

#include <fmt/format.h>

#include <unistd.h>

#include <chrono>

namespace hilda::studies {

namespace {

using granular::Validation;
using granular::ValidationTable;

constexpr std::size_t most_rows = 60;  // of a table after the first that is printed; a curve has more

Table as_table(const ValidationTable& of)
{
    std::vector<Table::Column> columns;
    for (const std::string& name : of.columns) columns.push_back({name, "{:.6g}"});
    Table table(columns);
    for (const auto& row : of.rows) table.add(row);
    return table;
}

/// What a validation has no use for is refused.
void refuse_idle(const std::string& kind, const StudyOptions& options)
{
    const auto refuse = [&](bool given, const std::string& name) {
        if (given) throw UsageError("study " + kind + ": " + name + " is for other studies");
    };
    refuse(!options.problems.empty(), "--problem");
    refuse(!options.integrators.empty(), "--integrator");
    refuse(!options.steps.empty(), "--steps");
    refuse(options.end.has_value(), "--end");
    refuse(!options.set.empty(), "--set");
    refuse(!options.expect.empty(), "--expect");
    if (!options.grid.empty()) one_of("--grid", options.grid, std::vector<std::string>{"full"});
}

/// A line on a terminal, rewritten at most five times a second
std::function<void(double)> progress(const std::string& kind, bool quiet)
{
    using Clock = std::chrono::steady_clock;
    if (quiet || isatty(STDERR_FILENO) == 0) return [](double) {};
    return [kind, begin = Clock::now(), last = Clock::time_point()](double share) mutable {
        const auto now = Clock::now();
        if (now - last < std::chrono::milliseconds(200)) return;
        last = now;
        message(fmt::format("\r{} {:.0f} %, {:.1f} s\033[K", kind, 100 * share,
                            std::chrono::duration<double>(now - begin).count()));
    };
}

granular::ValidationResult result_of(const Validation& validation, const std::string& kind,
                                     const StudyOptions& options)
{
    granular::ValidationOptions wanted;
    wanted.full = options.grid == "full";
    wanted.progress = progress(kind, options.quiet);
    const auto clear = [&] {
        if (!options.quiet && isatty(STDERR_FILENO) != 0) message("\r\033[K");
    };
    try {
        auto result = validation.run(wanted);
        clear();
        return result;
    } catch (const granular::ParticleLost& e) {
        clear();
        throw lie::NumericalFailure("particle_lost", "study " + kind + ": " + e.what());
    }
}

int study(const Validation& validation, const StudyOptions& options)
{
    StudyOutput output;
    output.kind = "granular-" + validation.name;
    refuse_idle(output.kind, options);
    const granular::ValidationResult result = result_of(validation, output.kind, options);

    output.json["grid"] = options.grid.empty() ? "quick" : options.grid;
    output.text << validation.answers << '\n';
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
        criteria.push_back(between(c.what, c.measured, c.least, c.most));
    const bool passed = evaluate(criteria, output.text, output.json);
    output.figures = {output.kind + ".png"};
    const int code = finish(options, output, {}, {});
    return code == exit_code::done && options.check && !passed ? exit_code::expectation_failed : code;
}

std::vector<Study> all()
{
    std::vector<Study> studies;
    for (const Validation& v : granular::validations())
        studies.push_back({.kind = "granular-" + v.name,
                           .answers = v.answers,
                           .also = takes::check | takes::grid,
                           .run = [v](const StudyOptions& options) { return study(v, options); }});
    return studies;
}

const bool registered = register_studies(all);

}  // namespace

}  // namespace hilda::studies
