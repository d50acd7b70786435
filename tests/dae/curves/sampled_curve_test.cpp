// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/curves/sampled_curve.hpp"

#include "lie/check.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace hilda;
using dae::SampledCurve;

TEST_CASE("samples whose times are nearly equal have a spline or are refused", "[dae][curves]")
{
    int refused = 0, accepted = 0;
    for (const double begin : {0., -1e3, -1e9})
        for (double gap = 1; gap > 1e-17; gap /= 10)
            for (const int equal : {1, 3, 6}) {  // times that are `gap` apart
                CAPTURE(begin, gap, equal);
                std::vector<double> t = {begin, begin + 1}, f;
                for (int k = 0; k < equal; ++k) t.push_back(t.back() + gap);
                for (int k = 0; k < 5; ++k) t.push_back(t.back() + 1);
                for (const double at : t) f.push_back(std::cos(at - begin));
                try {
                    const SampledCurve curve(t, f);
                    ++accepted;
                    for (std::size_t k = 0; k < t.size(); ++k)
                        CHECK(std::abs(curve.jet(t[k]).f - f[k]) < 1e-9);
                } catch (const lie::InvalidInput&) {
                    ++refused;
                }
            }
    CHECK(accepted > 40);
    CHECK(refused > 40);
}
