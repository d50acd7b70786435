// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/latex.hpp"

#include "studies/framework/table.hpp"
#include "tests/support/program/program.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <regex>

using namespace hilda;
using namespace hilda::tests;
using Catch::Matchers::Contains;
using studies::latex;

namespace {

/// Faults of a LaTeX text of tables: unbalanced braces, environments or $, unescaped special characters, rows
/// with another number of cells than their tabular has columns
std::vector<std::string> faults(const std::string& text)
{
    std::vector<std::string> all, open;
    size_t columns = 0;
    long braces = 0;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with('%')) continue;
        std::smatch found;
        if (std::regex_search(line, found, std::regex(R"(\\begin\{(\w+)\})"))) open.push_back(found[1]);
        if (std::regex_search(line, found, std::regex(R"(\\begin\{tabular\}\{([lrc]+)\})")))
            columns = static_cast<size_t>(found[1].length());
        if (std::regex_search(line, found, std::regex(R"(\\end\{(\w+)\})"))) {
            if (open.empty() || open.back() != found[1])
                all.push_back("end of " + found[1].str());
            else
                open.pop_back();
        }
        const bool row = line.ends_with("\\\\");
        size_t cells = 1, dollars = 0;
        for (size_t k = 0; k < line.size(); ++k) {
            const char c = line[k];
            if (c == '\\') {  // an escaped character or a command
                ++k;
                continue;
            }
            braces += (c == '{') - (c == '}');
            dollars += c == '$';
            cells += c == '&';
            const bool command_line = line.find("\\label") != std::string::npos;
            if ((c == '#' || c == '%' || c == '~') ||
                ((c == '_' || c == '^') && dollars % 2 == 0 && !command_line))
                all.push_back("unescaped '" + std::string(1, c) + "' in " + line);
            if (static_cast<unsigned char>(c) >= 0x80 && (static_cast<unsigned char>(c) & 0xC0) == 0xC0 &&
                c != '\xC3' && c != '\xC4' && c != '\xC5')
                all.push_back("a character that pdflatex does not know in " + line);
        }
        if (dollars % 2 != 0) all.push_back("odd number of $ in " + line);
        if (row && cells != columns) all.push_back(std::to_string(cells) + " cells: " + line);
        if (!row && cells > 1) all.push_back("& outside a row: " + line);
        if (braces != 0) all.push_back("braces: " + line), braces = 0;
    }
    if (!open.empty()) all.push_back("open " + open.back());
    return all;
}

}  // namespace

TEST_CASE("numbers and special characters of a cell are written for LaTeX", "[studies][latex]")
{
    const std::vector<std::pair<std::string, std::string>> all = {
        {"1.806e-04", R"($1.806\times10^{-4}$)"},
        {"-9.1e-07", R"($-9.1\times10^{-7}$)"},
        {"1e+10", R"($1\times10^{10}$)"},
        {"+42.49", "$+42.49$"},
        {"0", "$0$"},
        {"1.2e-04*", R"($1.2\times10^{-4}$*)"},
        {"1.2e-04 ", R"($1.2\times10^{-4}$)"},
        {"<= 0.85", R"($\le 0.85$)"},
        {"-", "--"},
        {"", ""},
        {"rA-half-1", "rA-half-1"},
        {"n_pendulum_8", R"(n\_pendulum\_8)"},
        {"a_b%&#$", R"(a\_b\%\&\#\$)"},
        {R"(a{b}\c~d^e)", R"(a\{b\}\textbackslash{}c\textasciitilde{}d\textasciicircum{}e)"},
        {"max |E-E0| [J]", "max $|$E-E0$|$ [J]"},
        {"h = 1e-3 s", R"(h = $1\times10^{-3}$ s)"},
        {"r [m] at 2.5e-4 s", R"(r [m] at $2.5\times10^{-4}$ s)"},
        {"1e", "1e"},
        {"1e-", "1e-"},
        {"0x1e5", "0x1e5"},
        {"1, 1", "1, 1"},
        {"nan", "nan"},
        {"CPU [µs], η_r ≤ 3°", R"(CPU [$\mu$s], $\eta$\_r $\le$ 3$^\circ$)"},
        {"Büchi", "Büchi"},
        {"球 \x01", "?  "},
    };
    for (const auto& [text, expected] : all) {
        CAPTURE(text);
        CHECK(latex(text) == expected);
    }
}

TEST_CASE("a table has a row for each row, and its columns of numbers are right-aligned", "[studies][latex]")
{
    const std::string text = studies::latex_table(
        {{"name", "[m]", "50 %"}, {"[a", "1e-3", "x"}, {"*b", "-", "2"}}, "50 % of A_1", "t");
    CHECK(faults(text).empty());
    CHECK_THAT(text, Contains("{lrl}") && Contains("{}[a & $1\\times10^{-3}$ & x \\\\") &&
                         Contains("{}*b & -- & $2$") && Contains("\\caption{50 \\% of A\\_1}") &&
                         Contains("50 \\% \\\\\n    \\midrule"));
    CHECK_FALSE(faults("\\begin{tabular}{ll}\n a & b & c \\\\\n\\end{tabular}").empty());
    CHECK_FALSE(faults("\\caption{a_b}").empty());
    CHECK_FALSE(faults("\\caption{a}}").empty());
    CHECK(studies::latex_table({{"a", "b"}}, "", "t").find("{ll}") != std::string::npos);  // no rows
}

TEST_CASE("the text of a study keeps the tables that are printed to it, with their titles",
          "[studies][latex]")
{
    studies::StudyText out;
    studies::Table table({{"a"}, {"b", "{:.1f}"}});
    table.add({std::string("x"), 1.25});
    table.print(out);
    out << "\nfirst paragraph\n\ntitle of\ntwo lines\n";
    table.print(out);
    REQUIRE(out.tables.size() == 2);
    CHECK(out.tables[0].title.empty());
    CHECK(out.tables[1].title == "title of\ntwo lines");
    CHECK(out.tables[1].rows == std::vector<std::vector<std::string>>{{"a", "b"}, {"x", "1.2"}});
    CHECK(out.str() == "a    b\nx  1.2\n\nfirst paragraph\n\ntitle of\ntwo lines\na    b\nx  1.2\n");
}

TEST_CASE("study.tex of a study is valid LaTeX with the rows of its tables", "[studies][latex]")
{
    const Scratch in;
    const std::vector<std::vector<std::string>> calls = {
        {"energy", "--problem", "double_pendulum,single_pendulum", "--end", "0.1"},
        {"compare", "--end", "0.1", "--set", "/name=a_b%&#"},
        {"convergence", "--problem", "double_pendulum", "--end", "1", "--steps", "4e-3,2e-3", "--integrator",
         "rA-half-1"},
        {"friction", "--problem", "brick", "--check"},
        {"granular-oblique"}};
    for (const auto& arguments : calls) {
        std::vector<std::string> words = {"study"};
        words.insert(words.end(), arguments.begin(), arguments.end());
        words.insert(words.end(), {"--no-plot", "--latex", "--output", arguments[0]});
        const Ended ended = call(in, words);
        CAPTURE(arguments[0], ended.err);
        CHECK(ended.code == 0);
        CHECK_THAT(ended.out, Contains(" study.tex"));
        const std::string text = read(in / (arguments[0] + "/study.tex"));
        for (const std::string& fault : faults(text)) FAIL_CHECK(fault);
        CHECK_THAT(text, Contains("\\toprule") && Contains("\\caption{") &&
                             Contains("\\label{tab:" + arguments[0] + "-1}"));
    }
    const std::string energy = read(in / "energy/study.tex");
    CHECK_THAT(energy,
               Contains("\\caption{Energy over time") && Contains("double\\_pendulum, end time 0.1 s"));
    // without the option the file of the earlier study is removed
    CHECK(call(in, {"study", "energy", "--problem", "double_pendulum", "--end", "0.1", "--no-plot", "--force",
                    "--quiet", "--output", "energy"})
              .code == 0);
    CHECK_FALSE(fs::exists(in / "energy/study.tex"));
    CHECK(call(in, {"study", "energy", "--latex", "--json"}).code == 2);
}
