// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/program/csv.hpp"
#include "tests/support/program/refused.hpp"

#include <catch2/catch.hpp>

#include <set>

using namespace hilda::tests;

TEST_CASE("the errors of a stiff model are those against a reference solution with its stiffness and damping",
          "[studies][stiffness]")
{
    const Scratch in;
    const std::vector<std::string> study = {
        "study",   "stiffness", "--integrator", "rA-radau-5,ida-rp-baumgarte",
        "--rtols", "1e-3,1e-7", "--repeats",    "1",
        "--end",   "0.3",       "--no-plot"};
    const Ended ended = call(in, study);
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    std::set<std::pair<double, double>> struts;
    for (const CsvRow& row : csv(in / "out/stiffness/study.csv")) {
        CAPTURE(row.at("k"), row.at("c"), row.at("integrator"), row.at("rtol"));
        struts.emplace(number(row, "k"), number(row, "c"));
        CHECK(number(row, "r") < (number(row, "rtol") > 1e-5 ? 2e-2 : 1e-5));
    }
    CHECK(struts.size() == 12);
    CHECK(csv(in / "out/stiffness/times.csv").size() == 2 * 12 * 3);
    check_refused(in, with(study, {"--force", "--set", "/forces/0/damping=3"}), 2,
                  "it sets the stiffness and the damping of the strut, got --set");
}
