// SPDX-License-Identifier: GPL-3.0-or-later
/// Formats and choice of figures: --figure-format, --integrator and --quantity. What a figure shows is tested
/// by tests/studies/figures_test.py.

#include "studies/program/plot.hpp"
#include "tests/support/program/program.hpp"
#include "tests/support/program/refused.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::tests;
using Catch::Matchers::Contains;

namespace {

/// Pixels per metre of a PNG file, from its chunk pHYs
long pixels_per_metre(const std::string& png)
{
    const size_t at = png.find("pHYs");
    if (at == std::string::npos || at + 8 > png.size()) return 0;
    long value = 0;
    for (size_t k = at + 4; k < at + 8; ++k) value = 256 * value + static_cast<unsigned char>(png[k]);
    return value;
}

bool has_matplotlib(const Scratch& in)
{
    return call(in, {"info"}).out.find("matplotlib 3") != std::string::npos;
}

}  // namespace

TEST_CASE("a figure is written in each format of the option --figure-format, with embedded fonts",
          "[studies][figures]")
{
    const Scratch in;
    if (!has_matplotlib(in)) {
        WARN("no matplotlib here: no figure was drawn");
        return;
    }
    const Ended ended =
        call(in, {"study", "energy", "--problem", "double_pendulum", "--integrator", "rA-half-1,rA-half-2",
                  "--end", "0.2", "--figure-format", "png,pdf,svg", "--output", "a"});
    CAPTURE(ended.err);
    CHECK(ended.code == 0);
    for (const char* format : {"png", "pdf", "svg"}) {
        const std::string file = std::string("energy-double_pendulum.") + format;
        CHECK(fs::file_size(in / ("a/" + file)) > 4000);
        CHECK_THAT(ended.out, Contains(file));
    }
    CHECK(pixels_per_metre(read(in / "a/energy-double_pendulum.png")) >= 7874);  // 200 dots per inch
    const std::string pdf = read(in / "a/energy-double_pendulum.pdf");
    CHECK_THAT(pdf, Contains("/FontFile2"));  // an embedded TrueType font
    CHECK(pdf.find("/Type3") == std::string::npos);

    // another format removes the figures of the earlier run, and the same table gives the same file
    CHECK(call(in, {"study", "energy", "--problem", "double_pendulum", "--integrator", "rA-half-1,rA-half-2",
                    "--end", "0.2", "--figure-format", "pdf", "--output", "a", "--force"})
              .code == 0);
    CHECK_FALSE(fs::exists(in / "a/energy-double_pendulum.png"));
    CHECK(read(in / "a/energy-double_pendulum.pdf") == pdf);

    CHECK(call(in, {"run", "double_pendulum", "--end", "0.1", "--plot", "--figure-format", "svg", "--output",
                    "b"})
              .code == 0);
    CHECK_THAT(read(in / "b/summary.json"), Contains("trajectory.svg"));
    CHECK(fs::exists(in / "b/trajectory.svg"));
    CHECK_FALSE(fs::exists(in / "b/trajectory.png"));
    const Ended drawn = call(in, {"plot", "b", "--figure-format", "pdf", "--quantity", "energy,r"});
    CHECK(drawn.out == "written to b: trajectory.pdf\n");
}

TEST_CASE("hilda plot refuses a damaged table with its line", "[studies][figures]")
{
    const Scratch in;
    if (!has_matplotlib(in)) return;
    REQUIRE(call(in, {"run", "double_pendulum", "--end", "0.02", "--quiet", "--output", "a"}).code == 0);
    const std::string whole = read(in / "a/trajectory.csv");
    const auto line = [&](int number) {  // begin of a line, from 1
        size_t at = 0;
        while (--number > 0) at = whole.find('\n', at) + 1;
        return at;
    };
    const auto changed = [&](size_t at, size_t count, const std::string& by) {
        std::string text = whole;
        return text.replace(at, count, by);
    };
    const std::pair<std::string, std::string> damaged[] = {
        {changed(line(3), 5, "x"), "trajectory.csv:3: column t must be a number, got 'x'"},
        {changed(line(4), 0, "1,"), "trajectory.csv:4: must have "},
        {changed(0, 1, "s"), "trajectory.csv:1: has no column t"},
        {changed(0, whole.size(), "\xE1\xFF,b\n1,2\n"), "trajectory.csv: is not a CSV table in UTF-8"},
        {"", "trajectory.csv:1: must have the names of the columns, each once"},
        {whole.substr(0, line(2)), "trajectory.csv: has no rows"}};
    for (const auto& [text, message] : damaged) {
        write(in / "a/trajectory.csv", text);
        const Ended ended = call(in, {"plot", "a"});
        CAPTURE(ended.err);
        CHECK(ended.code == 3);
        CHECK_THAT(ended.err, Contains("hilda: error: a/" + message));
        CHECK_FALSE(fs::exists(in / "a/trajectory.png"));
    }
    // a run that goes on has written a part of its last row
    write(in / "a/trajectory.csv", whole + "0.021,1");
    CHECK(call(in, {"plot", "a"}).code == 0);
    CHECK_FALSE(fs::exists(in / "a/trajectory.png.new"));
}

TEST_CASE("a wrong figure option is refused before the first run", "[studies][figures]")
{
    const Scratch in;
    const std::vector<std::pair<std::vector<std::string>, std::string>> all = {
        {{"study", "energy", "--figure-format", "pngg"},
         "unknown format 'pngg'; did you mean 'png'? (formats: png, pdf"},
        {{"study", "energy", "--figure-format", "PDF"}, "did you mean 'pdf'?"},
        {{"study", "energy", "--figure-format", "docx"}, "unknown format 'docx' (formats: png, pdf, svg"},
        {{"study", "energy", "--figure-format", "png,png"}, "each format once"},
        {{"study", "energy", "--figure-format", "png,"}, "--figure-format"},
        {{"study", "energy", "--figure-format", ""}, "--figure-format"},
        {{"study", "energy", "--figure-format", "pdf", "--no-plot"}, "--no-plot draws none"},
        {{"study", "energy", "--figure-format", "pdf", "--json"}, "with --json they need --output"},
        {{"run", "double_pendulum", "--figure-format", "pdf"}, "it needs --plot"},
        {{"run", "double_pendulum", "--plot", "--figure-format", "sgv"}, "did you mean 'svg'?"},
        {{"plot", "a", "--figure-format", "pfd"}, "did you mean 'pdf'?"},
    };
    for (const auto& [arguments, expected] : all) check_refused(in, arguments, 2, expected);
}

TEST_CASE("an integrator or a quantity that the results do not have is refused with the nearest name",
          "[studies][figures]")
{
    const Scratch in;
    if (!has_matplotlib(in)) {
        WARN("no matplotlib here: no figure was drawn");
        return;
    }
    REQUIRE(call(in, {"study", "energy", "--problem", "double_pendulum", "--integrator",
                      "rA-half-1,rA-half-2", "--end", "0.1", "--no-plot", "--output", "a"})
                .code == 0);
    const std::vector<std::pair<std::vector<std::string>, std::string>> all = {
        {{"--integrator", "rA-half-3"}, "unknown name 'rA-half-3'; did you mean 'rA-half-"},
        {{"--integrator", "ida-rp"}, "known names: rA-half-1, rA-half-2"},
        {{"--quantity", "r"}, "--quantity is not an option of these figures"}};
    for (const auto& [options, expected] : all) check_refused(in, with({"plot", "a"}, options), 2, expected);
    CHECK(call(in, {"plot", "a", "--integrator", "rA-half-2"}).code == 0);
    CHECK(fs::exists(in / "a/energy-double_pendulum.png"));
}

namespace {

/// A Python that does something else than to draw
class OtherPython {
public:
    OtherPython(const Scratch& in, const std::string& script)
    {
        const std::string file = (in / "python").string();
        write(file, "#!/bin/sh\n" + script + "\n");
        fs::permissions(file, fs::perms::owner_all);
        setenv("HILDA_PYTHON", file.c_str(), 1);
    }
    ~OtherPython() { unsetenv("HILDA_PYTHON"); }
    OtherPython(const OtherPython&) = delete;
    OtherPython& operator=(const OtherPython&) = delete;
};

}  // namespace

TEST_CASE("a Python that fails without a message is reported, and no figure is listed", "[studies][figures]")
{
    const Scratch in;
    const std::pair<std::string, std::string> all[] = {
        {"exit 1", "ended with the exit code 1 and without a message"},
        {"kill -9 $$", "was ended by signal 9 (Killed)"},
        {"exit 0", "has written none"},
        {"echo trajectory.png", "has written none: trajectory.png"},
        {"echo trajectory.png; kill -11 $$", "was ended by signal 11"}};
    for (const auto& [script, expected] : all) {
        const OtherPython python(in, script);
        const Ended ended =
            call(in, {"run", "double_pendulum", "--end", "0.01", "--plot", "--output", "a", "--force"});
        CAPTURE(script, ended.err);
        CHECK(ended.code == 0);
        CHECK_THAT(ended.err, Contains("hilda: warning: no figures: ") && Contains(expected));
        CHECK(std::count(ended.err.begin(), ended.err.end(), '\n') == 1);
        CHECK_THAT(read(in / "a/summary.json"), !Contains("trajectory.png"));
        CHECK(call(in, {"plot", "a"}).code == 7);
    }
}

TEST_CASE("a signal ends a Python that draws without an end", "[studies][figures]")
{
    const Scratch in;
    REQUIRE(call(in, {"run", "double_pendulum", "--end", "0.01", "--output", "a"}).code == 0);
    const std::string python = (in / "python").string(), started = (in / "started").string();
    // one that is silent, one that writes without an end, and one that has closed its output
    const char* script = GENERATE("exec sleep 1000", "while true; do echo trajectory.png; done",
                                  "exec >&- 2>&-; exec sleep 1000");
    const int signal = GENERATE(SIGINT, SIGTERM);
    write(python, "#!/bin/sh\necho $$ > " + started + "\n" + script + "\n");
    fs::permissions(python, fs::perms::owner_all);
    const auto interrupted = [&](const std::vector<std::string>& arguments) {
        fs::remove(started);
        const Program program(in, arguments, {.python = python});
        REQUIRE(appears(started));
        program.send(signal);
        Ended ended = program.wait();
        CHECK(kill(std::stoi(read(started)), 0) != 0);  // The program has waited for the end of Python.
        return ended;
    };
    CAPTURE(script, signal);
    CHECK(interrupted({"plot", "a"}).code == 128 + signal);

    // The results of the run are complete.
    const Ended run =
        interrupted({"run", "double_pendulum", "--end", "0.01", "--plot", "--output", "b", "--force"});
    CHECK(run.code == 0);
    CHECK_THAT(run.err, Contains("no figures: interrupted; hilda plot draws them"));
    CHECK_THAT(read(in / "b/summary.json"), Contains("\"status\": \"ok\""));

    const Ended study = interrupted({"study", "energy", "--problem", "double_pendulum", "--integrator",
                                     "rA-half-1", "--end", "0.1", "--output", "c", "--force"});
    CHECK(study.code == 128 + signal);
    CHECK_THAT(study.err, Contains("interrupted; the finished runs are kept in c"));
    CHECK(fs::exists(in / "c/study.csv"));
}
