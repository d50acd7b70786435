// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/latex.hpp"

#include <algorithm>
#include <map>
#include <regex>
#include <sstream>

namespace hilda::studies {

namespace {

/// 1.5 and -03 as 1.5\times10^{-3}; without exponent the mantissa
std::string power_of_ten(const std::string& mantissa, const std::string& exponent)
{
    return exponent.empty() ? mantissa : mantissa + "\\times10^{" + std::to_string(std::stoi(exponent)) + '}';
}

/// A whole cell that is a number with an optional bound, sign and mark, such as "+42.5", "<= 0.85",
/// "1.2e-04*"; otherwise ""
std::string number_cell(const std::string& cell)
{
    static const std::regex form(R"((<= )?([-+]?)(\d+(?:\.\d+)?)(?:e([-+]?\d{1,3}))?([* ]?))");
    std::smatch m;
    if (!std::regex_match(cell, m, form)) return {};
    return '$' + std::string(m[1].matched ? "\\le " : "") + m[2].str() + power_of_ten(m[3], m[4]) + '$' +
           (m[5] == "*" ? "*" : "");
}

/// LaTeX of characters that are not written as themselves
std::map<std::string, std::string> characters()
{
    std::map<std::string, std::string> all = {{"\\", "\\textbackslash{}"},
                                              {"~", "\\textasciitilde{}"},
                                              {"^", "\\textasciicircum{}"},
                                              {"\"", "''"},
                                              {"\u0304", ""}};
    for (const char c : std::string("_%&#${}")) all[{c}] = std::string("\\") + c;
    for (const char c : std::string("<>|")) all[{c}] = std::string("$") + c + '$';
    std::istringstream text("– -- — --- … \\dots{}"),
        math(
            "α \\alpha β \\beta γ \\gamma Δ \\Delta η \\eta θ \\theta Θ \\Theta λ \\lambda μ \\mu µ \\mu ν "
            "\\nu "
            "ρ \\rho σ \\sigma Φ \\Phi Ψ \\Psi ω \\omega π \\pi ε \\varepsilon ° ^\\circ ² ^2 ³ ^3 · \\cdot "
            "± \\pm ≤ \\le ≥ \\ge ‖ \\| ṙ \\dot{r}");
    for (std::string character, command; text >> character >> command;) all[character] = command;
    for (std::string character, command; math >> character >> command;) all[character] = '$' + command + '$';
    return all;
}

/// A text without numbers
std::string escaped(const std::string& text)
{
    static const std::map<std::string, std::string> known = characters();
    std::string out;
    for (size_t k = 0, length = 0; k < text.size(); k += length) {
        const auto first = static_cast<unsigned char>(text[k]);
        length = first < 0x80 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
        const std::string character = text.substr(k, length);
        const bool latin = first >= 0xC3 && first <= 0xC5;  // accented letters, which pdflatex reads
        if (const auto found = known.find(character); found != known.end())
            out += found->second;
        else if (first < 0x20 || first == 0x7F)
            out += ' ';
        else
            out += first < 0x80 || latin ? character : "?";
    }
    return out;
}

}  // namespace

std::string latex(const std::string& text)
{
    if (text == "-") return "--";
    if (std::string cell = number_cell(text); !cell.empty()) return cell;
    static const std::regex form(R"((^|[^\w.])(\d+(?:\.\d+)?)e([-+]?\d{1,3})(?![\w.]))");
    std::string out, rest = text;
    for (std::smatch m; std::regex_search(rest, m, form); rest = m.suffix())
        out += escaped(m.prefix().str() + m[1].str()) + '$' + power_of_ten(m[2], m[3]) + '$';
    return out + escaped(rest);
}

std::string latex_table(const std::vector<std::vector<std::string>>& rows, const std::string& caption,
                        const std::string& label)
{
    const size_t columns = rows.front().size();
    std::string alignment, lines;
    for (size_t c = 0; c < columns; ++c) {
        const auto is_number = [c](const auto& row) {
            return row[c].empty() || row[c] == "-" || !number_cell(row[c]).empty();
        };
        alignment += rows.size() > 1 && std::all_of(rows.begin() + 1, rows.end(), is_number) ? 'r' : 'l';
    }
    for (const std::vector<std::string>& row : rows) {
        for (size_t c = 0; c < columns; ++c) {
            const std::string cell = latex(row[c]);
            // after \\ and a rule, [ and * would be read as their arguments
            const bool protect = c == 0 && (cell.starts_with('[') || cell.starts_with('*'));
            lines += (c == 0 ? "    " : " & ") + (protect ? "{}" + cell : cell);
        }
        lines += &row == rows.data() ? " \\\\\n    \\midrule\n" : " \\\\\n";
    }
    constexpr size_t wide = 8;  // such a table is set in a smaller size
    return "\\begin{table}\n  \\centering\n" +
           std::string(columns < wide ? "" : "  \\footnotesize\\setlength{\\tabcolsep}{3pt}\n") +
           "  \\caption{" + latex(caption) + "}\n  \\label{tab:" + label + "}\n  \\begin{tabular}{" +
           alignment + "}\n    \\toprule\n" + lines + "    \\bottomrule\n  \\end{tabular}\n\\end{table}\n";
}

}  // namespace hilda::studies
