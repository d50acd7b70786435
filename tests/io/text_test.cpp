// SPDX-License-Identifier: GPL-3.0-or-later
/// Text of numbers, names and command lines, and the checksum.
#include "io/archive.hpp"
#include "io/error.hpp"
#include "io/formats/characters.hpp"
#include "io/formats/csv.hpp"
#include "io/json.hpp"
#include "io/message.hpp"
#include "io/provenance.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <new>
#include <random>
#include <set>

using namespace hilda;

TEST_CASE("the text of a number is the shortest one that is read as the same number", "[io][text]")
{
    const auto text = [](auto value) {
        std::string row;
        io::append_number(row, value);
        return row;
    };
    CHECK(text(0.1) == "0.1");
    CHECK(text(-0.0) == "-0");
    CHECK(text(1e22) == "1e+22");
    CHECK(text(-12L) == "-12");
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> exponent(-300, 300), mantissa(-1, 1);
    for (int k = 0; k < 1000; ++k) {
        const double x = mantissa(random) * std::pow(10, exponent(random));
        CHECK(std::stod(text(x)) == x);
    }
}

TEST_CASE("a name with a comma, a quote or a line break is quoted as one CSV field", "[io][text]")
{
    CHECK(io::csv_field("a b") == "a b");
    CHECK(io::csv_field("a,b") == "\"a,b\"");
    CHECK(io::csv_field("a \"b\"") == "\"a \"\"b\"\"\"");
    CHECK(io::csv_field("a\nb") == "\"a\nb\"");
}

TEST_CASE("characters that a terminal would act on are escaped", "[io][text]")
{
    CHECK(io::printable("Stütze 1 (µ = 0.3), 轴, محور") == "Stütze 1 (µ = 0.3), 轴, محور");
    CHECK(io::printable("a\nb\tc\x1b[31m\x7f") == "a\\nb\\u0009c\\u001b[31m\\u007f");
    CHECK(io::printable(std::string("a\0b", 3)) == "a\\u0000b");
    CHECK(io::printable("\xC2\x9B"
                        "31m\xC2\x85\xC2\xA0") == "\\u009b31m\\u0085\xC2\xA0");  // U+00A0 is a blank
    CHECK(io::printable("\u202Ednuorg\u202C \u2066\u2069 \u200F\u061C\u2028") ==
          "\\u202ednuorg\\u202c \\u2066\\u2069 \\u200f\\u061c\\u2028");
    CHECK(io::printable("\x9B\xFF\xE2\x82") == "\\x9b\\xff\\xe2\\x82");  // not UTF-8
    CHECK(io::printable(io::printable("\u202E\n")) == io::printable("\u202E\n"));
    CHECK(io::in_quotes("a\u202E\x7F") == "\"a\\u202e\\u007f\"");
    CHECK(io::in_quotes(std::string_view("a\0b", 3)) == "\"a\\u0000b\"");
}

TEST_CASE("a command line is quoted such that a shell reads the same words", "[io][text]")
{
    std::vector<std::string> words = {"hilda", "run", "my model.json", "--set", "/a/0=[1,2]",
                                      "it's",  "",    "--step=1e-3"};
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    CHECK(io::shell_quoted(static_cast<int>(argv.size()), argv.data()) ==
          "hilda run 'my model.json' --set '/a/0=[1,2]' 'it'\\''s' '' --step=1e-3");
}

TEST_CASE("the checksum sees each byte and the order of the words", "[io][text]")
{
    std::string bytes = "0123456789abcdef0123456789";
    std::set<std::uint64_t> sums = {io::checksum(bytes.data(), bytes.size())};
    for (char& byte : bytes)
        for (int bit = 0; bit < 8; ++bit) {
            byte = static_cast<char>(byte ^ 1 << bit);
            CHECK(sums.insert(io::checksum(bytes.data(), bytes.size())).second);
            byte = static_cast<char>(byte ^ 1 << bit);
        }
    for (std::size_t n = 0; n < bytes.size(); ++n) CHECK(sums.insert(io::checksum(bytes.data(), n)).second);
    const std::string swapped = "89abcdef01234567";
    CHECK(sums.insert(io::checksum(swapped.data(), swapped.size())).second);
}

TEST_CASE("each kind of error has its exit code", "[io][error]")
{
    CHECK(io::report(io::UsageError("x")) == 2);
    CHECK(io::report(io::InvalidInput("x")) == 3);
    CHECK(io::report(io::NumericalFailure("newton_diverged", "x")) == 4);
    CHECK(io::report(io::IoError("x")) == 5);
    CHECK(io::report(io::NotAvailable("x")) == 7);
    CHECK(io::report(std::bad_alloc()) == 1);
    CHECK(io::report(std::logic_error("x")) == 1);
    CHECK_THROWS_WITH(io::reject("body 'a'", "mass must be positive", 0.1),
                      "body 'a': mass must be positive, got 0.1");
}

TEST_CASE("a number of things is written with the singular for one", "[io][text]")
{
    CHECK(io::counted(0, "row") == "0 rows");
    CHECK(io::counted(1, "row") == "1 row");
    CHECK(io::counted(2, "body", "bodies") == "2 bodies");
    CHECK(io::counted(1, "body", "bodies") == "1 body");
    CHECK(io::counted(-1, "row") == "-1 rows");
}
