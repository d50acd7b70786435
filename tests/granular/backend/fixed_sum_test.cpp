// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/backend/fixed_sum.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

using hilda::granular::add_all;
using hilda::granular::DoublePart;
using hilda::granular::FixedSum;
using hilda::granular::FloatPart;

TEST_CASE("a fixed sum does not depend on the order of its terms and parts", "[granular][fixed-sum]")
{
    std::mt19937 random(3);
    std::uniform_real_distribution<double> mantissa(-1, 1);
    std::uniform_int_distribution<int> exponent(-60, 60);
    std::vector<double> terms(1000);
    for (double& x : terms) x = std::ldexp(mantissa(random), exponent(random));
    FixedSum whole;
    for (const double x : terms) whole += x;
    for (int k = 0; k < 10; ++k) {
        std::shuffle(terms.begin(), terms.end(), random);
        FixedSum parts[7], sum;
        for (std::size_t n = 0; n < terms.size(); ++n) parts[n % 7] += terms[n];
        for (const FixedSum& part : parts) sum += part;
        CHECK(sum.value() == whole.value());
    }
    long double reference = 0;
    for (const double x : terms) reference += x;
    CHECK(whole.value() == Approx(static_cast<double>(reference)).epsilon(1e-15));
}

TEST_CASE("a fixed sum is exact, and rounds once", "[granular][fixed-sum]")
{
    for (const double x : {1., -1., 0.1, -0.1, 1e-25, 1e34, std::ldexp(1, -87), 0., 1 + 0x1p-52}) {
        FixedSum one;
        one += x;
        CHECK(one.value() == x);
    }
    FixedSum cancels;
    for (const double x : {1e30, 1e-12, -1e30}) cancels += x;
    CHECK(cancels.value() == 1e-12);
    // halfway between two numbers, to the even one; a little more, to the next one
    FixedSum halfway;
    for (const double x : {1., 0x1p-53}) halfway += x;
    CHECK(halfway.value() == 1);
    halfway += 0x1p-120;
    CHECK(halfway.value() == 1 + 0x1p-52);
}

TEST_CASE("a fixed sum of a number that is not finite or too large is not a number", "[granular][fixed-sum]")
{
    for (const double x : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity(), 1e300}) {
        FixedSum sum;
        sum += 1;
        sum += x;
        CHECK(std::isnan(sum.value()));
    }
}

TEST_CASE("a fixed sum reports an overflow, and is exact before it", "[granular][fixed-sum]")
{
    for (const double sign : {1., -1.}) {
        FixedSum sum;
        for (int k = 0; k < 3; ++k) sum += sign * 0x1p114;
        CHECK(sum.value() == sign * 3 * 0x1p114);
        FixedSum twice = sum;
        twice += sum;
        CHECK(std::isnan(twice.value()));
        sum += -sign * 0x1p114;
        sum += -sign * 0x1p114;
        CHECK(sum.value() ==
              sign * 0x1p114);  // the positive and the negative terms have integers of their own
        sum += sign * 0x1p114;
        CHECK(std::isnan(sum.value()));
    }
}

TEST_CASE("the carry of a fixed sum goes through all words, and differences of large sums are exact",
          "[granular][fixed-sum]")
{
    FixedSum sum;
    // 2^52 - 2^-140: all bits between are set
    for (int k = 0; k < 4; ++k) sum += std::ldexp(std::ldexp(1, 48) - 1, 48 * k - 140);
    CHECK(sum.value() == 0x1p52);  // rounded
    sum += -0x1p52;
    CHECK(sum.value() == -0x1p-140);
    sum += 0x1p-140;
    CHECK(sum.value() == 0);
}

TEST_CASE("a part with terms of float gives the same fixed sum bit by bit", "[granular][fixed-sum]")
{
    std::mt19937 random(5);
    std::uniform_real_distribution<float> mantissa(-1, 1);
    // forces of one size; of sizes that a double cannot hold together; of all sizes of a float
    for (const int range : {4, 40, 120}) {
        std::uniform_int_distribution<int> exponent(-range, range == 120 ? 110 : range);
        FixedSum term_by_term, in_parts;
        for (int block = 0; block < 100; ++block) {
            FloatPart part;
            for (int k = 0; k < 64; ++k) {
                const float x = k % 7 == 0 ? 0 : std::ldexp(mantissa(random), exponent(random));
                term_by_term += x, part.add(x, in_parts);
            }
            part.finish(in_parts);
        }
        CAPTURE(range);
        CHECK(term_by_term.value() == in_parts.value());
    }
    for (const float x : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                          std::numeric_limits<float>::max()}) {
        FixedSum sum;
        FloatPart part;
        part.add(1, sum), part.add(x, sum), part.add(1, sum), part.finish(sum);
        CHECK(std::isnan(sum.value()));
    }
    // The terms are truncated one by one to multiples of 2^-140, not their sum.
    FixedSum sum;
    FloatPart part;
    for (int k = 0; k < 4; ++k) part.add(0x1.8p-141f, sum);
    part.finish(sum);
    CHECK(sum.value() == 0);
}

TEST_CASE("sums of many doubles are the same as those of the terms one by one", "[granular][fixed-sum]")
{
    std::mt19937 random(7);
    std::uniform_real_distribution<double> mantissa(-1, 1);
    // of one size; of sizes that are split off in three steps, and that are not; beyond the exact range
    for (const int range : {2, 30, 80, 130}) {
        std::uniform_int_distribution<int> exponent(-range, std::min(range, 90));
        for (const std::size_t n : {0, 1, 7, 8, 100, 1024, 1025, 5000}) {
            std::vector<double> terms(n);
            for (double& x : terms)
                x = exponent(random) % 5 == 0 ? 0 : std::ldexp(mantissa(random), exponent(random));
            FixedSum one_by_one, at_once, in_parts;
            DoublePart part;
            for (const double x : terms) one_by_one += x, part.add(x, in_parts);
            part.finish(in_parts);
            add_all(at_once, terms.data(), n);
            CAPTURE(range, n);
            CHECK(at_once.value() == one_by_one.value());
            CHECK(in_parts.value() == one_by_one.value());
            const double rounded = one_by_one.value();
            for (FixedSum* sum : {&one_by_one, &at_once, &in_parts}) *sum += -rounded;
            CHECK(at_once.value() == one_by_one.value());  // also below the rounding
            CHECK(in_parts.value() == one_by_one.value());
        }
    }
    const double infinity = std::numeric_limits<double>::infinity();
    for (const double x : {std::numeric_limits<double>::quiet_NaN(), infinity, -infinity, 1e300}) {
        FixedSum sum, in_parts;
        const double terms[] = {1, x, 1};
        add_all(sum, terms, 3);
        DoublePart part;
        for (const double term : terms) part.add(term, in_parts);
        part.finish(in_parts);
        CHECK(std::isnan(sum.value()));
        CHECK(std::isnan(in_parts.value()));
    }
}
