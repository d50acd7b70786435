// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/reproduction_page.hpp"

#include "studies/framework/study.hpp"
#include "tests/studies/program.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <regex>
#include <set>

using namespace hilda;
using Catch::Matchers::Contains;
using studies::Reproduction;

namespace {

std::set<std::string> figures_of_list()
{
    std::set<std::string> figures;
    for (const Reproduction& e : studies::reproductions()) figures.insert(e.figures.begin(), e.figures.end());
    return figures;
}

/// The figures with a command in docs/results/dissertation-figures.md: the first column of its tables
std::set<std::string> figures_of_docs()
{
    std::istringstream page(
        tests::read(tests::fs::path(tests::source_dir) / "docs/results/dissertation-figures.md"));
    const std::regex number(R"((Table )?(\d+\.\d+))");
    std::set<std::string> figures;
    for (std::string line; std::getline(page, line);) {
        if (!std::regex_search(line, std::regex(R"(^\| (Table )?\d)")) ||
            line.find("`hilda study") == std::string::npos)
            if (line.find("| the same |") == std::string::npos) continue;
        const std::string first = line.substr(1, line.find('|', 1) - 1);
        for (std::sregex_iterator at(first.begin(), first.end(), number), end; at != end; ++at)
            figures.insert(at->str());
    }
    return figures;
}

}  // namespace

TEST_CASE("the list of hilda reproduce has all figures of the documentation", "[studies][reproduce]")
{
    const std::set<std::string> list = figures_of_list(), docs = figures_of_docs();
    CHECK(docs.size() > 30);
    for (const std::string& figure : docs) {
        CAPTURE(figure);
        CHECK(list.count(figure) == 1);
    }
    for (const std::string& figure : list) {
        CAPTURE(figure);
        CHECK((docs.count(figure) == 1 || figure == "Sec. 8.2"));
    }
}

TEST_CASE("each entry of hilda reproduce names a study, its page and how it is judged",
          "[studies][reproduce]")
{
    std::set<std::string> names;
    for (const Reproduction& e : studies::reproductions()) {
        CAPTURE(e.name);
        CHECK(names.insert(e.name).second);
        CHECK(std::any_of(studies::studies().begin(), studies::studies().end(),
                          [&](const studies::Study& study) { return study.name == e.study; }));
        CHECK(tests::fs::exists(tests::fs::path(tests::source_dir) / "docs/results" / e.page));
        const bool checked = std::count(e.arguments.begin(), e.arguments.end(), "--check") > 0;
        CHECK((checked || !e.checks.empty()));
        CHECK((e.quick == e.full) == e.reduced.empty());
        CHECK((e.chapter >= 3 && e.chapter <= 8));
        CHECK(!e.title.empty());
        CHECK(!e.shows.empty());
    }
}

TEST_CASE("a criterion of hilda reproduce is the worst of the selected rows", "[studies][reproduce]")
{
    Reproduction e;
    const std::string table =
        "problem,integrator,h,error,status\n"
        "bar,half,0.001,1,ok\nbar,half,1e-2,3,ok\nbar,full,0.01,6,ok\nrod,half,0.001,-9,ok\n";
    const auto measured = [&](const studies::ReproductionCheck& check) {
        e.checks = {check};
        return studies::evaluate_checks(e, table, "study.csv").at(0);
    };
    const auto both = measured({.what = "x",
                                .column = "error",
                                .where = {{"problem", "bar"}, {"integrator", "half"}},
                                .least = 0,
                                .most = 2});
    CHECK(both.measured == 3);
    CHECK_FALSE(both.passed());
    CHECK(measured({.what = "x",
                    .column = "error",
                    .where = {{"h", "1e-3"}, {"problem", "bar"}},
                    .least = 0,
                    .most = 2})
              .passed());
    CHECK(measured({.what = "x", .column = "error", .where = {}, .least = -5, .most = 7}).measured == -9);
    CHECK(measured({.what = "x",
                    .column = "error",
                    .where = {{"h", "0.01"}, {"integrator", "half"}},
                    .least = 0,
                    .most = 1,
                    .relative_to = "full"})
              .measured == 0.5);
    // no row, no such column, no other row: NaN, which fails
    for (const auto& check :
         {studies::ReproductionCheck{.what = "x", .column = "error", .where = {{"h", "7"}}},
          studies::ReproductionCheck{.what = "x", .column = "no", .where = {}},
          studies::ReproductionCheck{
              .what = "x", .column = "error", .where = {{"problem", "rod"}}, .relative_to = "full"}}) {
        const auto criterion = measured(check);
        CHECK(std::isnan(criterion.measured));
        CHECK_FALSE(criterion.passed());
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
    const auto refused = [&](const std::vector<std::string>& more, const std::string& why) {
        std::vector<std::string> all = {"reproduce", "--output", "a"};
        all.insert(all.end(), more.begin(), more.end());
        const tests::Ended ended = tests::call(in, all);
        CAPTURE(more, ended.err);
        CHECK(ended.code == 2);
        CHECK_THAT(ended.err, Contains(why));
        CHECK_FALSE(tests::fs::exists(in / "a"));
    };
    refused({"--chapter", "6"}, "--chapter must be one of 3, 4, 5, 7, 8, got 6");
    refused({"--chapter", "three"}, "--chapter");
    refused({"--quick", "--full"}, "exclude each other");
    refused({"--resume"}, "has no interrupted reproduction");
    refused({"--resume", "--force"}, "exclude each other");
    tests::write(in / "file", "x");
    CHECK(tests::call(in, {"reproduce", "--output", "file"}).code == 5);
}

TEST_CASE("an interrupted reproduction continues, and finished studies are kept",
          "[studies][reproduce][resume]")
{
    const tests::Scratch in;
    const std::vector<std::string> command = {"reproduce", "--chapter", "5",        "--no-plot",
                                              "--jobs",    "1",         "--output", "a"};
    const tests::Program program(in, command);
    REQUIRE(tests::appears(in / "a/evolving-friction/study.part"));
    program.send(SIGTERM);
    const tests::Ended ended = program.wait();
    CAPTURE(ended.out, ended.err);
    if (ended.code != 0) CHECK(ended.code == 143);
    CHECK_THAT(tests::read(in / "a/index.html"),
               Contains("not run") || Contains("interrupted") || Contains("passed"));

    std::vector<std::string> again = command;
    again.emplace_back("--resume");
    const tests::Ended resumed = tests::call(in, again);
    CAPTURE(resumed.out, resumed.err);
    REQUIRE(resumed.code == 0);
    const std::string page = tests::read(in / "a/index.html");
    CHECK_THAT(page, Contains("2 passed") && !Contains("not run"));
    const auto time = tests::fs::last_write_time(in / "a/evolving-contact/study.csv");
    REQUIRE(tests::call(in, again).code == 0);  // nothing is run again
    CHECK(tests::fs::last_write_time(in / "a/evolving-contact/study.csv") == time);
    std::vector<std::string> full = again;
    full.emplace_back("--full");
    CHECK(tests::call(in, full).code == 2);
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
