// SPDX-License-Identifier: GPL-3.0-or-later
// The parallel primitives of the CPU: loops, maxima, prefix sums and sorts.
#include "granular/backend/par.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include <omp.h>

using namespace hilda::granular;

namespace {

/// Sets the number of threads, and resets it at the end of a test.
struct Threads {
    int before = omp_get_max_threads();
    explicit Threads(int n) { omp_set_num_threads(n); }
    ~Threads() { omp_set_num_threads(before); }
};

/// Adds 1 to each of n numbers, `loops` times. Returns whether each is then `loops`.
bool counts_each_once(std::size_t n, int loops)
{
    std::vector<int> count(n);
    for (int k = 0; k < loops; ++k)
        par::for_each(
            par::Cpu(), n, [&](std::uint32_t i) { ++count[i]; }, 1);
    return std::all_of(count.begin(), count.end(), [&](int c) { return c == loops; });
}

}  // namespace

TEST_CASE("a loop calls its function once for each number, for any number of threads", "[granular][threads]")
{
    // The number of parts changes from loop to loop.
    for (int round = 0; round < 200; ++round)
        for (const int threads : {1, 5, 2, 8, 3}) {
            const Threads set(threads);
            for (const std::size_t n : {0, 1, 2, 3, 7, 1000}) REQUIRE(counts_each_once(n, 3));
        }
}

TEST_CASE("loops within loops and loops of two threads at once are complete", "[granular][threads]")
{
    const Threads set(3);
    std::vector<std::atomic<int>> count(64 * 64);
    par::for_each(
        par::Cpu(), 64,
        [&](std::uint32_t a) {
            par::for_each(
                par::Cpu(), 64, [&](std::uint32_t b) { ++count[64 * a + b]; }, 1);
        },
        1);
    CHECK(std::all_of(count.begin(), count.end(), [](const auto& c) { return c == 1; }));

    bool other = false;
    std::thread thread([&] {
        omp_set_num_threads(2);
        other = counts_each_once(100, 5000);
    });
    CHECK(counts_each_once(100, 5000));
    thread.join();
    CHECK(other);
}

TEST_CASE("the largest value is that of a serial loop, and NaN if a value is NaN", "[granular][threads]")
{
    const Threads set(4);
    const auto triangle = [](std::uint32_t k) { return static_cast<float>(k < 700 ? k : 1400 - k); };
    CHECK(par::largest(par::Cpu(), 1000, triangle, 1) == 700);
    const auto with_nan = [&](std::uint32_t k) { return k == 999 ? NAN : triangle(k); };
    CHECK(std::isnan(par::largest(par::Cpu(), 1000, with_nan, 1)));
}

TEST_CASE("prefix sums and stable sorts agree with the standard library", "[granular][threads]")
{
    std::mt19937 random(1);
    for (const int threads : {1, 2, 3, 4, 8})
        for (const std::size_t n : {0, 1, 2047, 2049, 10001, 100000}) {
            const Threads set(threads);
            std::vector<std::uint32_t> in(n), sums(n + 1), expected(n + 1);
            for (auto& x : in) x = static_cast<std::uint32_t>(random() % 50);
            std::partial_sum(in.begin(), in.end(), expected.begin() + 1);
            CHECK(par::exclusive_scan(par::Cpu(), in.data(), sums.data(), n) == expected.back());
            CHECK(sums == expected);

            std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs(n);
            std::vector<std::uint32_t> keys(n), values(n);
            for (std::size_t k = 0; k < n; ++k)
                pairs[k] = {static_cast<std::uint32_t>(random() % 3000), static_cast<std::uint32_t>(k)},
                keys[k] = pairs[k].first, values[k] = pairs[k].second;
            par::stable_sort_by_key(par::Cpu(), keys.data(), values.data(), n, 12);
            std::sort(pairs.begin(), pairs.end());
            bool same = true;
            for (std::size_t k = 0; k < n; ++k)
                same = same && keys[k] == pairs[k].first && values[k] == pairs[k].second;
            CHECK(same);
        }
}
