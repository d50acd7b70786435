// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/reproduction_page.hpp"

#include "io/json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hilda::studies {

namespace {

constexpr const char* style = R"(
body { font: 15px/1.45 sans-serif; color: #222; max-width: 72em; margin: 2em auto; padding: 0 1em; }
table { border-collapse: collapse; margin: 0.7em 0; }
th, td { border-bottom: 1px solid #ddd; padding: 0.2em 0.8em 0.2em 0; text-align: left; vertical-align: top; }
td.number { text-align: right; font-variant-numeric: tabular-nums; }
pre { background: #f6f6f6; padding: 0.7em; overflow-x: auto; font-size: 12px; line-height: 1.3; }
img { max-width: 100%; border: 1px solid #eee; margin: 0.4em 0; display: block; }
section { border-top: 2px solid #bbb; margin-top: 2em; }
.passed { color: #00703c; } .failed, .error { color: #b00020; font-weight: bold; }
.done, .interrupted, .not-run { color: #666; }
.note { color: #555; }
)";

constexpr long most_lines = 60;  // of the text that is visible at once

std::string status_of(const std::string& status)
{
    std::string name = status;
    std::replace(name.begin(), name.end(), ' ', '-');
    return fmt::format("<span class=\"{}\">{}</span>", name, html(status));
}

std::string link(const std::string& to, const std::string& text)
{
    return fmt::format("<a href=\"{}\">{}</a>", html(to), html(text));
}

std::string number(double value) { return std::isnan(value) ? "-" : fmt::format("{:.8g}", value); }

std::string time_of(const Reproduced& r) { return r.seconds > 0 ? fmt::format("{:.1f} s", r.seconds) : "-"; }

/// "3 of 4" criteria passed, or "-"
std::string passed_of(const Reproduced& r)
{
    const auto passed =
        std::count_if(r.criteria.begin(), r.criteria.end(), [](const Criterion& c) { return c.passed(); });
    return r.criteria.empty() ? "-" : fmt::format("{} of {}", passed, r.criteria.size());
}

std::string summary_table(const std::vector<Reproduced>& all)
{
    std::string out =
        "<table>\n<tr><th>chapter</th><th>figure</th><th>study</th><th>criteria "
        "passed</th><th>status</th><th>time</th></tr>\n";
    for (const Reproduced& r : all)
        out += fmt::format(
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td class=\"number\">{}</td></tr>\n",
            r.entry->chapter, html(names_of_figures(*r.entry)), link('#' + r.entry->name, r.entry->title),
            passed_of(r), status_of(r.status), time_of(r));
    return out + "</table>\n";
}

std::string criteria_table(const std::vector<Criterion>& criteria)
{
    std::string out =
        "<table>\n<tr><th>acceptance "
        "criterion</th><th>measured</th><th>least</th><th>most</th><th></th></tr>\n";
    for (const Criterion& c : criteria)
        out += fmt::format(
            "<tr><td>{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td>"
            "<td class=\"number\">{}</td><td>{}</td></tr>\n",
            html(c.what), number(c.measured), number(c.least), number(c.most),
            status_of(c.passed() ? "passed" : "failed"));
    return out + "</table>\n";
}

/// The text of the study; a long text is folded
std::string text_block(const std::string& text)
{
    const std::string block = "<pre>" + html(text) + "</pre>\n";
    const long lines = std::count(text.begin(), text.end(), '\n');
    if (lines <= most_lines) return block;
    return fmt::format("<details><summary>table, {} lines</summary>\n{}</details>\n", lines, block);
}

std::string section(const Reproduced& r, const PageHead& head)
{
    const Reproduction& e = *r.entry;
    std::string out = fmt::format("<section id=\"{}\">\n<h2>{}: {}</h2>\n", html(e.name),
                                  html(names_of_figures(e)), html(e.title));
    out += fmt::format("<p>{}</p>\n", html(e.shows));
    out += fmt::format("<p><code>{}</code></p>\n", html(r.command));
    out += fmt::format("<p>{}, {}.", status_of(r.status), r.seconds > 0 ? "time " + time_of(r) : "no time");
    if (head.mode == "quick" && !e.reduced.empty())
        out += fmt::format(" <span class=\"note\">Reduced by --quick: {}.</span>", html(e.reduced));
    out += fmt::format(" <span class=\"note\">Discussion: docs/results/{}.</span></p>\n", html(e.page));
    if (r.status == "error") out += fmt::format("<pre>{}</pre>\n", html(r.message));
    if (!r.criteria.empty())
        out += criteria_table(r.criteria);
    else if (r.status == "done")
        out += "<p class=\"note\">This study has no acceptance criterion.</p>\n";
    for (const std::string& figure : r.figures)
        out += fmt::format("<img src=\"{}\" alt=\"{}\">\n", html(figure), html(e.title));
    if (r.figures.empty() && (r.status == "passed" || r.status == "failed" || r.status == "done"))
        out += fmt::format("<p class=\"note\">No figure. {}</p>\n", html(r.message));
    if (!r.text.empty()) out += text_block(r.text);
    std::string files;
    for (const std::string& file : r.files) files += (files.empty() ? "" : ", ") + link(file, file);
    if (!files.empty()) out += "<p class=\"note\">Files: " + files + "</p>\n";
    return out + "</section>\n";
}

}  // namespace

std::string names_of_figures(const Reproduction& entry)
{
    std::string numbers, others;
    int count = 0;
    for (const std::string& figure : entry.figures) {
        const bool is_number = figure.find(' ') == std::string::npos;
        std::string& to = is_number ? numbers : others;
        to += (to.empty() ? "" : ", ") + figure;
        count += is_number ? 1 : 0;
    }
    if (count > 0) numbers = (count > 1 ? "Figs. " : "Fig. ") + numbers;
    return numbers + (numbers.empty() || others.empty() ? "" : ", ") + others;
}

std::string html(const std::string& text)
{
    std::string out;
    for (size_t k = 0; k < text.size();) {
        const size_t length = io::utf8_length(std::string_view(text).substr(k));
        const char c = text[k];
        if (length == 0)
            out += "\xEF\xBF\xBD";  // U+FFFD for a byte that is no character
        else if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '"')
            out += "&quot;";
        else
            out += text.substr(k, length);
        k += std::max<size_t>(1, length);
    }
    return out;
}

std::string page(const std::vector<Reproduced>& all, const PageHead& head)
{
    const auto count = [&](const std::string& status) {
        return std::count_if(all.begin(), all.end(), [&](const Reproduced& r) { return r.status == status; });
    };
    std::string counts;
    for (const char* status : {"passed", "failed", "error", "done", "interrupted", "not run"})
        if (count(status) > 0)
            counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", count(status), status);
    std::string out =
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<title>HILDA: the figures of the dissertation</title>\n<style>" +
        std::string(style) + "</style>\n</head>\n<body>\n<h1>The figures of the dissertation</h1>\n";
    out +=
        "<p>Fang, L. (2022). Each study below computes the figures of the dissertation that it names. "
        "\"done\": the study has no acceptance criterion.</p>\n<table>\n";
    for (const auto& [what, value] :
         {std::pair{"version", head.version},
          {"machine", head.machine},
          {"date", head.date},
          {"grids", head.mode == "quick" ? std::string("--quick: reduced, as each section states")
                                         : std::string("--full: those of the dissertation")},
          {"result", counts},
          {"time", fmt::format("{:.0f} s", head.seconds)}})
        out += fmt::format("<tr><th>{}</th><td>{}</td></tr>\n", what, html(value));
    out += "</table>\n" + summary_table(all);
    for (const Reproduced& r : all) out += section(r, head);
    return out + "</body>\n</html>\n";
}

}  // namespace hilda::studies
