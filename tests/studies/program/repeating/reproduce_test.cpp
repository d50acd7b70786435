// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/repeating/reproduction.hpp"

#include "studies/framework/study.hpp"
#include "tests/support/program/program.hpp"
#include "tests/support/program/refused.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <regex>
#include <set>

using namespace hilda;
using Catch::Matchers::Contains;
using studies::Reproduction;

namespace {

/// The figures and tables that a text names
std::set<std::string> figures_in(const std::string& text)
{
    const std::regex number(R"((Table )?(\d+\.\d+))");
    std::set<std::string> figures;
    for (std::sregex_iterator at(text.begin(), text.end(), number), end; at != end; ++at)
        figures.insert(at->str());
    return figures;
}

/// The figures with a command in docs/results/dissertation-figures.md: the first column of its tables
std::set<std::string> figures_of_docs()
{
    std::istringstream page(
        tests::read(tests::fs::path(tests::source_dir) / "docs/results/dissertation-figures.md"));
    std::set<std::string> figures;
    for (std::string line; std::getline(page, line);) {
        if (!std::regex_search(line, std::regex(R"(^\| (Table )?\d)")) ||
            line.find("`hilda study") == std::string::npos)
            if (line.find("| the same |") == std::string::npos) continue;
        figures.merge(figures_in(line.substr(1, line.find('|', 1) - 1)));
    }
    return figures;
}

/// index.html of hilda reproduce
class Page {
public:
    /// The row of a study in the table at the top, and its section
    struct Entry {
        std::string chapter, figures, title, criteria, status, time;
        std::string section;
    };

    explicit Page(const tests::fs::path& directory) : text(tests::read(directory / "index.html")) {}

    std::string text;

    /// Requires that the study has one row and one section, which agree.
    Entry study(const std::string& name) const
    {
        CAPTURE(name);
        const std::regex row(
            R"re(<tr><td>(\d+)</td><td>([^<]*)</td><td><a href="#)re" + name +
            R"re(">([^<]*)</a></td><td>([^<]*)</td><td><span class="([^"]*)">([^<]*)</span></td>)re"
            R"re(<td class="number">([^<]*)</td></tr>)re");
        const std::sregex_iterator first(text.begin(), text.end(), row);
        REQUIRE(std::distance(first, std::sregex_iterator()) == 1);
        const std::smatch& m = *first;
        Entry e{.chapter = m[1],
                .figures = m[2],
                .title = m[3],
                .criteria = m[4],
                .status = m[6],
                .time = m[7],
                .section = {}};
        const std::string begin = "<section id=\"" + name + "\">";
        const size_t at = text.find(begin), end = text.find("</section>", at);
        REQUIRE(at != std::string::npos);
        CHECK(text.find(begin, at + 1) == std::string::npos);
        e.section = text.substr(at, end - at);
        CHECK_THAT(e.section, Contains("<h2>" + e.figures + ": " + e.title + "</h2>"));
        CHECK_THAT(e.section, Contains(">" + e.status + "</span>, " +
                                       (e.time == "-" ? "no time" : "time " + e.time) + "."));
        return e;
    }
};

/// Number of criteria in a section with this status
long criteria(const std::string& section, const std::string& status)
{
    const std::regex row(R"re(<tr><td>[^<]+</td>(<td class="number">[^<]*</td>){3}<td><span class=")re" +
                         status + "\">" + status + "</span></td></tr>");
    return std::distance(std::sregex_iterator(section.begin(), section.end(), row), std::sregex_iterator());
}

}  // namespace

TEST_CASE("the list of hilda reproduce has all figures of the documentation", "[studies][reproduce]")
{
    std::set<std::string> list;
    for (const Reproduction& e : studies::reproductions()) list.merge(figures_in(e.figures));
    list.erase("8.2");  // a section
    const std::set<std::string> docs = figures_of_docs();
    CHECK(docs.size() > 30);
    CHECK(list == docs);
}

TEST_CASE("each entry of hilda reproduce names a study with --check, and its page", "[studies][reproduce]")
{
    std::set<std::string> names;
    for (const Reproduction& e : studies::reproductions()) {
        CAPTURE(e.name);
        CHECK(names.insert(e.name).second);
        const std::vector<std::string> quick = e.words(false), full = e.words(true);
        CHECK(std::any_of(studies::studies().begin(), studies::studies().end(),
                          [&](const studies::Study& study) { return study.name == quick[2]; }));
        CHECK(tests::fs::exists(tests::fs::path(tests::source_dir) / "docs/results" / (quick[2] + ".md")));
        CHECK(std::count(quick.begin(), quick.end(), "--check") == 1);
        CHECK((quick == full) == e.reduced.empty());
        CHECK((e.chapter >= 3 && e.chapter <= 8));
        CHECK(!e.title.empty());
        CHECK(!e.shows.empty());
    }
}

TEST_CASE("texts on the page of hilda reproduce are escaped", "[studies][reproduce]")
{
    CHECK(studies::html("a < b & \"c\" > d") == "a &lt; b &amp; &quot;c&quot; &gt; d");
    CHECK(studies::html("E \xC2\xB5s \xFF.") == "E \xC2\xB5s \xEF\xBF\xBD.");
}

TEST_CASE("wrong options of hilda reproduce are refused before the first study", "[studies][reproduce]")
{
    const tests::Scratch in;
    const auto refused = [&](const std::vector<std::string>& more, const std::string& message) {
        tests::check_refused(in, tests::with({"reproduce", "--output", "a"}, more), 2, message);
    };
    refused({"--chapter", "6"}, "--chapter must be one of 3, 4, 5, 7, 8, got 6");
    refused({"--chapter", "three"}, "--chapter");
    refused({"--quick", "--full"}, "exclude each other");
    refused({"--resume"}, "has no interrupted reproduction");
    refused({"--resume", "--force"}, "exclude each other");
    tests::write(in / "file", "x");
    tests::check_refused(in, {"reproduce", "--output", "file"}, 5, "file: exists and is not a directory");
}

TEST_CASE(
    "the page of hilda reproduce has each study of the chapter once, with its criteria, status and time",
    "[studies][reproduce]")
{
    const tests::Scratch in;
    const std::vector<std::string> command = {"reproduce", "--chapter", "5", "--output", "a"};
    const tests::Ended ended = tests::call(in, command);
    CAPTURE(ended.out, ended.err);
    REQUIRE(ended.code == 0);
    const Page page(in / "a");
    size_t studies_of_chapter = 0;
    for (const Reproduction& e : studies::reproductions()) {
        CAPTURE(e.name);
        if (e.chapter != 5) {
            CHECK(page.text.find("id=\"" + e.name + '"') == std::string::npos);
            continue;
        }
        ++studies_of_chapter;
        const Page::Entry entry = page.study(e.name);
        CHECK(entry.chapter == "5");
        CHECK(entry.figures == e.figures);
        CHECK(entry.title == e.title);
        CHECK(entry.status == "passed");
        CHECK(std::stod(entry.time) > 0);
        const auto checks = nlohmann::json::parse(tests::read(in / "a" / e.name / "study.json"))["checks"];
        const auto count = static_cast<long>(checks.size());
        CHECK(count > 10);
        CHECK(entry.criteria == std::to_string(count) + " of " + std::to_string(count));
        CHECK(criteria(entry.section, "passed") == count);
        CHECK(criteria(entry.section, "failed") == 0);
        for (const auto& check : checks)
            CHECK_THAT(entry.section, Contains("<tr><td>" + studies::html(check["what"]) + "</td>"));
        CHECK_THAT(entry.section, Contains("<p>" + studies::html(e.shows) + "</p>"));
        CHECK_THAT(entry.section, Contains("<code>hilda study " + e.study + "</code>"));
        // each figure of the study is on the page, and each figure of the page exists
        const std::regex image("<img src=\"([^\"]*)\"");
        std::set<std::string> shown, drawn;
        for (std::sregex_iterator at(entry.section.begin(), entry.section.end(), image), end; at != end;
             ++at) {
            shown.insert((*at)[1]);
            CHECK(tests::fs::file_size(in / "a" / (*at)[1].str()) > 1000);
        }
        for (const auto& file : tests::fs::directory_iterator(in / "a" / e.name))
            if (file.path().extension() == ".png")
                drawn.insert(e.name + '/' + file.path().filename().string());
        CHECK(shown == drawn);
        if (shown.empty()) CHECK_THAT(entry.section, Contains("No figure. "));
    }
    CHECK(studies_of_chapter == 2);
    CHECK_THAT(page.text, Contains("<tr><th>result</th><td>2 passed</td></tr>"));
}

TEST_CASE("a criterion that is not satisfied is shown as failed, and hilda reproduce exits with 6",
          "[studies][reproduce]")
{
    const tests::Scratch in;
    const std::vector<std::string> command = {"reproduce", "--chapter", "5", "--no-plot", "--output", "a"};
    REQUIRE(tests::call(in, command).code == 0);
    // The results of the study with one wrong number: --resume reads the results and runs nothing.
    auto study = nlohmann::ordered_json::parse(tests::read(in / "a/evolving-friction/study.json"));
    auto& check = study["checks"][3];
    check["measured"] = check["measured"].get<double>() + 1000;
    check["passed"] = false;
    tests::write(in / "a/evolving-friction/study.json", study.dump(1));
    const tests::Ended ended = tests::call(in, tests::with(command, {"--resume"}));
    CAPTURE(ended.out, ended.err);
    CHECK(ended.code == 6);
    CHECK_THAT(ended.out, Contains("1 passed, 1 failed, 0 without criterion, 0 with an error"));
    const Page page(in / "a");
    CHECK(page.study("evolving-contact").status == "passed");
    const Page::Entry failed = page.study("evolving-friction");
    const long count = static_cast<long>(study["checks"].size());
    CHECK(failed.status == "failed");
    CHECK(failed.criteria == std::to_string(count - 1) + " of " + std::to_string(count));
    CHECK(criteria(failed.section, "failed") == 1);
    CHECK(criteria(failed.section, "passed") == count - 1);
    const size_t row = failed.section.find("<tr><td>" + studies::html(check["what"]) + "</td>");
    REQUIRE(row != std::string::npos);
    CHECK_THAT(failed.section.substr(row, failed.section.find("</tr>", row) - row),
               Contains("class=\"failed\""));
}

TEST_CASE("an interrupted reproduction continues, and finished studies are kept",
          "[studies][reproduce][resume]")
{
    const tests::Scratch in;
    const std::vector<std::string> command = {"reproduce", "--chapter", "5",        "--no-plot",
                                              "--jobs",    "1",         "--output", "a"};
    // At the third record of the second study the program gets the signal, which it passes on to the study.
    const tests::Ended ended =
        tests::call(in, command, {.end_at = {-SIGTERM, 4, "a/evolving-friction/study.part"}});
    CAPTURE(ended.out, ended.err);
    REQUIRE(ended.code == 143);
    CHECK_THAT(ended.out, Contains("interrupted; the same command with --resume continues"));
    Page page(in / "a");
    CHECK(page.study("evolving-contact").status == "passed");
    CHECK(page.study("evolving-friction").status == "interrupted");
    const auto kept = tests::fs::last_write_time(in / "a/evolving-contact/study.csv");
    const auto records = tests::fs::file_size(in / "a/evolving-friction/study.part");
    CHECK(records > 100);

    const std::vector<std::string> again = tests::with(command, {"--resume"});
    const tests::Ended resumed = tests::call(in, again);
    CAPTURE(resumed.out, resumed.err);
    REQUIRE(resumed.code == 0);
    CHECK_THAT(resumed.out, Contains("[ 1/1] evolving-friction") && Contains("2 passed"));
    page = Page(in / "a");
    for (const char* study : {"evolving-contact", "evolving-friction"})
        CHECK(page.study(study).status == "passed");
    REQUIRE(tests::call(in, again).code == 0);  // nothing is run again
    CHECK(tests::fs::last_write_time(in / "a/evolving-contact/study.csv") == kept);
    CHECK(Page(in / "a").text.find("not run") == std::string::npos);
    tests::check_refused(in, tests::with(again, {"--full"}), 2, "--resume needs the same mode: ");
}

TEST_CASE("hilda reproduce counts the studies without a figure, and --resume draws them",
          "[studies][reproduce][resume]")
{
    const tests::Scratch in;
    if (tests::call(in, {"info"}).out.find("matplotlib 3") == std::string::npos) return;
    const std::vector<std::string> command = {"reproduce", "--chapter", "5", "--output", "a"};
    const tests::Ended without = tests::call(in, command, {.python = "/nowhere/python3"});
    CAPTURE(without.out, without.err);
    REQUIRE(without.code == 0);
    CHECK_THAT(
        without.out,
        Contains("; no figure: hilda: warning: no figures: ") &&
            Contains("2 passed, 0 failed, 0 without criterion, 0 with an error, 2 without a figure; "));
    CHECK_THAT(without.err,
               Contains("hilda: warning: 2 studies without a figure; the same command with --resume draws"));
    const auto computed = tests::fs::last_write_time(in / "a/evolving-contact/study.csv");

    const tests::Ended drawn = tests::call(in, tests::with(command, {"--resume"}));
    CAPTURE(drawn.out, drawn.err);
    CHECK(drawn.code == 0);
    CHECK(drawn.out.find("without a figure") == std::string::npos);
    CHECK(drawn.err.find("without a figure") == std::string::npos);
    CHECK(tests::fs::last_write_time(in / "a/evolving-contact/study.csv") == computed);
    CHECK_THAT(Page(in / "a").study("evolving-contact").section, Contains("<img src=\"evolving-contact/"));
}

TEST_CASE("a reproduction that is interrupted between two studies continues with the next one",
          "[studies][reproduce][resume]")
{
    const tests::Scratch in;
    const std::vector<std::string> command = {"reproduce", "--chapter", "5",        "--no-plot",
                                              "--jobs",    "1",         "--output", "a"};
    // The page is written at the start and after each study.
    const tests::Ended ended = tests::call(in, command, {.end_at = {SIGINT, 2, "a/index.html.tmp"}});
    CAPTURE(ended.out, ended.err);
    REQUIRE(ended.code == 130);
    const Page page(in / "a");
    CHECK(page.study("evolving-contact").status == "passed");
    CHECK(page.study("evolving-friction").status == "not run");
    CHECK_FALSE(tests::fs::exists(in / "a/evolving-friction"));
    const tests::Ended resumed = tests::call(in, tests::with(command, {"--resume"}));
    CHECK(resumed.code == 0);
    CHECK_THAT(resumed.out, Contains("[ 1/1] evolving-friction") && Contains("2 passed"));
}

TEST_CASE("a study that ends with an error does not end the others, and runs again with --resume",
          "[studies][reproduce]")
{
    const tests::Scratch in;
    const std::vector<std::string> command = {"reproduce", "--chapter", "5", "--no-plot", "--output", "a"};
    const tests::Ended full = tests::call(in, command, {.file_bytes = 60 * 1024});  // as on a full disk
    CAPTURE(full.out, full.err);
    CHECK(full.code == 5);
    CHECK_THAT(full.out, Contains("[ 2/2]") && Contains("2 with an error") && Contains("File too large"));
    CHECK_THAT(tests::read(in / "a/index.html"), Contains("study.part: cannot be written: File too large"));
    std::vector<std::string> again = command;
    again.emplace_back("--resume");
    CHECK(tests::call(in, again).code == 0);
    CHECK_THAT(tests::read(in / "a/index.html"), Contains("2 passed"));
}
