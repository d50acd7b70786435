// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/formats/csv.hpp"

#include "io/error.hpp"

#include <catch2/catch.hpp>

using namespace hilda;

namespace {

using Cells = std::vector<std::string>;

/// The names of the columns, then the cells of each row
std::vector<Cells> table(const std::string& text)
{
    std::vector<Cells> all;
    io::read_csv(text, "a.csv", [&](const io::CsvRow& row) {
        if (all.empty()) all.emplace_back(row.names.begin(), row.names.end());
        all.emplace_back(row.cells.begin(), row.cells.end());
    });
    return all;
}

}  // namespace

TEST_CASE("a table is read with its comments, blanks and line ends", "[io][csv]")
{
    CHECK(table("# note\n a , b\r\n\r\n1, x y \n,\n") ==
          std::vector<Cells>{{"a", "b"}, {"1", "x y"}, {"", ""}});
    CHECK(table("\xEF\xBB\xBF"
                "a,b\n1,2\n") == std::vector<Cells>{{"a", "b"}, {"1", "2"}});  // byte order mark
    CHECK(table("a,b\n").empty());
    CHECK_THROWS_WITH(table("a,b\n1\n"), "a.csv:2: a row must have a field for each of the 2 columns, got 1");
    CHECK_THROWS_WITH(table("a,b\n1,2\n1,2,3\n"),
                      "a.csv:3: a row must have a field for each of the 2 columns, got 3");
    CHECK_THROWS_WITH(table("a,a\n"), "a.csv:1: two columns have the same name, got 'a'");
    CHECK_THROWS_WITH(table("# note\nt;x\n0;1\n"),
                      "a.csv:2: the names of the columns are separated by semicolons; a table "
                      "has commas, and points in its numbers");
    CHECK_THROWS_WITH(table("t\tx\n0\t1\n"),
                      Catch::Contains("a.csv:1: the names of the columns are separated by tabs; "));
    CHECK(table("a;b,c\n1,2\n") == std::vector<Cells>{{"a;b", "c"}, {"1", "2"}});
    for (const std::string& text :
         {std::string("\xFF\xFEt\0,\0x\0", 8), std::string("\xFE\xFF\0t\0,", 6), std::string("t\0,\0", 4)})
        CHECK_THROWS_WITH(table(text),
                          "a.csv: is a text in UTF-16 or binary data; a table is a text in UTF-8");
}

TEST_CASE("a field that csv_field has quoted is read as the same text", "[io][csv]")
{
    for (const std::string text : {"max(1,2)", "\"", "\"\"", ",", "a\"b,c\"", "5\" pipe", "\",\"", "[1, 2]",
                                   "=1+1", "@sum", "-ball"}) {
        CAPTURE(text);
        const std::string field = io::csv_field(text);
        CHECK(table(field + ",b\n" + field + ", " + field + " \n") ==
              std::vector<Cells>{{text, "b"}, {text, text}});
    }
    CHECK(io::csv_field("=1+1") == "\"=1+1\"");  // a spreadsheet takes it for a text
    // a quote within a cell without quotes is a character
    CHECK(table("a,b\n5\" pipe,2\n") == std::vector<Cells>{{"a", "b"}, {"5\" pipe", "2"}});
    CHECK_THROWS_AS(table("a,b\n\"1,2\n"), io::InvalidInput);  // the quote does not end
}
