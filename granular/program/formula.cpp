// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/program/formula.hpp"

#ifdef HILDA_FORMULAS
// The one file of this room that knows of another: two grammars in one project would be one too many.
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
                      "\": this program was built without dae/expression.cpp, which reads formulas");
#endif
}

}  // namespace hilda::granular
