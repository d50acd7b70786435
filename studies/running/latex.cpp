// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/running/latex.hpp"

#include "io/formats/characters.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <string_view>

namespace hilda::studies {

namespace {

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.'; }

/// The parts of an unsigned number at the beginning of a text
struct Number {
    std::string_view mantissa, exponent;  ///< "1.5" and "-03"; no exponent: ""
    size_t length = 0;                    ///< 0: the text does not begin with a number
};

Number number_at(std::string_view text)
{
    size_t k = 0;
    const auto digits = [&] {
        while (k < text.size() && io::is_digit(text[k])) ++k;
    };
    digits();
    if (k == 0) return {};
    if (k + 1 < text.size() && text[k] == '.' && io::is_digit(text[k + 1])) ++k, digits();
    Number number{text.substr(0, k), {}, k};
    if (k < text.size() && text[k] == 'e') {
        size_t begin = ++k;
        if (k < text.size() && (text[k] == '-' || text[k] == '+')) ++k;
        const size_t first = k;
        digits();
        if (k > first) number.exponent = text.substr(begin, k - begin), number.length = k;
    }
    return number;
}

std::string math(const Number& number)
{
    if (number.exponent.empty()) return std::string(number.mantissa);
    const int exponent = std::stoi(std::string(number.exponent));
    return std::string(number.mantissa) + "\\times10^{" + std::to_string(exponent) + "}";
}

/// A whole cell that is a number with an optional sign, a bound and a mark, such as "+42.5", "<= 0.85",
/// "1.2e-04*"
std::string number_cell(std::string_view cell)
{
    std::string before;
    if (cell.starts_with("<= ")) before = "\\le ", cell.remove_prefix(3);
    if (!cell.empty() && (cell.front() == '-' || cell.front() == '+'))
        before += cell.front(), cell.remove_prefix(1);
    const Number number = number_at(cell);
    const std::string_view mark = cell.substr(std::min(number.length, cell.size()));
    if (number.length == 0 || !(mark.empty() || mark == "*" || mark == " ")) return {};
    return '$' + before + math(number) + '$' + (mark == "*" ? "*" : "");
}

/// LaTeX of the UTF-8 character at the beginning of a text, and its length
std::pair<std::string, size_t> character(std::string_view text)
{
    static const std::map<std::string_view, std::string> known = {
        {"\\", "\\textbackslash{}"},
        {"_", "\\_"},
        {"%", "\\%"},
        {"&", "\\&"},
        {"#", "\\#"},
        {"$", "\\$"},
        {"{", "\\{"},
        {"}", "\\}"},
        {"~", "\\textasciitilde{}"},
        {"^", "\\textasciicircum{}"},
        {"<", "$<$"},
        {">", "$>$"},
        {"|", "$|$"},
        {"\n", " "},
        {"\"", "''"},
        {"α", "$\\alpha$"},
        {"β", "$\\beta$"},
        {"γ", "$\\gamma$"},
        {"Δ", "$\\Delta$"},
        {"η", "$\\eta$"},
        {"θ", "$\\theta$"},
        {"Θ", "$\\Theta$"},
        {"λ", "$\\lambda$"},
        {"μ", "$\\mu$"},
        {"µ", "$\\mu$"},
        {"ν", "$\\nu$"},
        {"ρ", "$\\rho$"},
        {"σ", "$\\sigma$"},
        {"Φ", "$\\Phi$"},
        {"Ψ", "$\\Psi$"},
        {"ω", "$\\omega$"},
        {"π", "$\\pi$"},
        {"ε", "$\\varepsilon$"},
        {"°", "$^\\circ$"},
        {"²", "$^2$"},
        {"³", "$^3$"},
        {"·", "$\\cdot$"},
        {"±", "$\\pm$"},
        {"≤", "$\\le$"},
        {"≥", "$\\ge$"},
        {"–", "--"},
        {"—", "---"},
        {"…", "\\dots{}"},
        {"‖", "$\\|$"},
        {"ṙ", "$\\dot r$"},
        {"\u0304", ""}};  // the last one: a combining bar
    const auto first = static_cast<unsigned char>(text.front());
    const size_t length = std::min<size_t>(text.size(), first < 0x80   ? 1
                                                        : first < 0xE0 ? 2
                                                        : first < 0xF0 ? 3
                                                                       : 4);
    const auto found = known.find(text.substr(0, length));
    if (found != known.end()) return {found->second, length};
    const bool latin = first >= 0xC3 && first <= 0xC5;  // accented letters, which pdflatex reads
    if (first >= 0x80 && !latin) return {"?", length};
    if (first < 0x20 || first == 0x7F) return {" ", length};
    return {std::string(text.substr(0, length)), length};
}

}  // namespace

std::string latex(const std::string& text)
{
    if (text == "-") return "--";
    if (std::string cell = number_cell(text); !cell.empty()) return cell;
    std::string out;
    for (size_t k = 0; k < text.size();) {
        const std::string_view rest = std::string_view(text).substr(k);
        const Number number = k > 0 && is_word(text[k - 1]) ? Number{} : number_at(rest);
        const bool ends =
            number.length == rest.size() || (number.length > 0 && !is_word(rest[number.length]));
        if (number.length > 0 && !number.exponent.empty() && ends) {
            out += '$' + math(number) + '$';
            k += number.length;
            continue;
        }
        const auto [written, length] = character(rest);
        out += written;
        k += length;
    }
    return out;
}

std::string latex_table(const std::vector<std::vector<std::string>>& rows, const std::string& caption,
                        const std::string& label)
{
    const size_t columns = rows.front().size();
    std::string alignment;
    for (size_t c = 0; c < columns; ++c)
        alignment += rows.size() > 1 && std::all_of(rows.begin() + 1, rows.end(),
                                                    [c](const auto& row) {
                                                        return row[c].empty() || row[c] == "-" ||
                                                               !number_cell(row[c]).empty();
                                                    })
                         ? 'r'
                         : 'l';
    constexpr size_t wide = 8;  // such a table is set in a smaller size
    std::string out = "\\begin{table}\n  \\centering\n" +
                      std::string(columns < wide ? "" : "  \\footnotesize\\setlength{\\tabcolsep}{3pt}\n") +
                      "  \\caption{" + latex(caption) + "}\n  \\label{tab:" + label +
                      "}\n  \\begin{tabular}{" + alignment + "}\n    \\toprule\n";
    for (size_t r = 0; r < rows.size(); ++r) {
        out += "    ";
        for (size_t c = 0; c < columns; ++c) {
            std::string cell = latex(rows[r][c]);
            // after \\ and a rule, [ and * would be read as their arguments
            if (c == 0 && (cell.starts_with('[') || cell.starts_with('*'))) cell = "{}" + cell;
            out += (c == 0 ? "" : " & ") + cell;
        }
        out += " \\\\\n";
        if (r == 0) out += "    \\midrule\n";
    }
    return out + "    \\bottomrule\n  \\end{tabular}\n\\end{table}\n";
}

}  // namespace hilda::studies
