// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/arguments.hpp"
#include "io/error.hpp"
#include "run/diagnosis.hpp"
#include "studies/framework/study_options.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::run;
using namespace hilda::studies;

TEST_CASE("an option value must be a number as a whole", "[studies][arguments]")
{
    CHECK(positive_number("--step", "1e-3") == 1e-3);
    CHECK(nonnegative_number("--interval", "0") == 0);
    CHECK(number("--x", "-2.5") == -2.5);
    for (const char* text : {"", " 1", "1 ", "1,5", "0x10", "nan", "inf", "1e999", "one"}) {
        CAPTURE(text);
        CHECK_THROWS_AS(number("--x", text), io::UsageError);
    }
    CHECK_THROWS_AS(positive_number("--step", "0"), io::UsageError);
    CHECK_THROWS_AS(positive_count("--jobs", "1.5"), io::UsageError);
    CHECK(steps("--steps", "1e-4,1e-3") == std::vector<double>{1e-3, 1e-4});
    CHECK(list("--problem", "a,b") == std::vector<std::string>{"a", "b"});
    for (const char* text : {"", ",", "a,", ",a", "a,,b"})
        CHECK_THROWS_AS(list("--problem", text), io::UsageError);
}

TEST_CASE("a word that is not allowed is rejected with the list of allowed words", "[studies][arguments]")
{
    CHECK(preset("--preset", "balanced") == "balanced");
    CHECK_THROWS_AS(preset("--preset", "Balanced"), io::UsageError);
    CHECK_THROWS_WITH(preset("--preset", "thesis"),
                      "--preset: must be balanced or dissertation, got 'thesis'");
    CHECK_THROWS_WITH(one_of("--grid", "", std::vector<std::string>{"a", "b", "c"}),
                      "--grid: must be a, b or c, got ''");
}

TEST_CASE("an expectation has a key, a value and a tolerance", "[studies][arguments]")
{
    const Expectation e = expectation("--expect", "order=2+-0.1");
    CHECK(e.key == "order");
    CHECK(e.value == 2);
    CHECK(e.tolerance == 0.1);
    CHECK(e.text == "order=2+-0.1");
    CHECK(expectation("--expect", "r_end=-1e-3").value == -1e-3);
    CHECK(expectation("--expect", "r_end=1").tolerance == 0);
    for (const char* text : {"", "order", "=2", "order=", "order=2+-", "order=2+--1", "a+-1=2"}) {
        CAPTURE(text);
        CHECK_THROWS_AS(expectation("--expect", text), io::UsageError);
    }
}

TEST_CASE("a step is written with the least digits, in scientific notation below 0.01",
          "[studies][arguments]")
{
    CHECK(step_text(1e-3) == "1e-3");
    CHECK(step_text(2.5e-5) == "2.5e-5");
    CHECK(step_text(1e-10) == "1e-10");
    CHECK(step_text(0.02) == "0.02");
    CHECK(step_text(1) == "1");
}
