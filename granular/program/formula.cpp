// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/program/formula.hpp"

#ifdef HILDA_FORMULAS
// The only include from another folder: models and cases share one grammar of formulas.
#include "dae/expression.hpp"
#endif

namespace hilda::granular {

Formula compile(const std::string& text)
{
#ifdef HILDA_FORMULAS
    try {
        return [e = dae::Expression(text)](double t) { return e.value(t); };
    } catch (const dae::ExpressionError& e) {
        throw InvalidCase(e.what());
    }
#else
    throw InvalidCase("must be a number, got \"" + text +
                      "\": this program was built without formulas (dae/expression.cpp)");
#endif
}

}  // namespace hilda::granular
