// SPDX-License-Identifier: GPL-3.0-or-later
/// Sums of floating-point numbers that do not depend on the order of the terms.
///
/// A term is truncated to a multiple of 2^-140 and added to an integer of 256 bits, one for the positive
/// terms and one for the negative ones. The integers are exact, so that the terms can be added in any
/// order, in parts, by any number of threads or processes. Terms from 2^-87 on are exact. A term of 2^115
/// or more or one that is not finite makes the sum NaN, as does an overflow of an integer.

#pragma once

#include "granular/backend/real.hpp"

#include <cstddef>
#include <cstdint>

namespace hilda::granular {

class FixedSum {
public:
    static constexpr int words = 4;

    HILDA_HD FixedSum& operator+=(double x)
    {
        std::uint64_t bits = 0;
        memcpy(&bits, &x, sizeof bits);
        const int exponent = static_cast<int>(bits >> 52 & 0x7ff);
        std::uint64_t mantissa = (bits & ((std::uint64_t{1} << 52) - 1)) | std::uint64_t{1} << 52;
        int shift = exponent - 1075 + unit_bits;
        if (shift < 0) {
            if (shift <= -53) return *this;  // zero, or below the unit
            mantissa >>= -shift, shift = 0;
        }
        if (shift > 64 * words - 53 - 1) {
            ++not_summed;
            return *this;
        }
        std::uint64_t* const word = sum[bits >> 63];
        const int first = shift >> 6, within = shift & 63;
        add(word, first, mantissa << within);
        if (first + 1 < words) add(word, first + 1, within == 0 ? 0 : mantissa >> (64 - within));
        return *this;
    }
    HILDA_HD FixedSum& operator+=(const FixedSum& o)
    {
        for (int sign = 0; sign < 2; ++sign)
            for (int k = 0; k < words; ++k) add(sum[sign], k, o.sum[sign][k]);
        not_summed += o.not_summed;
        return *this;
    }

    /// The nearest double; NaN if a term could not be added
    double value() const
    {
        if (not_summed > 0) return NAN;
        int differs = words - 1;
        while (differs > 0 && sum[0][differs] == sum[1][differs]) --differs;
        const bool negative = sum[0][differs] < sum[1][differs];
        std::uint64_t size[words];
        std::uint64_t borrow = 0;
        for (int k = 0; k < words; ++k) {
            const std::uint64_t larger = sum[negative ? 1 : 0][k], smaller = sum[negative ? 0 : 1][k];
            size[k] = larger - smaller - borrow;
            borrow = larger < smaller || (larger == smaller && borrow > 0) ? 1 : 0;
        }
        int top = words - 1;
        while (top > 0 && size[top] == 0) --top;
        if (size[top] == 0) return 0;
        const int free = __builtin_clzll(size[top]);
        std::uint64_t leading = size[top] << free, rest = 0;
        if (top > 0 && free > 0) leading |= size[top - 1] >> (64 - free);
        if (top > 0) rest = size[top - 1] << free;
        for (int k = 0; k < top - 1; ++k) rest |= size[k];
        // The last bit is below the rounding of the conversion. It stands for the remaining ones.
        const double all =
            std::ldexp(static_cast<double>(leading | (rest != 0 ? 1 : 0)), 64 * top - free - unit_bits);
        return negative ? -all : all;
    }

private:
    static constexpr int unit_bits = 140;

    /// Adds to word k of an integer.
    HILDA_HD void add(std::uint64_t* word, int k, std::uint64_t term)
    {
        word[k] += term;
        for (bool carry = word[k] < term; carry; carry = ++word[k] == 0)
            if (++k == words) {
                ++not_summed;
                return;
            }
    }

    std::uint64_t sum[2][words] = {};  ///< of the positive and the negative terms, the lowest word first
    std::uint64_t not_summed = 0;      ///< number of terms that could not be added, and of overflows
};

/// Part of a FixedSum with terms that are floats. The sum is the same bit by bit.
///
/// A double holds the sum of a few floats exactly, unless they differ by a factor of 2^29. A term with
/// which the sum would be rounded is added to the FixedSum itself.
class FloatPart {
public:
    HILDA_HD void add(float x, FixedSum& sum)
    {
        const double s = part + x, of_x = s - part;
        const double rounding = (part - (s - of_x)) + (x - of_x);  // exact: Knuth's two-sum
        // Terms that a FixedSum truncates or counts as not finite are added to it one by one.
        if (rounding == 0 && abs(s) < 0x1p114 && (abs(x) > 0x1p-87f || x == 0)) {
            part = s;
            return;
        }
        sum += x;
    }
    /// Adds the part to the sum.
    HILDA_HD void finish(FixedSum& sum) { sum += part, part = 0; }

private:
    double part = 0;
};

/// The same for terms that are doubles: two doubles hold their sum exactly, unless they differ by a factor of
/// about 2^54.
class DoublePart {
public:
    HILDA_HD void add(double x, FixedSum& sum)
    {
        const double s = high + x, of_x = s - high;
        const double e = (high - (s - of_x)) + (x - of_x);  // exact: Knuth's two-sum
        const double t = low + e, of_e = t - low;
        const double rounding = (low - (t - of_e)) + (e - of_e);
        if (rounding == 0 && abs(s) < 0x1p114 && (abs(x) > 0x1p-87 || x == 0)) {
            high = s, low = t;
            return;
        }
        sum += x;
    }
    /// Adds the part to the sum.
    HILDA_HD void finish(FixedSum& sum) { sum += high, sum += low, high = low = 0; }

private:
    double high = 0, low = 0;
};

/// Adds n terms to a sum. The sum is the same bit by bit as that of the terms one by one.
void add_all(FixedSum& sum, const double* x, std::size_t n);

/// The same for the components of vectors
struct FixedVec {
    FixedSum x, y, z;

    HILDA_HD FixedVec& operator+=(const Vec<double>& v)
    {
        x += v.x, y += v.y, z += v.z;
        return *this;
    }
    HILDA_HD FixedVec& operator+=(const FixedVec& o)
    {
        x += o.x, y += o.y, z += o.z;
        return *this;
    }
    Vec<double> value() const { return {x.value(), y.value(), z.value()}; }
};
template <class Part, class Number>
class PartVec {
public:
    HILDA_HD void add(const Vec<Number>& v, FixedVec& sum)
    {
        x.add(v.x, sum.x), y.add(v.y, sum.y), z.add(v.z, sum.z);
    }
    HILDA_HD void finish(FixedVec& sum) { x.finish(sum.x), y.finish(sum.y), z.finish(sum.z); }

private:
    Part x, y, z;
};
using FloatPartVec = PartVec<FloatPart, float>;
using DoublePartVec = PartVec<DoublePart, double>;

}  // namespace hilda::granular
