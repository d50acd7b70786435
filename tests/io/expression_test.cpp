// SPDX-License-Identifier: GPL-3.0-or-later
/// Expressions: values, exact derivatives, and errors with their columns.

#include "io/expression.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

using namespace hilda::io;

namespace {

double at(const std::string& text, double t = 0) { return Expression(text).value(t); }

/// Compares fdot and fddot with central differences of f and fdot. Their error is h²/6 f''' + eps f/h, about
/// 1e-10.
void check_derivatives(const std::string& text, double t)
{
    const Expression f(text);
    const double h = 1e-5;
    const Jet a = f.jet(t - h), b = f.jet(t), c = f.jet(t + h);
    const double scale = 1 + std::abs(b.f) + std::abs(b.fdot) + std::abs(b.fddot);
    INFO(text << " at t = " << t);
    CHECK(b.f == f.value(t));
    CHECK(b.fdot == Approx((c.f - a.f) / (2 * h)).margin(1e-7 * scale));
    CHECK(b.fddot == Approx((c.fdot - a.fdot) / (2 * h)).margin(1e-7 * scale));
}

/// A smooth expression that is finite for all t and has moderate third derivatives
std::string random_expression(std::mt19937& random, int depth)
{
    const auto sub = [&] { return random_expression(random, depth - 1); };
    const auto pick = [&](int n) { return static_cast<int>(random() % n); };
    if (depth == 0) return std::array{"t", "0.3*t", "1.25", "pi", "(t-1)"}[pick(5)];
    switch (pick(8)) {
        case 0:
            return sub() + "+" + sub();
        case 1:
            return "-(" + sub() + ")-" + sub();
        case 2:
            return "sin(" + sub() + ")*cos(" + sub() + ")";
        case 3:
            return "(" + sub() + ")/(2+sin(" + sub() + "))";
        case 4:
            return "tanh(" + sub() + ")^" + std::to_string(pick(4));
        case 5:
            return "(3+cos(" + sub() + "))^-1.5";
        case 6:
            return "exp(sin(" + sub() + "))";
        default:
            return "atan(" + sub() + ")**2";
    }
}

struct InvalidExpression {
    std::string text;
    int column;
    std::string message;  // part of the message
};

std::string times(int n, const std::string& s)
{
    std::string all;
    for (int i = 0; i < n; ++i) all += s;
    return all;
}

std::vector<InvalidExpression> invalid_expressions()
{
    return {
        {"sine(2*t)", 1, "unknown function 'sine' in \"sine(2*t)\" at column 1; did you mean 'sin'?"},
        {"1+cso(t)", 3, "did you mean 'cos'?"},
        {"arcsin(t)", 1, "did you mean 'asin'?"},
        {"pow(t,2)", 1, "known: sin, cos, tan"},
        {"2*Pi", 3, "did you mean 'pi'?"},
        {"2*T", 3, "did you mean 't'?"},
        {"x", 1, "unknown name 'x' in \"x\" at column 1; known: t, pi, e"},
        {"inf", 1, "unknown name 'inf'"},
        {"nan", 1, "unknown name 'nan'"},
        {"2*_a1", 3, "unknown name '_a1'"},
        {"", 1, "empty expression"},
        {"  \t", 4, "empty expression"},
        {"2 t", 3, "missing operator before 't'"},
        {"2t", 2, "missing operator before 't'"},
        {"2e", 2, "missing operator before 'e'"},
        {"0x10", 2, "missing operator before 'x'"},
        {"1.5.2", 4, "missing operator before '.'"},
        {"t 2", 3, "missing operator before '2'"},
        {"t(2)", 2, "missing operator before '('"},
        {"(t)(t)", 4, "missing operator before '('"},
        {"sin(t)cos(t)", 7, "missing operator before 'c'"},
        {"(t 1)", 4, "missing operator before '1'"},
        {"t+", 3, "ends where a value is expected"},
        {"sin(", 5, "ends where a value is expected"},
        {"-", 2, "ends where a value is expected"},
        {"2^", 3, "ends where a value is expected"},
        {"*t", 1, "a value is missing before '*'"},
        {"t+/2", 3, "a value is missing before '/'"},
        {"t* *2", 4, "a value is missing before '*'"},
        {"t***2", 4, "a value is missing before '*'"},
        {"t^^2", 3, "a value is missing before '^'"},
        {"()", 2, "a value is missing before ')'"},
        {"max(t,)", 7, "a value is missing before ')'"},
        {"max(,t)", 5, "a value is missing before ','"},
        {"(t+1", 1, "'(' is never closed"},
        {"2*sin(t", 6, "'(' is never closed"},
        {"((t)", 1, "'(' is never closed"},
        {"t)", 2, "')' was never opened"},
        {"(t))+1", 4, "')' was never opened"},
        {"t,1", 2, "',' outside of the arguments"},
        {"(t,1)", 3, "',' outside of the arguments"},
        {"sin t", 1, "the function 'sin' needs its arguments in parentheses"},
        {"2+cos", 3, "the function 'cos' needs its arguments in parentheses"},
        {"sin()", 1, "wrong number of arguments of 'sin': 0 instead of 1"},
        {"1+sin(t,t)", 3, "wrong number of arguments of 'sin': 2 instead of 1"},
        {"min(t)", 1, "wrong number of arguments of 'min': 1 instead of 2"},
        {"max(1,2,t)", 1, "wrong number of arguments of 'max': 3 instead of 2"},
        {"if(t,1)", 1, "wrong number of arguments of 'if': 2 instead of 3"},
        {"t^t", 3, "the exponent must be constant"},
        {"2^-sin(t)", 3, "the exponent must be constant"},
        {"1e999", 1, "the number '1e999' is out of range"},
        {"t+1e-999", 3, "the number '1e-999' is out of range"},
        {".", 1, "'.' without digits is not a number"},
        {"t+.e3", 3, "'.' without digits is not a number"},
        {"t/0*(1/0)", 7, "not finite"},
        {"t+log(-1)", 3, "not finite"},
        {"(-8)^(1/3)", 5, "not finite"},
        {"1e308*10", 6, "not finite"},
        {"t=3", 2, "unexpected '='"},
        {"t$", 2, "unexpected '$'"},
        {"$", 1, "unexpected '$'"},
        {"t;1", 2, "unexpected ';'"},
        {"[t]", 1, "unexpected '['"},
        {"'t'", 1, "unexpected '''"},
        {"2*\u03c0", 3, "a character outside ASCII"},
        {"t\u00b2", 2, "a character outside ASCII"},
        {"t+\n1", 3, "control character (code 10)"},
        {std::string("t\0+1", 4), 2, "control character (code 0)"},
        {std::string(4097, ' '), 4097, "more than 4096 characters"},
        {"t" + times(512, "+t"), 1024, "more than 1024 instructions"},
        {times(64, "(") + "t" + times(64, ")"), 65, "nested deeper than 64 levels"},
        {times(3000, "("), 65, "nested deeper than 64 levels"},
        {times(3000, "-"), 65, "nested deeper than 64 levels"},
        {"1" + times(500, "^2"), 129, "nested deeper than 64 levels"},
        {times(40, "max(t,t*") + "t" + times(40, ")"), 261, "nested deeper than 64 levels"},  // of values
    };
}

}  // namespace

TEST_CASE("operators have the precedence and associativity of mathematics", "[io][expression]")
{
    CHECK(at("1+2*3") == 7);
    CHECK(at("(1+2)*3") == 9);
    CHECK(at("10-4-3") == 3);
    CHECK(at("16/4/2") == 2);
    CHECK(at("16/4*2") == 8);
    CHECK(at("2^3^2") == 512);
    CHECK(at("2**3**2") == 512);
    CHECK(at("-2^2") == -4);
    CHECK(at("-t^2", 3) == -9);
    CHECK(at("(-t)^2", 3) == 9);
    CHECK(at("2^-3") == 0.125);
    CHECK(at("2^-2^2*32") == 2);
    CHECK(at("2*-t", 3) == -6);
    CHECK(at("t - -t", 3) == 6);
    CHECK(at("--t", 3) == 3);
    CHECK(at("+t", 3) == 3);
    CHECK(at("2*t^2/3", 3) == 6);
    CHECK(at(" \t( 1 + t )\t* 2 ", 3) == 8);
}

TEST_CASE("all forms of numbers are read", "[io][expression]")
{
    CHECK(at("1") == 1);
    CHECK(at(".5") == 0.5);
    CHECK(at("1.") == 1);
    CHECK(at("2e-3") == 2e-3);
    CHECK(at("2.E+3") == 2000);
    CHECK(at("0.1") == 0.1);
    CHECK(at("1.7976931348623157e308") == std::numeric_limits<double>::max());
    CHECK(at("pi") == M_PI);
    CHECK(at("e") == M_E);
    CHECK(at("2*e") == 2 * M_E);
}

TEST_CASE("functions have the values of the C library", "[io][expression]")
{
    // The compiler may evaluate std::f(t), which can differ from the library in the last digit.
    const double t = 0.4;
    CHECK(at("sin(t)", t) == Approx(std::sin(t)).epsilon(1e-15));
    CHECK(at("cos(t)", t) == Approx(std::cos(t)).epsilon(1e-15));
    CHECK(at("tan(t)", t) == Approx(std::tan(t)).epsilon(1e-15));
    CHECK(at("asin(t)", t) == Approx(std::asin(t)).epsilon(1e-15));
    CHECK(at("acos(t)", t) == Approx(std::acos(t)).epsilon(1e-15));
    CHECK(at("atan(t)", t) == Approx(std::atan(t)).epsilon(1e-15));
    CHECK(at("sinh(t)", t) == Approx(std::sinh(t)).epsilon(1e-15));
    CHECK(at("cosh(t)", t) == Approx(std::cosh(t)).epsilon(1e-15));
    CHECK(at("tanh(t)", t) == Approx(std::tanh(t)).epsilon(1e-15));
    CHECK(at("exp(t)", t) == Approx(std::exp(t)).epsilon(1e-15));
    CHECK(at("log(t)", t) == Approx(std::log(t)).epsilon(1e-15));
    CHECK(at("sqrt(t)", t) == Approx(std::sqrt(t)).epsilon(1e-15));
    CHECK(at("abs(-t)", t) == t);
    CHECK(at("min(t,1)", t) == t);
    CHECK(at("max(t,1)", t) == 1);
    CHECK(at("step(t)", t) == 1);
    CHECK(at("step(t)", 0) == 1);
    CHECK(at("step(t)", -t) == 0);
    CHECK(at("if(t,2,3)", t) == 2);
    CHECK(at("if(t,2,3)", 0) == 3);
    CHECK(at("if(t,2,3)", -t) == 3);
    CHECK(at("if(t,log(t),1)", -t) == 1);  // nan of the other branch has no effect
    CHECK(std::isnan(at("if(log(t),1,2)", -t)));
}

TEST_CASE("derivatives of all functions agree with differences", "[io][expression]")
{
    const std::string functions = GENERATE(
        as<std::string>(), "sin(3*t)", "cos(t^2)", "tan(t)", "asin(t/2)", "acos(t*t/2)", "atan(4*t)",
        "sinh(2*t)", "cosh(t^2)", "tanh(3*t)", "exp(-t*t)", "log(2+t)", "sqrt(2+t)", "abs(t-3)", "abs(t+3)",
        "min(t^2,t-4)", "max(t^2,t-4)", "step(t+2)*t", "if(t-5,t,t^3)", "if(t+5,t^3,t)", "t^3", "t^-3", "t^0",
        "t^1", "t^70", "(2+t)^2.5", "(2+t)^-0.5", "1/t", "(1+t)/(2+t^2)", "-t*t", "t+t^2-5");
    for (double t : {-0.8, 0.3, 1.1}) check_derivatives(functions, t);
}

TEST_CASE("derivatives of random expressions agree with differences", "[io][expression]")
{
    const int seed = GENERATE(range(0, 100));
    std::mt19937 random(seed);
    const std::string text = random_expression(random, 3);
    for (double t : {-1.3, 0., 0.7}) check_derivatives(text, t);
}

TEST_CASE("the reference example is reproduced to thirteen digits", "[io][expression]")
{
    const Expression f("pi/4*cos(2*t)+exp(-t^2)*sin(3*t)/(1+t^2)");
    const Jet j = f.jet(0.7);
    CHECK(j.f == Approx(0.488407883023649).epsilon(1e-13));
    CHECK(j.fdot == Approx(-3.00101687386036).epsilon(1e-13));
    CHECK(j.fddot == Approx(0.255410727005937).epsilon(1e-13));
    CHECK(f.value(0.7) == j.f);
}

TEST_CASE("integer powers are exact at zero and for negative bases", "[io][expression]")
{
    const Jet square = Expression("t^2").jet(0);
    CHECK(square.f == 0);
    CHECK(square.fdot == 0);
    CHECK(square.fddot == 2);

    const Jet cube = Expression("t^3").jet(-2);
    CHECK(cube.f == -8);
    CHECK(cube.fdot == 12);
    CHECK(cube.fddot == -12);

    const Jet one = Expression("t^0").jet(0);
    CHECK(one.f == 1);
    CHECK(one.fdot == 0);
    CHECK(one.fddot == 0);

    const Jet inverse = Expression("t^-1").jet(-2);
    CHECK(inverse.f == -0.5);
    CHECK(inverse.fdot == -0.25);
    CHECK(inverse.fddot == -0.25);
}

TEST_CASE("at a kink the derivatives are those from the right", "[io][expression]")
{
    CHECK(Expression("abs(t)").jet(0).fdot == 1);
    CHECK(Expression("abs(-t)").jet(0).fdot == 1);
    CHECK(Expression("abs(sin(t))").jet(0).fdot == 1);
    CHECK(Expression("abs(-t^2)").jet(0).fddot == 2);
    CHECK(Expression("max(0,t)").jet(0).fdot == 1);
    CHECK(Expression("max(0,-t)").jet(0).fdot == 0);
    CHECK(Expression("min(0,t)").jet(0).fdot == 0);
    CHECK(Expression("min(0,-t)").jet(0).fdot == -1);
    CHECK(Expression("if(t,sin(t),0)").jet(0).fdot == 1);
    CHECK(Expression("if(-t,sin(t),0)").jet(0).fdot == 0);
    CHECK(Expression("step(t)").jet(0).f == 1);
    CHECK(Expression("step(t)").jet(0).fdot == 0);
}

TEST_CASE("constant parts are evaluated when the text is read", "[io][expression]")
{
    CHECK(Expression("2*sin(pi/6)^2-max(1,2)").is_constant());
    CHECK(Expression("if(1,2,3)").is_constant());
    CHECK_FALSE(Expression("0*t").is_constant());
    const Jet j = Expression("2*3+1").jet(5);
    CHECK(j.f == 7);
    CHECK(j.fdot == 0);
    CHECK(j.fddot == 0);
    // Constant folding keeps a long sum of numbers within the limits.
    CHECK(at("1" + times(2047, "+1")) == 2048);
}

TEST_CASE("variables have the order of their list", "[io][expression]")
{
    const Expression force("100*(l-0.5)+2*ldot*abs(ldot)+t", {"l", "ldot", "t"});
    const std::array x{0.75, -3., 0.5};
    CHECK(force.value(x) == 25 - 18 + 0.5);
    CHECK_THROWS_WITH(Expression("lbot", {"l", "ldot", "t"}), Catch::Contains("did you mean 'ldot'?"));
}

TEST_CASE("a variable with other characters in its name is written in braces", "[io][expression]")
{
    const std::vector<std::string> names = {"t", "ball-floor.F_N", ""};
    const Expression force("2*{ball-floor.F_N} \t+ {t}^2 - {}", names);
    const std::array x{2., 0.5, 7.};
    CHECK(force.value(x) == 1 + 4 - 7);
    CHECK_THROWS_WITH(Expression("1 + {ball-flor.F_N}", names),
                      Catch::Contains("unknown name") && Catch::Contains("at column 5") &&
                          Catch::Contains("did you mean 'ball-floor.F_N'?"));
    CHECK_THROWS_WITH(Expression("t*{ball", names), Catch::StartsWith("'{' is never closed in"));
}

TEST_CASE("the variables and the outermost function of an expression are known", "[io][expression]")
{
    const Expression f("cos(2*a) + 0*b", {"a", "b", "c"});
    CHECK(f.uses(0));
    CHECK(f.uses(1));
    CHECK_FALSE(f.uses(2));
    CHECK(f.outermost().empty());
    CHECK(Expression("cos(2*t)").outermost() == "cos");
    CHECK(Expression("if(t, 1, 2)").outermost() == "if");
    CHECK(Expression("3").outermost().empty());
}

TEST_CASE("named constants are evaluated when the text is read", "[io][expression]")
{
    const Expression::Constants constants = {{"n", 3}, {"l", 0.5}, {"zero", 0}};
    const Expression f("l*t^n + zero", {"t"}, constants);
    CHECK(f.value(2) == 4);
    CHECK(f.jet(2).fdot == 6);
    CHECK(Expression("2*n - 6*l", {}, constants).is_constant());
    CHECK(Expression("n + l", {"l"}, constants).value(10) == 13);  // the variable takes precedence
    CHECK(Expression("if(zero, 1/zero, n)", {}, constants).value(std::span<const double>()) == 3);
    CHECK(std::isinf(Expression("1/zero", {}, constants).value(std::span<const double>())));
    CHECK_THROWS_WITH(Expression("1/0 + n", {}, constants),
                      "this constant part is not finite in \"1/0 + n\" at column 2");
    CHECK_THROWS_WITH(Expression("2*zeor", {}, constants),
                      "unknown name 'zeor' in \"2*zeor\" at column 3; did you mean 'zero'?");
}

TEST_CASE("the names in a text are those of variables and constants", "[io][expression]")
{
    std::string found;
    for (const Expression::Name& name :
         Expression::names("2e-3*a.b + sin (x_1)/.5 - {not this} + y2(3) + e1"))
        found += name.text + '@' + std::to_string(name.begin) + ' ';
    CHECK(found == "a.b@5 x_1@16 e1@47 ");
    CHECK(Expression::names("").empty());
    CHECK(Expression::is_name("_l2"));
    for (const char* text : {"", "2l", "a.b", "a b", "ä"}) CHECK_FALSE(Expression::is_name(text));
}

TEST_CASE("values at the limits are allowed", "[io][expression]")
{
    CHECK(at(times(63, "(") + "t" + times(63, ")"), 2) == 2);
    CHECK(at(times(63, "-") + "t", 2) == -2);
    CHECK(at("t" + times(511, "+t"), 1) == 512);
    CHECK(at(std::string(4095, ' ') + "t", 2) == 2);
}

TEST_CASE("invalid expressions are rejected with the column and one line", "[io][expression]")
{
    for (const InvalidExpression& bad : invalid_expressions()) {
        INFO(bad.text);
        try {
            Expression expression(bad.text);
            FAIL("accepted");
        } catch (const ExpressionError& error) {
            const std::string message = error.what();
            CHECK(error.column == bad.column);
            CHECK_THAT(message, Catch::Contains(bad.message));
            CHECK_THAT(message, Catch::Contains("at column " + std::to_string(bad.column)));
            CHECK(message.find('\n') == std::string::npos);
            CHECK(message.size() < 300);
        }
    }
}
