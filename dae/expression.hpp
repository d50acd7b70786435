// SPDX-License-Identifier: GPL-3.0-or-later
/// Formulas of the model file, such as "pi/4*cos(2*t)": compiled once, evaluated with exact derivatives.

#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "dae/jet.hpp"

namespace hilda::dae {

/// A text that is no expression. The message quotes it, e.g.
///     unknown function 'sine' in "sine(2*t)" at column 1; did you mean 'sin'?
class ExpressionError : public std::runtime_error {
public:
    ExpressionError(const std::string& message, int column) : std::runtime_error(message), column(column) {}

    int column;  ///< of the first character that is wrong, counted from 1
};

/// An arithmetic expression in named variables, held as a flat postfix program.
///
///     numbers     1  .5  1.  2e-3; the same in every locale
///     names       the variables, pi, e; a variable may hide the other two
///     operators   + - * /, and ^ (also **), which is right associative and binds more tightly than a
///                 sign on its left: -t^2 = -(t^2), 2^-3 = 1/8. The exponent is constant; with an integer
///                 one 0^2 and (-2)^3 are exact, and x^0 = 1.
///     functions   sin cos tan asin acos atan sinh cosh tanh exp log sqrt abs
///                 min(a,b)  max(a,b)
///                 step(x)      0 for x < 0, else 1
///                 if(c,a,b)    a for c > 0, else b; the other one may be inf or nan
///
/// Derivatives are exact. abs, min, max and if have kinks; there fdot and fddot are those of the branch that
/// holds just after t, found from the first two derivatives of what is compared. f itself is always value():
/// where if or step jumps, no derivative tells of the jump. Where a derivative does not exist (sqrt at 0,
/// asin at 1), it is inf or nan; nan in c of if(c,a,b) gives nan.
///
/// Parts without variables are computed when the text is read, and refused if not finite. Reading throws
/// ExpressionError; evaluation neither throws nor allocates.
class Expression {
public:
    static constexpr int max_characters = 4096;
    static constexpr int max_instructions = 1024;
    static constexpr int max_depth = 64;  ///< of nested parentheses, signs and powers, and of the value stack

    explicit Expression(std::string_view text, const std::vector<std::string>& variables = {"t"});

    /// The value for these variables, in the order of the constructor.
    double value(std::span<const double> x) const noexcept;
    double value(double t) const noexcept { return value({&t, 1}); }

    /// Value and time derivatives of an expression in t alone.
    Jet jet(double t) const noexcept;

    bool is_constant() const { return program.size() == 1 && program[0].op == Op::constant; }

    /// The function applied last: "cos" for cos(2*t), "" for 2*cos(t) or a constant.
    std::string_view outermost() const;

    const std::string& text() const { return source; }

    enum class Op {
        // clang-format off
        constant, variable, add, subtract, multiply, divide, negate, integer_power, real_power,
        sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, exp, log, sqrt, abs, min, max, step, select
        // clang-format on
    };

    struct Instruction {
        Op op;
        int n = 0;     ///< which variable, or the integer exponent
        double c = 0;  ///< the constant, or the real exponent
    };

private:
    std::string source;
    std::size_t arity;
    std::vector<Instruction> program;
};

}  // namespace hilda::dae
