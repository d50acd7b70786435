// SPDX-License-Identifier: GPL-3.0-or-later
/// The results of the studies of `hilda reproduce`, read from their output directories, and their page.
#include "studies/program/repeating/reproduction.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/json_source.hpp"
#include "studies/program/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace hilda::studies {

namespace {

namespace fs = std::filesystem;

constexpr size_t most_bytes = size_t{256} << 20;  // largest file that is read [byte]

/// The text of a file; empty if there is none
std::string text_of(const std::string& file)
{
    std::error_code error;
    return fs::is_regular_file(file, error) ? io::read_file(file, most_bytes) : "";
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
std::vector<Criterion> criteria_of(const std::string& file)
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

/// The files of a study with this ending, sorted: NAME/FILE
std::vector<std::string> files_of(const std::string& name, const std::string& directory,
                                  const std::string& ending)
{
    std::vector<std::string> files;
    std::error_code error;
    for (const auto& file : fs::directory_iterator(directory + '/' + name, error))
        if (file.is_regular_file(error) && file.path().extension() == ending)
            files.push_back(name + '/' + file.path().filename().string());
    std::sort(files.begin(), files.end());
    return files;
}

constexpr const char* style = R"(
body { font: 15px/1.45 sans-serif; color: #222; max-width: 72em; margin: 2em auto; padding: 0 1em; }
table { border-collapse: collapse; margin: 0.7em 0; }
th, td { border-bottom: 1px solid #ddd; padding: 0.2em 0.8em 0.2em 0; text-align: left; vertical-align: top; }
td.number { text-align: right; font-variant-numeric: tabular-nums; }
pre { background: #f6f6f6; padding: 0.7em; overflow-x: auto; font-size: 12px; line-height: 1.3; }
img { max-width: 100%; border: 1px solid #eee; margin: 0.4em 0; display: block; }
section { border-top: 2px solid #bbb; margin-top: 2em; }
.passed { color: #00703c; } .failed, .error { color: #b00020; font-weight: bold; }
.note { color: #555; }
)";

constexpr long most_lines = 60;  // of the text that is visible at once

/// An element of the page around an HTML text
std::string in(const std::string& tag, const std::string& text)
{
    return fmt::format("<{}>{}</{}>", tag, text, tag.substr(0, tag.find(' ')));
}

std::string note(const std::string& text) { return in("p class=\"note\"", text) + '\n'; }

std::string link(const std::string& to, const std::string& text)
{
    return in("a href=\"" + html(to) + '"', html(text));
}

std::string status_of(const std::string& status)
{
    return in(fmt::format("span class=\"{}\"", status == "not run" ? "not-run" : status), status);
}

std::string number(const std::string& text) { return in("td class=\"number\"", text); }
std::string number(double value) { return number(std::isnan(value) ? "-" : fmt::format("{:.8g}", value)); }

std::string row_of_summary(const Reproduced& r)
{
    const auto passed =
        std::count_if(r.criteria.begin(), r.criteria.end(), [](const Criterion& c) { return c.passed(); });
    return in("tr",
              in("td", std::to_string(r.entry->chapter)) + in("td", html(r.entry->figures)) +
                  in("td", link('#' + r.entry->name, r.entry->title)) +
                  in("td", r.criteria.empty() ? "-" : fmt::format("{} of {}", passed, r.criteria.size())) +
                  in("td", status_of(r.status)) +
                  number(r.seconds > 0 ? fmt::format("{:.1f} s", r.seconds) : "-")) +
           '\n';
}

std::string criteria_table(const std::vector<Criterion>& criteria)
{
    std::string rows =
        "\n<tr><th>acceptance criterion</th><th>measured</th><th>least</th><th>most</th><th></th></tr>\n";
    for (const Criterion& c : criteria)
        rows += in("tr", in("td", html(c.what)) + number(c.measured) + number(c.least) + number(c.most) +
                             in("td", status_of(c.passed() ? "passed" : "failed"))) +
                '\n';
    return in("table", rows) + '\n';
}

/// The text of the study; a long text is folded
std::string text_block(const std::string& text)
{
    std::string block = in("pre", html(text)) + '\n';
    const long lines = std::count(text.begin(), text.end(), '\n');
    if (lines <= most_lines) return block;
    return in("details", in("summary", fmt::format("table, {} lines", lines)) + '\n' + block) + '\n';
}

std::string section(const Reproduced& r, bool quick)
{
    const Reproduction& e = *r.entry;
    std::string out = '\n' + in("h2", html(e.figures + ": " + e.title)) + '\n' + in("p", html(e.shows)) +
                      '\n' + in("p", in("code", html(r.command))) + '\n';
    std::string line = fmt::format("{}, {}.", status_of(r.status),
                                   r.seconds > 0 ? fmt::format("time {:.1f} s", r.seconds) : "no time");
    if (quick && !e.reduced.empty()) line += " Reduced by --quick: " + html(e.reduced) + '.';
    out += in("p", line + fmt::format(" Discussion: docs/results/{}.md.", e.words(false)[2])) + '\n';
    if (r.status == "error") out += in("pre", html(r.message)) + '\n';
    if (!r.criteria.empty())
        out += criteria_table(r.criteria);
    else if (r.status == "done")
        out += note("This study has no acceptance criterion.");
    for (const std::string& figure : r.figures)
        out += fmt::format("<img src=\"{}\" alt=\"{}\">\n", html(figure), html(e.title));
    if (r.figures.empty() && r.has_ended()) out += note("No figure. " + html(r.message));
    if (!r.text.empty()) out += text_block(r.text);
    std::string files;
    for (const std::string& file : r.files) files += (files.empty() ? "" : ", ") + link(file, file);
    if (!files.empty()) out += note("Files: " + files);
    return in(fmt::format("section id=\"{}\"", e.name), out) + '\n';
}

}  // namespace

void read_results(Reproduced& of, const std::string& directory)
{
    const std::string &name = of.entry->name, path = directory + '/' + name;
    of.text = text_of(path + ".txt");
    of.message = last_line(text_of(path + ".log"));
    of.files = files_of(name, directory, ".csv");
    for (const std::string& file : files_of(name, directory, ".json")) of.files.push_back(file);
    const bool has_results =
        of.exit_code == io::exit_code::done || of.exit_code == io::exit_code::expectation_failed;
    of.criteria = has_results ? criteria_of(path + "/study.json") : std::vector<Criterion>{};
    of.figures = has_results ? files_of(name, directory, ".png") : std::vector<std::string>{};
    const bool passed =
        of.exit_code == io::exit_code::done &&
        std::all_of(of.criteria.begin(), of.criteria.end(), [](const Criterion& c) { return c.passed(); });
    of.status = of.exit_code >= io::exit_code::signal ? "interrupted"
                : !has_results                        ? "error"
                : !passed                             ? "failed"
                : of.criteria.empty()                 ? "done"
                                                      : "passed";
}

std::string page(const std::vector<Reproduced>& all,
                 const std::vector<std::pair<std::string, std::string>>& head, bool quick)
{
    std::string facts = "\n", summary =
                                  "\n<tr><th>chapter</th><th>figure</th><th>study</th><th>criteria "
                                  "passed</th><th>status</th><th>time</th></tr>\n";
    for (const auto& [name, value] : head) facts += in("tr", in("th", name) + in("td", html(value))) + '\n';
    std::string sections;
    for (const Reproduced& r : all) summary += row_of_summary(r), sections += section(r, quick);
    return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>HILDA: the figures "
           "of "
           "the dissertation</title>\n<style>" +
           std::string(style) + "</style>\n</head>\n<body>\n<h1>The figures of the dissertation</h1>\n" +
           in("p",
              "Fang, L. (2022). Each study below computes the figures of the dissertation that it names. "
              "\"done\": the study has no acceptance criterion.") +
           '\n' + in("table", facts) + '\n' + in("table", summary) + '\n' + sections + "</body>\n</html>\n";
}

std::string html(const std::string& text)
{
    std::string out;
    for (size_t k = 0; k < text.size();) {
        const size_t length = io::utf8_length(std::string_view(text).substr(k));
        switch (length == 0 ? '\0' : text[k]) {
            case '\0':
                out += "\xEF\xBF\xBD";
                break;  // U+FFFD for a byte that is no character
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            default:
                out += text.substr(k, length);
        }
        k += std::max<size_t>(1, length);
    }
    return out;
}

}  // namespace hilda::studies
