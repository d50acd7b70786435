// SPDX-License-Identifier: GPL-3.0-or-later
/// Sums of floating-point numbers that do not depend on the order of the terms.
///
/// A term is truncated to a multiple of 2^-140 and added to an integer of 256 bits. The sum of the integers
/// is exact, so that the terms can be added in any order, in parts, by any number of threads or processes.
/// Terms from 2^-87 on are exact. A term above 2^114 or not finite makes the sum NaN.

#pragma once

#include "granular/backend/real.hpp"

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
        if (exponent == 0) return *this;  // zero, or below the unit
        std::uint64_t mantissa = (bits & ((std::uint64_t{1} << 52) - 1)) | std::uint64_t{1} << 52;
        int shift = exponent - 1075 + unit_bits;
        if (shift < 0) {
            if (shift <= -53) return *this;
            mantissa >>= -shift, shift = 0;
        }
        if (shift > 64 * words - 1 - 53 - 1) {
            ++not_summed;
            return *this;
        }
        const int first = shift >> 6, within = shift & 63;
        const std::uint64_t low = mantissa << within, high = within == 0 ? 0 : mantissa >> (64 - within);
        // Two's complement: all bits are inverted, and 1 is added.
        const std::uint64_t sign = std::uint64_t{0} - (bits >> 63);
        std::uint64_t carry = bits >> 63;
        for (int k = 0; k < words; ++k) {
            const std::uint64_t term = ((k == first ? low : k == first + 1 ? high : 0) ^ sign);
            add(k, term, carry);
        }
        return *this;
    }
    HILDA_HD FixedSum& operator+=(const FixedSum& o)
    {
        std::uint64_t carry = 0;
        for (int k = 0; k < words; ++k) add(k, o.word[k], carry);
        not_summed += o.not_summed;
        return *this;
    }

    /// The nearest double; NaN if a term could not be added
    double value() const
    {
        if (not_summed > 0) return NAN;
        FixedSum size = *this;
        const bool negative = word[words - 1] >> 63 != 0;
        if (negative) {
            std::uint64_t carry = 1;
            for (int k = 0; k < words; ++k) size.word[k] = 0, size.add(k, ~word[k], carry);
        }
        int top = words - 1;
        while (top > 0 && size.word[top] == 0) --top;
        if (size.word[top] == 0) return 0;
        const int free = __builtin_clzll(size.word[top]);
        std::uint64_t leading = size.word[top] << free, rest = 0;
        if (top > 0 && free > 0) leading |= size.word[top - 1] >> (64 - free);
        if (top > 0) rest = size.word[top - 1] << free;
        for (int k = 0; k < top - 1; ++k) rest |= size.word[k];
        // The last bit is below the rounding of the conversion. It stands for the remaining ones.
        const double all =
            std::ldexp(static_cast<double>(leading | (rest != 0 ? 1 : 0)), 64 * top - free - unit_bits);
        return negative ? -all : all;
    }

private:
    static constexpr int unit_bits = 140;

    HILDA_HD void add(int k, std::uint64_t term, std::uint64_t& carry)
    {
        const std::uint64_t first = word[k] + term, sum = first + carry;
        carry = (first < term ? 1 : 0) + (sum < first ? 1 : 0);
        word[k] = sum;
    }

    std::uint64_t word[words] = {};  ///< the lowest first, in two's complement
    std::uint64_t not_summed = 0;    ///< number of terms that could not be added
};

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

}  // namespace hilda::granular
