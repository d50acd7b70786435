// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/backend/fixed_sum.hpp"

#include "io/arithmetic/clones.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

namespace {

constexpr std::size_t lanes = 8, most = 1024;  // terms of a part

/// Whether all terms are zero or within the range in which a FixedSum adds them exactly, and the largest
/// magnitude
struct Range {
    bool is_exact;
    double largest;
};

HILDA_CLONES("avx512f", "avx2", "default") Range range_of(const double* x, std::size_t n)
{
    constexpr double beyond = 0x1p200;
    double largest[lanes] = {}, least[lanes], not_finite[lanes] = {};
    for (double& of_lane : least) of_lane = beyond;
    for (std::size_t k = 0; k < n; k += lanes)
        for (std::size_t i = 0; i < lanes; ++i) {
            const double v = x[k + i], size = std::abs(v), not_zero = size > 0 ? size : beyond;
            largest[i] = size > largest[i] ? size : largest[i];
            least[i] = not_zero < least[i] ? not_zero : least[i];
            not_finite[i] += v - v;  // NaN from a number that is not finite
        }
    double all_largest = 0, all_least = beyond, all_not_finite = 0;
    for (std::size_t i = 0; i < lanes; ++i) {
        all_largest = std::max(all_largest, largest[i]), all_least = std::min(all_least, least[i]);
        all_not_finite += not_finite[i];
    }
    return {all_not_finite == 0 && all_largest < 0x1p100 && all_least >= 0x1p-87, all_largest};
}

/// Splits off the leading bits of the terms three times and sums them: q = (σ + x) - σ is a multiple of
/// 2^-53 σ, so that the sum of the q and x - q are exact if σ is at least twice the number of terms times the
/// largest (Rump, Ogita and Oishi 2008, Accurate floating-point summation, Algorithm 3.3). Replaces the terms
/// by what remains of them, and returns whether something does.
HILDA_CLONES("avx512f", "avx2", "default")
bool split(double* x, std::size_t n, const double* sigma, double* sum)
{
    double first[lanes] = {}, second[lanes] = {}, third[lanes] = {}, rest[lanes] = {};
    const double s_1 = sigma[0], s_2 = sigma[1], s_3 = sigma[2];
    for (std::size_t k = 0; k < n; k += lanes)
        for (std::size_t i = 0; i < lanes; ++i) {
            double v = x[k + i];
            const double q_1 = (s_1 + v) - s_1;
            first[i] += q_1, v -= q_1;
            const double q_2 = (s_2 + v) - s_2;
            second[i] += q_2, v -= q_2;
            const double q_3 = (s_3 + v) - s_3;
            third[i] += q_3, v -= q_3;
            x[k + i] = v, rest[i] += std::abs(v);
        }
    double all = 0;
    for (std::size_t i = 0; i < lanes; ++i) {
        sum[0] += first[i], sum[1] += second[i], sum[2] += third[i];
        all += rest[i];
    }
    return all > 0;
}

}  // namespace

void add_all(FixedSum& sum, const double* x, std::size_t n)
{
    alignas(64) double part[most];
    for (const double* const end = x + n; x < end; x += most) {
        const std::size_t count = std::min<std::size_t>(most, static_cast<std::size_t>(end - x)),
                          padded = (count + lanes - 1) / lanes * lanes;
        std::copy_n(x, count, part);
        std::fill(part + count, part + padded, 0.);
        const Range range = range_of(part, padded);
        if (!range.is_exact) {
            for (std::size_t k = 0; k < count; ++k) sum += x[k];
            continue;
        }
        if (range.largest == 0) continue;
        // Powers of two: 2^11 is more than twice `most`, and what remains is at most 2^-53 σ.
        double sigma[3], split_sum[3] = {};
        sigma[0] = std::ldexp(1., std::ilogb(range.largest) + 12);
        sigma[1] = 0x1p-42 * sigma[0], sigma[2] = 0x1p-42 * sigma[1];
        const bool has_rest = split(part, padded, sigma, split_sum);
        for (const double s : split_sum) sum += s;
        for (std::size_t k = 0; has_rest && k < count; ++k) sum += part[k];
    }
}

}  // namespace hilda::granular
