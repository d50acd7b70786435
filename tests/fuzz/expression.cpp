// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/expression.hpp"
#include "tests/fuzz/targets.hpp"

#include <cmath>
#include <cstdlib>

namespace hilda::fuzz {

void expression(std::string_view input)
{
    try {
        const io::Expression e(input, {"t"}, {{"l", 2.5}});
        for (const double t : {0., 0.3, -2., 1e300}) {
            const double value = e.value(t), f = e.jet(t).f;
            if (value != f && !(std::isnan(value) && std::isnan(f))) std::abort();  // f always equals value()
        }
    } catch (const io::ExpressionError&) {
    }
}

}  // namespace hilda::fuzz
