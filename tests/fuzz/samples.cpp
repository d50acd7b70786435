// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/curves/sampled_curve.hpp"
#include "lie/check.hpp"
#include "tests/fuzz/targets.hpp"

#include <cmath>
#include <cstdlib>

namespace hilda::fuzz {

void samples(std::string_view input)
{
    std::vector<double> t, f;
    const std::string text(input);
    const char* at = text.c_str();
    while (true) {
        char* end = nullptr;
        const double number = std::strtod(at, &end);
        if (end == at) break;
        (t.size() > f.size() ? f : t).push_back(number);
        at = end;
    }
    t.resize(f.size());
    try {
        const dae::SampledCurve curve(t, f);
        for (const double part : {0., 0.3, 0.7, 1.}) {
            const double time = curve.first() + part * (curve.last() - curve.first());
            curve.jet(time);
            if (!(curve.next_knot(time) > time)) std::abort();
        }
    } catch (const lie::InvalidInput&) {
    } catch (const lie::NumericalFailure&) {
    }
}

}  // namespace hilda::fuzz
