// SPDX-License-Identifier: GPL-3.0-or-later
/// Reading of the results of studies for the page of `hilda reproduce`.
#include "io/error.hpp"
#include "io/files.hpp"
#include "io/formats/csv.hpp"
#include "io/json_source.hpp"
#include "io/option_values.hpp"
#include "studies/program/reproduction_page.hpp"
#include "studies/running/provenance.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

namespace hilda::studies {

namespace {

namespace fs = std::filesystem;

constexpr size_t most_bytes = size_t{256} << 20;  // largest file that is read [byte]

using Row = std::map<std::string, std::string>;

/// The rows of a table of a study. io::IoError for a row of another length than the header
std::vector<Row> rows_of(const std::string& csv, const std::string& file)
{
    std::vector<Row> rows;
    try {
        io::read_csv(csv, file, [&](const io::CsvRow& row) {
            Row& to = rows.emplace_back();
            for (size_t k = 0; k < row.names.size(); ++k) to[std::string(row.names[k])] = row.cells[k];
        });
    } catch (const io::InvalidInput& error) {
        throw io::IoError(error.what());
    }
    return rows;
}

double number_in(const Row& row, const std::string& column)
{
    const auto at = row.find(column);
    return at == row.end() ? std::nan("") : io::finite_number_in(at->second);
}

/// Whether a cell has a value: the same number, or the same text
bool has(const Row& row, const std::string& column, const std::string& value)
{
    const auto at = row.find(column);
    if (at == row.end()) return false;
    const double a = io::finite_number_in(at->second), b = io::finite_number_in(value);
    return at->second == value || std::abs(a - b) <= 1e-12 * std::abs(b);
}

/// The value of a row in the column of the check; NaN if it has none
double value_of(const ReproductionCheck& check, const Row& row, const std::vector<Row>& rows)
{
    const double value = number_in(row, check.column);
    if (check.relative_to.empty()) return value;
    for (const Row& other : rows) {
        const auto same = [&](const char* column) {
            return !row.contains(column) || has(other, column, row.at(column));
        };
        if (other.at("integrator") == check.relative_to && same("problem") && same("h") && same("bars"))
            return value / number_in(other, check.column);
    }
    return std::nan("");
}

/// The text of a file; empty if there is none
std::string text_of(const std::string& file)
{
    std::error_code error;
    return fs::is_regular_file(file, error) ? io::read_file(file, most_bytes) : "";
}

std::string last_line(std::string text)
{
    while (text.ends_with('\n')) text.pop_back();
    return text.substr(text.rfind('\n') + 1);
}

double number_of(const io::Json& object, const char* key)
{
    const io::Json::Member* member = object.member(key);
    return member != nullptr && member->value.number() != nullptr ? *member->value.number() : std::nan("");
}

/// A criterion of study.json: between `least` and `most`, or `required` with its tolerance. The bounds
/// include the measured value if the study has accepted it, so that rounding of the bounds does not change
/// the result.
Criterion criterion_of(const io::Json& check)
{
    const io::Json::Member *what = check.member("what"), *passed = check.member("passed");
    const double required = number_of(check, "required"), tolerance = number_of(check, "tolerance"),
                 measured = number_of(check, "measured");
    Criterion c = between(what != nullptr && what->value.string() != nullptr ? *what->value.string() : "",
                          measured, number_of(check, "least"), number_of(check, "most"));
    if (!std::isnan(required)) c.least = required - tolerance, c.most = required + tolerance;
    if (passed != nullptr && passed->value.boolean() != nullptr && *passed->value.boolean() &&
        !std::isnan(measured))
        c.least = std::fmin(c.least, measured), c.most = std::fmax(c.most, measured);
    return c;
}

/// The criteria that the study has evaluated: the key "checks" of study.json
std::vector<Criterion> criteria_of_study(const std::string& file)
{
    const std::string text = text_of(file);
    if (text.empty()) return {};
    const io::JsonSource study(text, file, most_bytes);
    std::vector<Criterion> all;
    const io::Json::Member* checks = study.root.member("checks");
    if (checks != nullptr && checks->value.list() != nullptr)
        for (const io::Json& check : *checks->value.list()) all.push_back(criterion_of(check));
    return all;
}

/// Names of the files of a directory with this ending, sorted
std::vector<std::string> files_in(const std::string& directory, const std::string& ending)
{
    std::vector<std::string> names;
    std::error_code error;
    for (const auto& file : fs::directory_iterator(directory, error))
        if (file.is_regular_file(error) && file.path().extension() == ending)
            names.push_back(file.path().filename());
    std::sort(names.begin(), names.end());
    return names;
}

}  // namespace

std::vector<Criterion> evaluate_checks(const Reproduction& entry, const std::string& csv,
                                       const std::string& file)
{
    const std::vector<Row> rows = csv.empty() ? std::vector<Row>{} : rows_of(csv, file);
    std::vector<Criterion> all;
    for (const ReproductionCheck& check : entry.checks) {
        // The value nearest to a bound, or farthest beyond it. NaN, which fails, without a row.
        double worst = std::nan(""), excess = -std::numeric_limits<double>::infinity();
        for (const Row& row : rows) {
            const bool selected = std::all_of(check.where.begin(), check.where.end(),
                                              [&](const auto& w) { return has(row, w.first, w.second); });
            const double value = selected ? value_of(check, row, rows) : std::nan("");
            const double beyond = std::max(check.least - value, value - check.most);
            if (std::isnan(value) || beyond < excess) continue;
            worst = value, excess = beyond;
        }
        all.push_back(between(check.what, worst, check.least, check.most));
    }
    return all;
}

void read_results(Reproduced& of, const std::string& directory)
{
    const std::string in = directory + '/' + of.entry->name;
    of.text = text_of(in + ".txt");
    of.message = last_line(text_of(in + ".log"));
    of.figures.clear(), of.files.clear(), of.criteria.clear();
    for (const char* ending : {".csv", ".json"})
        for (const std::string& name : files_in(in, ending)) of.files.push_back(of.entry->name + '/' + name);
    if (of.exit_code >= io::exit_code::signal) {
        of.status = "interrupted";
        return;
    }
    if (of.exit_code != io::exit_code::done && of.exit_code != io::exit_code::expectation_failed) {
        of.status = "error";
        return;
    }
    for (const std::string& name : files_in(in, ".png")) of.figures.push_back(of.entry->name + '/' + name);
    of.criteria = criteria_of_study(in + "/study.json");
    const std::vector<Criterion> more =
        evaluate_checks(*of.entry, text_of(in + "/study.csv"), in + "/study.csv");
    of.criteria.insert(of.criteria.end(), more.begin(), more.end());
    const bool passed =
        of.exit_code == io::exit_code::done &&
        std::all_of(of.criteria.begin(), of.criteria.end(), [](const Criterion& c) { return c.passed(); });
    of.status = !passed ? "failed" : of.criteria.empty() ? "done" : "passed";
}

bool has_ended(const Reproduced& of)
{
    return of.status == "passed" || of.status == "failed" || of.status == "done";
}

io::Json record_of(const std::vector<Reproduced>& all, const io::Json::List& others, const std::string& mode)
{
    io::Json record = {{"mode", mode}, {"version", version_line()}, {"finished", others}};
    for (const Reproduced& r : all)
        if (has_ended(r))
            record["finished"].push_back({{"name", r.entry->name},
                                          {"command", r.command},
                                          {"exit_code", r.exit_code},
                                          {"seconds", r.seconds}});
    return record;
}

io::Json::List read_record(const std::string& file, const std::string& directory, const std::string& mode,
                           std::vector<Reproduced>& all)
{
    const io::JsonSource record(io::read_file(file, io::JsonSource::max_bytes), file);
    const auto text = [&](const io::Json& object, const char* key) {
        const io::Json::Member* member = object.member(key);
        if (member == nullptr || member->value.string() == nullptr)
            throw io::InvalidInput(file + ": the key '" + key + "' is missing or invalid");
        return *member->value.string();
    };
    for (const auto& [key, mine] : {std::pair{"mode", mode}, {"version", version_line()}})
        if (const std::string its = text(record.root, key); its != mine)
            throw io::UsageError(directory + ": --resume needs the same " + key + ": '" + its +
                                 "' was begun, this is '" + mine + "'; --force starts again");
    io::Json::List others;
    const io::Json::Member* finished = record.root.member("finished");
    if (finished == nullptr || finished->value.list() == nullptr) return others;
    for (const io::Json& one : *finished->value.list()) {
        const std::string name = text(one, "name"), command = text(one, "command");
        const auto of =
            std::find_if(all.begin(), all.end(), [&](const Reproduced& r) { return r.entry->name == name; });
        const double code = number_of(one, "exit_code"), seconds = number_of(one, "seconds");
        if (of == all.end()) {
            others.push_back(one);
        } else if (of->command == command && code >= 0 && code < io::exit_code::signal && seconds >= 0) {
            of->exit_code = static_cast<int>(code), of->seconds = seconds;
            read_results(*of, directory);
        }
    }
    return others;
}

}  // namespace hilda::studies
