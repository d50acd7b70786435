// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/program/validate.hpp"

#include "granular/program/arguments.hpp"
#include "granular/running/watch_report.hpp"
#include "io/error.hpp"
#include "io/message.hpp"
#include "io/progress.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace hilda::granular {

namespace {

std::string shown(const ValidationTable::Cell& cell)
{
    if (const auto* text = std::get_if<std::string>(&cell)) return *text;
    char number[32];
    std::snprintf(number, sizeof number, "%.6g", std::get<double>(cell));
    return number;
}

/// Prints lines of cells, each column as wide as its widest cell
void print(const std::vector<std::vector<std::string>>& lines)
{
    std::vector<std::size_t> width(lines[0].size(), 0);
    for (const auto& line : lines)
        for (std::size_t c = 0; c < line.size(); ++c) width[c] = std::max(width[c], line[c].size());
    for (const auto& line : lines) {
        for (std::size_t c = 0; c < line.size(); ++c)
            std::printf("%*s%s", static_cast<int>(width[c]), line[c].c_str(),
                        c + 1 < line.size() ? "  " : "\n");
    }
}

void print(const ValidationTable& table)
{
    std::vector<std::vector<std::string>> lines = {table.columns};
    for (const auto& row : table.rows) {
        lines.emplace_back();
        for (const auto& cell : row) lines.back().push_back(shown(cell));
    }
    print(lines);
}

}  // namespace

const Validation* find_validation(const std::string& name) { return io::Registry<Validation>::find(name); }

int validate(const Validation& v, ValidationOptions options, bool quiet, bool strict)
{
    io::ProgressLine line(quiet);
    options.progress = [&](double share) {
        line.completed(share);
        line.show(v.name);
    };
    if (!quiet)
        options.announce = [&](const std::string& text) {
            io::message("hilda: " + v.name + ": " + text + '\n');
        };
    ValidationResult result;
    ValidationWarnings warnings;
    options.warnings = &warnings;
    try {
        result = v.run(options);
        line.clear();
        for (const ValidationWarning& w : warnings.largest()) {
            if (strict) throw StrictWarning(w.name, w.text + strict_suffix);
            if (!quiet) io::warning(v.name + ": " + w.text);
        }
    } catch (const io::NumericalFailure& e) {
        line.clear();
        io::message("hilda: error[" + e.status + "]: " + v.name + ": " + e.what() + '\n');
        return io::exit_code::numerical_failure;
    }
    std::vector<std::vector<std::string>> lines = {{"measured", "lower", "upper", "", "what"}};
    for (const ValidationCheck& c : result.checks)
        lines.push_back(
            {shown(c.measured), shown(c.lower), shown(c.upper), c.passed() ? "ok" : "FAILED", c.what});
    const auto passed = std::count_if(result.checks.begin(), result.checks.end(),
                                      [](const ValidationCheck& c) { return c.passed(); });
    if (!quiet) {
        std::printf("%s: %s\n", v.name.c_str(), v.description.c_str());
        for (const ValidationTable& t : result.tables) {
            constexpr std::size_t max_rows = 60;  // rows; longer tables are curves
            const bool curve = &t != &result.tables.front() && t.rows.size() > max_rows;
            std::printf("\n%s%s\n", t.name.c_str(), curve ? ": a curve; see the study" : "");
            if (!curve) print(t);
        }
        std::printf("\n");
        print(lines);
        std::printf("%ld of %zu passed\n", static_cast<long>(passed), result.checks.size());
    }
    return passed == static_cast<long>(result.checks.size()) ? io::exit_code::done
                                                             : io::exit_code::expectation_failed;
}

}  // namespace hilda::granular
