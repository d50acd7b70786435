// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/program/csv.hpp"
#include "tests/support/program/refused.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <map>

using namespace hilda::tests;

TEST_CASE("the errors of a scheme do not depend on a tolerance that is enough", "[studies][tolerance]")
{
    const Scratch in;
    const std::vector<std::string> study = {"study",        "tolerance",
                                            "--problem",    "double_pendulum",
                                            "--integrator", "rA-rattle,rA-half-1",
                                            "--steps",      "5e-3",
                                            "--end",        "0.5",
                                            "--no-plot"};
    const Ended ended = call(in, study);
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    std::map<std::string, std::vector<CsvRow>> runs;
    for (const CsvRow& row : csv(in / "out/tolerance/study.csv")) runs[row.at("integrator")].push_back(row);
    const auto record = nlohmann::json::parse(read(in / "out/tolerance/study.json"));
    REQUIRE(runs.size() == 2);
    for (size_t s = 0; s < 2; ++s) {
        const auto& of = record["series"][s];
        const auto& rows = runs.at(of["integrator"].get<std::string>());
        CAPTURE(of["integrator"]);
        REQUIRE(rows.size() == 11);
        const double enough = of["enough"].get<double>();
        CHECK(enough >= 1e-9);
        CHECK(enough <= 1e-3);
        for (size_t k = 0; k < rows.size(); ++k) {
            for (const char* norm : {"r", "v", "Q"})
                if (number(rows[k], "tolerance") <= enough)
                    CHECK(number(rows[k], norm) <= 1.011 * number(rows.back(), norm));
            if (k > 0)
                CHECK(number(rows[k], "iterations_per_step") >= number(rows[k - 1], "iterations_per_step"));
        }
        // The residual of the constraints follows the tolerance down to rounding.
        CHECK(number(rows.front(), "constraint_norm") > 100 * number(rows.back(), "constraint_norm"));
    }
    check_refused(in, with(study, {"--force", "--tolerance", "1e-8"}), 2, "--tolerance is for other studies");
}
