// SPDX-License-Identifier: GPL-3.0-or-later
// Friction experiments against closed forms and published values, and the study that runs them.
#include "studies/experiments/chapter4/friction/experiment.hpp"

#include "tests/support/program/csv.hpp"
#include "tests/support/program/program.hpp"

#include <catch2/catch.hpp>

#include <map>

using namespace hilda;
using namespace hilda::tests;
namespace friction = hilda::studies::friction;
using Catch::Matchers::Contains;

TEST_CASE("every friction experiment passes its criteria", "[studies][friction]")
{
    for (const friction::Experiment& experiment : friction::experiments()) {
        std::map<std::string, studies::Curve> curves;
        curves[""] = {};  // of the criteria without a run
        for (const friction::ExperimentRun& run : experiment.runs)
            if (!run.check_only) curves[run.name] = friction::simulate(run.setup());
        size_t checks = 0;
        for (const friction::Expected& expected : experiment.expected) {
            if (!curves.contains(expected.run)) continue;
            const double measured = expected.measure(curves[expected.run]);
            INFO(experiment.name << ": " << expected.what << ": " << measured << ", required "
                                 << expected.required << " +- " << expected.tolerance);
            CHECK(std::abs(measured - expected.required) <= expected.tolerance);
            ++checks;
        }
        CHECK((experiment.name == "disk-damping" || checks > 0));
    }
}

TEST_CASE("the friction study compares every step of the runs with a table", "[studies][friction]")
{
    const Scratch in;
    const Ended first = call(in, {"study", "friction", "--problem", "brick", "--no-plot"});
    CAPTURE(first.err);
    REQUIRE(first.code == 0);
    CHECK_THAT(first.out, Contains("brick (Fig. 4.6)") && Contains("m g sin(alpha) / K_E"));
    // the curve of the study itself, changed at one instant; row 0 is not set, as in published files
    std::string table = "# comment\nt,x_damped,nothing\n0,1,\n";
    for (const CsvRow& row : csv(in / "out/friction/brick.csv"))
        if (row.at("run") == "damped" && number(row, "t") > 0)
            table += row.at("t") + "," + (row.at("t") == "0.05" ? "1" : row.at("x")) + ",\n";
    write(in / "table.csv", table);
    const Ended ended = call(
        in, {"study", "friction", "--problem", "brick", "--no-plot", "--force", "--against", "table.csv"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    const auto rows = csv(in / "out/friction/against.csv");
    REQUIRE(rows.size() == 1);
    CHECK(rows[0].at("column") == "x_damped");
    CHECK(rows[0].at("run") == "damped");
    CHECK(number(rows[0], "largest difference") == Approx(1).epsilon(1e-4));
    CHECK(number(rows[0], "at t [s]") == 0.05);

    CHECK(rows[0].at("nearest") == "*");
    CHECK_THAT(ended.out, Contains("relative to the column size: 1.00e+00"));

    // a quantity that every run has: the run of origin is the nearest
    std::string whole = "t,x\n";
    for (const CsvRow& row : csv(in / "out/friction/brick.csv"))
        if (row.at("run") == "damped") whole += row.at("t") + "," + row.at("x") + "\n";
    write(in / "whole.csv", whole);
    const auto against = [&](const std::string& expected) {
        return call(in, {"study", "friction", "--problem", "brick", "--no-plot", "--quiet", "--force",
                         "--against", "whole.csv", "--expect", expected});
    };
    CHECK(against("difference=0+-1e-12").code == 0);
    for (const CsvRow& row : csv(in / "out/friction/against.csv"))
        CHECK((row.at("nearest") == "*") == (row.at("run") == "damped"));
    const Ended missed = against("difference=1+-0.5");
    CHECK(missed.code == 6);
    CHECK_THAT(missed.err, Contains("expected difference=1+-0.5, got 0 for whole.csv"));
    const Ended unknown = against("differenz=0");
    CHECK(unknown.code == 2);
    CHECK_THAT(unknown.err, Contains("'differenz'; did you mean 'difference'?; known keys: difference"));

    write(in / "other.csv", "t,pressure\n0,1\n");
    const Ended other = call(
        in, {"study", "friction", "--problem", "brick", "--no-plot", "--force", "--against", "other.csv"});
    CHECK(other.code == 3);
    CHECK_THAT(other.err, Contains("other.csv: no column is a quantity of the selected experiments"));
}

TEST_CASE("the friction study suggests the nearest name for an unknown experiment", "[studies][friction]")
{
    const Scratch in;
    const Ended ended = call(in, {"study", "friction", "--problem", "brik"});
    CHECK(ended.code == 2);
    CHECK(ended.err == "hilda: error: study friction: unknown experiment 'brik'; did you mean 'brick'?\n");
    const Ended unused = call(in, {"study", "long-time", "--check"});
    CHECK(unused.code == 2);
    CHECK_THAT(unused.err, Contains("--check is for ") && Contains(" friction, ") &&
                               Contains("incline-sweep, iterations"));
}

TEST_CASE("the snapshots of the friction study are those of the dissertation", "[studies][friction]")
{
    const Scratch in;
    const Ended ended = call(in, {"study", "friction", "--problem", "incline,spin,ellipsoid", "--no-plot"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    const auto shown = [&](const std::string& table) {
        std::vector<CsvRow> rows;
        for (const CsvRow& row : csv(in / ("out/friction/" + table)))
            if (row.at("shown") == "1" && (!row.contains("body") || row.at("body") != "plane"))
                rows.push_back(row);
        return rows;
    };
    const auto times = [](const std::vector<CsvRow>& rows) {
        std::vector<double> all;
        for (const CsvRow& row : rows) all.push_back(std::round(1e6 * number(row, "t")) / 1e6);
        return all;
    };
    const auto incline = shown("incline-poses.csv"), force = shown("incline-contacts.csv");
    CHECK(times(incline) == std::vector<double>{0.004, 0.05, 0.09, 0.2});
    REQUIRE(force.size() == 4);
    for (size_t k = 0; k < 4; ++k) {
        CHECK(number(force[k], "Cy") == Approx(number(incline[k], "ry")));  // below the centre
        CHECK(number(force[k], "Cz") == Approx(0).margin(1e-12));
    }
    // up the slope in phases I and II, down in III and IV; friction on the sphere down the slope in I, up in
    // IV
    CHECK(number(incline[0], "vy") > 0);
    CHECK(number(incline[1], "vy") > 0);
    CHECK(number(incline[2], "vy") < 0);
    CHECK(number(incline[3], "vy") < 0);
    CHECK(number(force[0], "Fy") < 0);
    CHECK(number(force[3], "Fy") > 0);

    const auto spin = shown("spin-poses.csv"), frame = shown("spin-contacts.csv");
    CHECK(times(spin) == std::vector<double>{0, 2, 4, 8});
    for (size_t k = 0; k < frame.size(); ++k) {
        // The contact frame is carried by the sphere (preset dissertation): the angle between them is
        // constant.
        const double cosine =
            number(frame[k], "ux") * number(spin[k], "A11") + number(frame[k], "uy") * number(spin[k], "A21");
        const double at_start =
            number(frame[0], "ux") * number(spin[0], "A11") + number(frame[0], "uy") * number(spin[0], "A21");
        CHECK(cosine == Approx(at_start).margin(1e-3));
    }
    CHECK(times(shown("ellipsoid-poses.csv")) == std::vector<double>{0, 0.75, 0.9, 1.8, 2.1, 3});
    CHECK(fs::exists(in / "out/friction/ellipsoid-shapes.json"));
}
