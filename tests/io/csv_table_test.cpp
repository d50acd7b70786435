// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/formats/csv_table.hpp"

#include "io/error.hpp"
#include "tests/support/program/program.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda;
using namespace hilda::tests;
using Catch::Matchers::Contains;

TEST_CASE("a table is read with comments, empty fields and different line ends", "[io][csv]")
{
    const Scratch in;
    write(in / "a.csv", "# from elsewhere\r\nt, x,y\r\n0,1e-3,\r\n\r\n# a gap\r\n-0.5, nan ,7\r\n");
    const io::CsvTable table = io::read_csv_table(in / "a.csv");
    CHECK(table.columns == std::vector<std::string>{"t", "x", "y"});
    REQUIRE(table.rows.size() == 2);
    CHECK(table.values("t") == std::vector<double>{0, -0.5});
    CHECK(table.rows[0][table.column("x")] == 1e-3);
    CHECK(std::isnan(table.rows[0][2]));
    CHECK(std::isnan(table.rows[1][1]));
    CHECK(table.rows[1][2] == 7);
    CHECK_THROWS_WITH(table.column("z"), Contains("a.csv: there is no column 'z'"));
}

TEST_CASE("an invalid table is rejected with the number of the line", "[io][csv]")
{
    const Scratch in;
    const auto refused = [&](const std::string& text, const std::string& words) {
        CAPTURE(text);
        write(in / "b.csv", text);
        CHECK_THROWS_AS(io::read_csv_table(in / "b.csv"), io::InvalidInput);
        CHECK_THROWS_WITH(io::read_csv_table(in / "b.csv"), Contains(words));
    };
    refused("t,x\n0,1\n0\n", "b.csv:3: a row must have a field for each of the 2 columns, got 1");
    refused("t,x\n# note\n0,one\n", "b.csv:3: x must be a number, got 'one'");
    refused("t,x\n0,1.5.2\n", "got '1.5.2'");
    refused("t,x\n", "b.csv: has no rows of numbers");
    refused("", "has no rows of numbers");
    CHECK_THROWS_AS(io::read_csv_table(in / "none.csv"), io::InvalidInput);
    CHECK_THROWS_WITH(io::read_csv_table(in / "none.csv"), Contains("none.csv"));
}
