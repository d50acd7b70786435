// SPDX-License-Identifier: GPL-3.0-or-later
/// Parser of expressions (recursive descent) and evaluation of the postfix program for numbers and jets.

#include "io/expression.hpp"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <numbers>
#include <system_error>
#include <type_traits>

#include "io/arithmetic/range.hpp"
#include "io/formats/characters.hpp"
#include "io/nearest.hpp"

namespace hilda::io {
namespace {

using Op = Expression::Op;
using Instruction = Expression::Instruction;

struct Function {
    std::string_view name;
    Op op;
    int arity;
};

constexpr Function functions[] = {
    {"sin", Op::sin, 1},   {"cos", Op::cos, 1},   {"tan", Op::tan, 1},   {"asin", Op::asin, 1},
    {"acos", Op::acos, 1}, {"atan", Op::atan, 1}, {"sinh", Op::sinh, 1}, {"cosh", Op::cosh, 1},
    {"tanh", Op::tanh, 1}, {"exp", Op::exp, 1},   {"log", Op::log, 1},   {"sqrt", Op::sqrt, 1},
    {"abs", Op::abs, 1},   {"min", Op::min, 2},   {"max", Op::max, 2},   {"step", Op::step, 1},
    {"if", Op::select, 3},
};

// --- evaluation ---

// The functions for double. Those for Jet are found by argument-dependent lookup.
using std::abs, std::exp, std::log, std::pow, std::sqrt;
using std::sin, std::cos, std::tan, std::asin, std::acos, std::atan, std::sinh, std::cosh, std::tanh;

template <class T>
T constant(double c)
{
    if constexpr (std::is_same_v<T, Jet>)
        return {c, 0, 0};
    else if constexpr (std::is_same_v<T, RangeJet>)
        return {Range::point(c), Range::point(0)};
    else
        return c;
}

/// xⁿ by repeated squaring. At x = 0 the derivative n xⁿ⁻¹ ẋ then contains no product 0·inf.
template <class T>
T power(T x, int n)
{
    if (n < 0) return constant<T>(1) / power(x, -n);
    if constexpr (std::is_same_v<T, RangeJet>) return natural_power(x, n);
    T y = constant<T>(1);
    for (; n > 0; n /= 2) {
        if (n % 2 == 1) y = y * x;
        x = x * x;
    }
    return y;
}

/// The smaller and the larger of two numbers or jets; those of ranges are in io/arithmetic/range.hpp
template <class T>
T min(const T& a, const T& b)
{
    return select(b - a, a, b);
}
template <class T>
T max(const T& a, const T& b)
{
    return select(a - b, a, b);
}

/// Evaluates the program for T = double, Jet or RangeJet. x[0] is the top of the value stack; its first
/// element is not used.
template <class T>
T evaluate(std::span<const Instruction> program, std::span<const T> variables) noexcept
{
    T stack[2 + Expression::max_depth];  // the argument of a switching function may be one level deeper
    T* x = stack;
    for (const Instruction& i : program) {
        switch (i.op) {
            // clang-format off
            case Op::constant:      *++x = constant<T>(i.c); break;
            case Op::variable:      *++x = variables[i.n]; break;
            case Op::add:           --x; x[0] = x[0] + x[1]; break;
            case Op::subtract:      --x; x[0] = x[0] - x[1]; break;
            case Op::multiply:      --x; x[0] = x[0] * x[1]; break;
            case Op::divide:        --x; x[0] = x[0] / x[1]; break;
            case Op::negate:        x[0] = -x[0]; break;
            case Op::integer_power: x[0] = power(x[0], i.n); break;
            case Op::real_power:    x[0] = pow(x[0], i.c); break;
            case Op::sin:           x[0] = sin(x[0]); break;
            case Op::cos:           x[0] = cos(x[0]); break;
            case Op::tan:           x[0] = tan(x[0]); break;
            case Op::asin:          x[0] = asin(x[0]); break;
            case Op::acos:          x[0] = acos(x[0]); break;
            case Op::atan:          x[0] = atan(x[0]); break;
            case Op::sinh:          x[0] = sinh(x[0]); break;
            case Op::cosh:          x[0] = cosh(x[0]); break;
            case Op::tanh:          x[0] = tanh(x[0]); break;
            case Op::exp:           x[0] = exp(x[0]); break;
            case Op::log:           x[0] = log(x[0]); break;
            case Op::sqrt:          x[0] = sqrt(x[0]); break;
            case Op::abs:           x[0] = abs(x[0]); break;
            case Op::min:           --x; x[0] = min(x[0], x[1]); break;
            case Op::max:           --x; x[0] = max(x[0], x[1]); break;
            case Op::step:          x[0] = step(x[0]); break;
            case Op::select:        x -= 2; x[0] = select(x[0], x[1], x[2]); break;
                // clang-format on
        }
    }
    return x[0];
}

// --- parser ---

bool is_letter(char c) { return ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z') || c == '_'; }
bool is_name_character(char c) { return is_letter(c) || is_digit(c) || c == '.'; }

/// The number at the beginning of a text; its length is 0 if there is none
struct Literal {
    double value = 0;
    std::size_t length = 0;
    std::errc error = {};
};

Literal literal_at(std::string_view text)
{
    Literal found;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), found.value);
    found.length = static_cast<std::size_t>(end - text.data()), found.error = error;
    return found;
}

/// The name at the beginning of a text
std::string_view name_at(std::string_view text)
{
    return {text.begin(), std::find_if_not(text.begin(), text.end(), is_name_character)};
}

/// Part of the text for messages: one line of at most 60 characters around the given position
std::string excerpt(std::string_view text, std::size_t place)
{
    constexpr std::size_t width = 60;
    const std::size_t begin = text.size() <= width || place < width / 2 ? 0 : place - width / 2;
    std::string s(text.substr(begin, width));
    for (char& c : s)
        if (c < ' ' || c > '~') c = '?';
    return (begin > 0 ? "..." : "") + s + (begin + width < text.size() ? "..." : "");
}

/// Recursive descent, one function per rule:
///
///     sum     = product { (+|-) product }
///     product = signed { (*|/) signed }
///     signed  = (-|+) signed  |  power
///     power   = operand [ (^|**) signed ]
///     operand = number | name | { name } | function ( sum {, sum} ) | ( sum )
class Parser {
public:
    Parser(std::string_view text, const std::vector<std::string>& variables,
           const Expression::Constants& constants)
        : text(text), variables(variables), constants(constants)
    {}

    std::vector<Instruction> parse()
    {
        if (text.size() > Expression::max_characters)
            fail("more than " + std::to_string(Expression::max_characters) + " characters",
                 Expression::max_characters);
        skip_blanks();
        if (at_end()) fail("empty expression", place);
        sum();
        if (!at_end()) fail_misplaced();
        return program;
    }

private:
    struct Infix {
        std::string_view symbol;
        Op op;
    };

    void sum() { left_associative(&Parser::product, {{"+", Op::add}, {"-", Op::subtract}}); }
    void product() { left_associative(&Parser::signed_power, {{"*", Op::multiply}, {"/", Op::divide}}); }

    /// part { symbol part }
    void left_associative(void (Parser::*part)(), const Infix (&operators)[2])
    {
        (this->*part)();
        for (;;) {
            const std::size_t at = place;
            const Infix* const found =
                std::find_if(operators, operators + 2, [&](const Infix& o) { return accept(o.symbol); });
            if (found == operators + 2) return;
            (this->*part)();
            apply({found->op}, 2, at);
        }
    }

    void signed_power()
    {
        // Every recursion passes through this function, so that the call stack is bounded as well.
        if (++nesting > Expression::max_depth) fail_too_deep(place);
        const std::size_t at = place;
        if (accept("-")) {
            signed_power();
            apply({Op::negate}, 1, at);
        } else if (accept("+")) {
            signed_power();
        } else {
            power();
        }
        --nesting;
    }

    void power()
    {
        constexpr int max_multiplied = 64;  // for larger exponents pow() is accurate and not slower
        operand();
        const std::size_t at = place;
        if (!accept("**") && !accept("^")) return;
        const std::size_t exponent_at = place, exponent_begin = program.size();
        signed_power();
        if (program.size() != exponent_begin + 1 || program.back().op != Op::constant)
            fail("the exponent must be constant", exponent_at, "a^b with variable b is exp(b*log(a))");
        const double p = program.back().c;
        program.pop_back();
        --height;
        if (std::abs(p) <= max_multiplied && p == std::trunc(p))
            apply({.op = Op::integer_power, .n = static_cast<int>(p)}, 1, at);
        else
            apply({.op = Op::real_power, .c = p}, 1, at);
    }

    void operand()
    {
        const std::size_t at = place;
        if (at_end()) fail("the expression ends where a value is expected", at);
        const char c = text[place];
        if (is_digit(c) || c == '.') return number();
        if (is_letter(c)) return name();
        if (c == '{') return name_in_braces();
        if (accept("(")) {
            sum();
            return close(at);
        }
        if (std::string_view("*/^),").find(c) != std::string_view::npos)
            fail(std::string("a value is missing before '") + c + "'", at);
        fail_character();
    }

    void number()
    {
        const std::size_t at = place;
        const Literal found = literal_at(text.substr(at));
        if (found.error == std::errc::result_out_of_range)
            fail("the number '" + excerpt(text.substr(at, found.length), 0) + "' is out of range", at);
        if (found.error != std::errc()) fail("'.' without digits is not a number", at);
        place += found.length;
        skip_blanks();
        push({.op = Op::constant, .c = found.value}, at);
    }

    void name()
    {
        const std::size_t at = place;
        const std::string_view word = name_at(text.substr(at));
        place += word.size();
        skip_blanks();

        const auto variable = std::find(variables.begin(), variables.end(), word);
        const auto function = std::find_if(std::begin(functions), std::end(functions),
                                           [&](const Function& f) { return f.name == word; });
        const auto constant =
            std::find_if(constants.begin(), constants.end(), [&](const auto& c) { return c.first == word; });
        if (variable != variables.end())
            push({.op = Op::variable, .n = static_cast<int>(variable - variables.begin())}, at);
        else if (constant != constants.end())
            push({.op = Op::constant, .n = 1, .c = constant->second}, at);
        else if (word == "pi")
            push({.op = Op::constant, .c = std::numbers::pi}, at);
        else if (word == "e")
            push({.op = Op::constant, .c = std::numbers::e}, at);
        else if (function != std::end(functions))
            call(*function, at);
        else
            fail_unknown(word, at);
    }

    /// {any characters}: the variable of this name
    void name_in_braces()
    {
        const std::size_t at = place, end = text.find('}', at);
        if (end == std::string_view::npos) fail("'{' is never closed", at);
        const std::string_view word = text.substr(at + 1, end - at - 1);
        place = end + 1;
        skip_blanks();
        const auto variable = std::find(variables.begin(), variables.end(), word);
        if (variable == variables.end()) fail_unknown(word, at);
        push({.op = Op::variable, .n = static_cast<int>(variable - variables.begin())}, at);
    }

    void call(const Function& function, std::size_t at)
    {
        const std::string name = "'" + std::string(function.name) + "'";
        const std::size_t open = place;
        if (!accept("(")) fail("the function " + name + " needs its arguments in parentheses", at);
        int n = 0;
        if (at_end() || text[place] != ')') {
            do {
                sum();
                ++n;
            } while (accept(","));
        }
        close(open);
        if (n != function.arity)
            fail("wrong number of arguments of " + name + ": " + std::to_string(n) + " instead of " +
                     std::to_string(function.arity),
                 at);
        apply({function.op}, function.arity, at);
    }

    void close(std::size_t open)
    {
        if (at_end()) fail("'(' is never closed", open);
        if (!accept(")")) fail_misplaced();
    }

    // characters

    bool at_end() const { return place == text.size(); }

    void skip_blanks()
    {
        while (!at_end() && (text[place] == ' ' || text[place] == '\t')) ++place;
    }

    bool accept(std::string_view symbol)
    {
        if (!text.substr(place).starts_with(symbol)) return false;
        place += symbol.size();
        skip_blanks();
        return true;
    }

    // program

    /// Appends an instruction that puts one value on the stack.
    void push(const Instruction& operand, std::size_t at)
    {
        if (++height > Expression::max_depth) fail_too_deep(at);
        append(operand, at);
    }

    /// Appends an operation on the last n values. If these are constants, the operation is replaced by its
    /// result.
    void apply(const Instruction& operation, int n, std::size_t at)
    {
        append(operation, at);
        height -= n - 1;
        const auto tail = std::span(program).last(n + 1);
        const auto is_constant = [](const Instruction& i) { return i.op == Op::constant; };
        if (!std::all_of(tail.begin(), tail.end() - 1, is_constant)) return;
        const bool has_named =
            std::any_of(tail.begin(), tail.end() - 1, [](const Instruction& i) { return i.n != 0; });
        const double c = evaluate<double>(tail, {});
        if (!std::isfinite(c) && has_named) return;  // it may be the other value of if(c,a,b)
        if (!std::isfinite(c)) fail("this constant part is not finite", at);
        program.resize(program.size() - tail.size());
        program.push_back({.op = Op::constant, .n = has_named, .c = c});
    }

    void append(const Instruction& instruction, std::size_t at)
    {
        if (program.size() == Expression::max_instructions)
            fail("more than " + std::to_string(Expression::max_instructions) + " instructions", at);
        program.push_back(instruction);
    }

    // errors

    [[noreturn]] void fail(const std::string& what, std::size_t at, const std::string& hint = "") const
    {
        const int column = static_cast<int>(at) + 1;
        throw ExpressionError(what + " in \"" + excerpt(text, at) + "\" at column " + std::to_string(column) +
                                  (hint.empty() ? "" : "; " + hint),
                              column);
    }

    [[noreturn]] void fail_too_deep(std::size_t at) const
    {
        fail("nested deeper than " + std::to_string(Expression::max_depth) + " levels", at);
    }

    [[noreturn]] void fail_character() const
    {
        const auto code = static_cast<unsigned char>(text[place]);
        if (code >= 128) fail("a character outside ASCII", place);
        if (code < ' ' || code == 127) fail("control character (code " + std::to_string(code) + ")", place);
        fail(std::string("unexpected '") + text[place] + "'", place);
    }

    /// Error: the text continues after a complete value without an operator.
    [[noreturn]] void fail_misplaced() const
    {
        const char c = text[place];
        if (c == ')') fail("')' was never opened", place);
        if (c == ',') fail("',' outside of the arguments of a function", place);
        if (is_digit(c) || is_letter(c) || c == '.' || c == '(')
            fail(std::string("missing operator before '") + c + "'", place, "products are written with '*'");
        fail_character();
    }

    [[noreturn]] void fail_unknown(std::string_view word, std::size_t at) const
    {
        const bool called = !at_end() && text[place] == '(';
        std::vector<std::string> known;
        if (called) {
            known = Expression::function_names();
        } else {
            known = variables;
            for (const auto& [name, value] : constants) known.push_back(name);
            known.insert(known.end(), {"pi", "e"});
        }
        std::string hint = nearest(word, known);
        if (!hint.empty()) {
            hint = "did you mean '" + hint + "'?";
        } else {
            constexpr std::size_t most = 12;
            for (std::size_t k = 0; k < std::min(known.size(), most); ++k)
                hint += (hint.empty() ? "known: " : ", ") + known[k];
            if (known.size() > most) hint += ", ...";
        }
        fail((called ? "unknown function '" : "unknown name '") + excerpt(word, 0) + "'", at, hint);
    }

    std::string_view text;
    const std::vector<std::string>& variables;
    const Expression::Constants& constants;
    std::vector<Instruction> program;
    std::size_t place = 0;  // position of the next character
    int nesting = 0;        // recursion depth of signed_power
    int height = 0;         // number of values on the stack after the last instruction
};

}  // namespace

Expression::Expression(std::string_view text, const std::vector<std::string>& variables,
                       const Constants& constants)
    : source(text), arity(variables.size()), program(Parser(text, variables, constants).parse())
{}

std::vector<std::string> Expression::function_names()
{
    std::vector<std::string> names;
    for (const Function& f : functions) names.emplace_back(f.name);
    return names;
}

std::vector<Expression::Name> Expression::names(std::string_view text)
{
    std::vector<Name> names;
    for (std::size_t k = 0; k < text.size();) {
        if (is_digit(text[k]) || text[k] == '.') {
            k += std::max<std::size_t>(literal_at(text.substr(k)).length, 1);
        } else if (is_letter(text[k])) {
            const std::string_view word = name_at(text.substr(k));
            const std::size_t next = text.find_first_not_of(" \t", k + word.size());
            if (next == std::string_view::npos || text[next] != '(') names.push_back({k, std::string(word)});
            k += word.size();
        } else if (text[k] == '{') {
            k = std::min(text.find('}', k), text.size());
        } else {
            ++k;
        }
    }
    return names;
}

bool Expression::is_name(std::string_view text)
{
    return !text.empty() && is_letter(text[0]) &&
           std::all_of(text.begin(), text.end(), [](char c) { return is_letter(c) || is_digit(c); });
}

double Expression::value(std::span<const double> x) const noexcept
{
    assert(x.size() == arity);
    return is_constant() ? program[0].c : evaluate(program, x);
}

Jet Expression::jet(double t) const noexcept
{
    assert(arity == 1);
    const Jet x{t, 1, 0};
    return is_constant() ? Jet{program[0].c, 0, 0} : evaluate(program, std::span(&x, 1));
}

bool Expression::uses(std::size_t k) const
{
    return std::any_of(program.begin(), program.end(), [&](const Instruction& i) {
        return i.op == Op::variable && i.n == static_cast<int>(k);
    });
}

RangeJet Expression::bounds(const Range& t) const
{
    assert(arity == 1);
    const RangeJet x{t, Range::point(1)};
    return evaluate(std::span<const Instruction>(program), std::span(&x, 1));
}

std::string_view Expression::outermost() const
{
    for (const Function& f : functions)
        if (f.op == program.back().op) return f.name;
    return "";
}

}  // namespace hilda::io
