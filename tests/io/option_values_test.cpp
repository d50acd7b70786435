// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/option_values.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>

using namespace hilda;

namespace {

/// The message with which an option value is refused; "" if it is accepted
template <class Convert>
std::string refusal_of_option(const Convert& convert, const std::string& text)
{
    try {
        convert("--x", text);
        return "";
    } catch (const io::UsageError& e) {
        return e.what();
    }
}

const std::vector<std::string> no_numbers = {"",    " ",   "1s",   "1 ",    " 1",  "+1",
                                             "nan", "inf", "-inf", "1e400", "0x1", "1,5"};

}  // namespace

TEST_CASE("numbers of the command line are finite, within their range and without other text",
          "[io][options]")
{
    CHECK(io::number("--x", "-1.5e-3") == -1.5e-3);
    CHECK(io::positive_number("--x", "1e300") == 1e300);
    CHECK(io::nonnegative_number("--x", "0") == 0);
    CHECK(io::fraction("--x", "1") == 1);
    CHECK(io::fraction("--x", "0") == 0);
    CHECK(std::isnan(io::finite_number_in("inf")));
    struct Kind {
        std::function<double(const std::string&, const std::string&)> convert;
        std::string rule;
        std::vector<std::string> outside;
    };
    const Kind kinds[] = {{io::number, "must be a finite number", {}},
                          {io::positive_number, "must be a positive, finite number", {"0", "-1"}},
                          {io::nonnegative_number, "must be a finite number, not negative", {"-1e-300"}},
                          {io::fraction, "must be a number from 0 to 1", {"-0.1", "1.0000001"}}};
    for (const Kind& kind : kinds)
        for (const std::vector<std::string>* texts : {&no_numbers, &kind.outside})
            for (const std::string& text : *texts)
                CHECK(refusal_of_option(kind.convert, text) == "--x: " + kind.rule + ", got '" + text + "'");
}

TEST_CASE("whole numbers of the command line are within their range", "[io][options]")
{
    CHECK(io::positive_count("--x", "2147483647") == 2147483647);
    CHECK(io::count_up_to(8, "--x", "8") == 8);
    CHECK(io::seed("--x", "18446744073709551615") == 18446744073709551615u);
    CHECK(io::seed("--x", "0") == 0);
    const auto up_to_8 = [](const std::string& option, const std::string& text) {
        return io::count_up_to(8, option, text);
    };
    for (const std::string text : {"", "0", "-1", "1.5", "1e3", "2147483648", "one"}) {
        CHECK(refusal_of_option(io::positive_count, text) ==
              "--x: must be a whole number, at least 1, got '" + text + "'");
        CHECK(refusal_of_option(up_to_8, text) ==
              "--x: must be a whole number from 1 to 8, got '" + text + "'");
    }
    CHECK(refusal_of_option(up_to_8, "9") == "--x: must be a whole number from 1 to 8, got '9'");
    for (const std::string text : {"", "-1", "0.5", "18446744073709551616"})
        CHECK(refusal_of_option(io::seed, text) ==
              "--x: must be a whole number from 0 to 2^64 - 1, got '" + text + "'");
}

TEST_CASE("lists, words, paths and settings of the command line", "[io][options]")
{
    using Words = std::vector<std::string>;
    CHECK(io::list("--x", "a") == Words{"a"});
    CHECK(io::list("--x", "a,b c,d") == Words{"a", "b c", "d"});
    for (const std::string text : {"", ",", "a,", ",a", "a,,b"})
        CHECK(refusal_of_option(io::list, text) ==
              "--x: must be a list such as A,B without empty parts, got '" + text + "'");

    const Words words = {"cpu", "cuda", "none"};
    const auto one_of = [&](const std::string& option, const std::string& text) {
        return io::one_of(option, text, words);
    };
    CHECK(one_of("--x", "cuda") == "cuda");
    CHECK(refusal_of_option(one_of, "gpu") == "--x: must be cpu, cuda or none, got 'gpu'");

    CHECK(io::path("--x", "a/b") == "a/b");
    CHECK(refusal_of_option(io::path, "") == "--x: must not be empty");
    CHECK(io::setting("--x", "/a/0=1=2") == "/a/0=1=2");
    for (const std::string text : {"", "/a", "a=1", "=1"})
        CHECK(refusal_of_option(io::setting, text) ==
              "--x: must be /json/pointer=VALUE, such as /gravity/2=-1.62, got '" + text + "'");
}
