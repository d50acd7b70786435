// SPDX-License-Identifier: GPL-3.0-or-later
/// Arithmetic expressions of the model file, such as "pi/4*cos(2*t)". They are compiled once and evaluated
/// with exact derivatives.

#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/arithmetic/jet.hpp"

namespace hilda::io {

struct Range;
struct RangeJet;

/// An invalid expression. The message quotes its text, for example
///     unknown function 'sine' in "sine(2*t)" at column 1; did you mean 'sin'?
class ExpressionError : public std::runtime_error {
public:
    ExpressionError(const std::string& message, int column) : std::runtime_error(message), column(column) {}

    int column;  ///< column of the error, counted from 1
};

/// An arithmetic expression in named variables, compiled to a postfix program.
///
///     numbers     1  .5  1.  2e-3, independent of the locale
///     names       the variables, pi, e. A variable may have the name pi or e. Names consist of letters, digits, _
///                 and dots; a variable with another name is written in braces: {ball-floor.F_N}.
///     operators   + - * / and ^ (also **). ^ is right associative and binds more tightly than a sign on its
///                 left: -t^2 = -(t^2), 2^-3 = 1/8. The exponent is constant. Integer exponents up to 64 are
///                 evaluated by multiplication, so that 0^2 and (-2)^3 are exact. x^0 = 1.
///     functions   sin cos tan asin acos atan sinh cosh tanh exp log sqrt abs
///                 min(a,b)  max(a,b)
///                 step(x)      0 for x < 0, else 1
///                 if(c,a,b)    a for c > 0, else b; the other value may be inf or nan
///
/// Derivatives are exact. At a kink of abs, min, max and if, fdot and fddot are those of the branch that is
/// valid immediately after t. The branch is determined from the first two derivatives of the compared
/// expressions. f always equals value(). A jump of if or step does not appear in the derivatives. A
/// derivative that does not exist (sqrt at 0, asin at 1) is inf or nan. If c in if(c,a,b) is nan, the result
/// is nan.
///
/// Constant parts are evaluated when the text is read; they must be finite. The constructor throws
/// ExpressionError. The evaluation does not throw and does not allocate memory.
class Expression {
public:
    static constexpr int max_characters = 4096;
    static constexpr int max_instructions = 1024;
    static constexpr int max_depth = 64;  ///< of parentheses, signs and powers; size of the value stack

    /// Named numbers. A part that consists of them and of digits is evaluated when the text is read, unless
    /// its value is not finite. A variable takes precedence over a constant of the same name.
    using Constants = std::vector<std::pair<std::string, double>>;

    /// Compiles the text. `variables` gives the names and the order of the variables.
    explicit Expression(std::string_view text, const std::vector<std::string>& variables = {"t"},
                        const Constants& constants = {});

    /// Value for these variables, in the order of the constructor
    double value(std::span<const double> x) const noexcept;
    double value(double t) const noexcept { return value({&t, 1}); }

    /// Value, first and second derivative of an expression in one variable
    Jet jet(double t) const noexcept;

    /// Bounds of the value and of its derivative over an interval, of an expression in one variable
    RangeJet bounds(const Range& t) const;

    /// The functions whose zeros are the places where the expression is not smooth: the arguments of step, of
    /// the condition of if, of abs and sqrt, the difference of those of min and max, and those of asin and
    /// acos minus ±1. With `jumps` only those of step and if. They have the variables of this expression.
    enum class Switches { all, jumps };
    std::vector<Expression> switching_functions(Switches which = Switches::all) const;
    /// The largest parts with this variable and no other one, as expressions in one variable: the whole
    /// expression if it has no other variable. Parts that consist of the variable alone are left out.
    std::vector<Expression> parts_in(std::size_t variable) const;

    bool is_constant() const { return program.size() == 1 && program[0].op == Op::constant; }

    /// Name of the outermost function: "cos" for cos(2*t), "" for 2*cos(t) or a constant
    std::string_view outermost() const;

    const std::string& text() const { return source; }

    /// Number of the variables of the constructor
    std::size_t variables() const { return arity; }
    /// Whether the value depends on variable k
    bool uses(std::size_t k) const;
    /// Names of all functions
    static std::vector<std::string> function_names();

    /// A name in a text
    struct Name {
        std::size_t begin;
        std::string text;
    };
    /// The names of variables and constants in the order of the text, which may be invalid otherwise. Names
    /// in braces are left out.
    static std::vector<Name> names(std::string_view text);
    /// Whether a text is a name: letters, digits and _, without a digit at the beginning
    static bool is_name(std::string_view text);

    enum class Op {
        // clang-format off
        constant, variable, add, subtract, multiply, divide, negate, integer_power, real_power,
        sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, exp, log, sqrt, abs, min, max, step, select
        // clang-format on
    };

    struct Instruction {
        Op op;
        int n = 0;     ///< number of the variable, integer exponent, or 1 for a part with named constants
        double c = 0;  ///< constant, or real exponent
    };

private:
    std::string source;
    std::size_t arity;
    std::vector<Instruction> program;
};

}  // namespace hilda::io
