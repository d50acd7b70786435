// SPDX-License-Identifier: GPL-3.0-or-later
/// Parameters of a model file, and expressions in place of numbers.
#include <catch2/catch.hpp>

#include "dae/model_file.hpp"
#include "lie/euler_parameters.hpp"

#include <numbers>

using namespace hilda;

namespace {

using std::numbers::pi;

/// A pendulum whose numbers are expressions, in three lines; `parameters` follows the name
std::string pendulum_with(const std::string& parameters, const std::string& mass = R"("m")",
                          const std::string& forces = "")
{
    return R"({"hilda_model": 1, "name": "p", "end": "10*T",
 )" + parameters +
           R"(
  "bodies": [{"name": "bar", "mass": )" +
           mass + R"(, "inertia": ["m*l^2/12", "m*l^2/12", 1e-3], "r": [0, "l/2", 0]}],
  "constraints": [{"type": "revolute", "body_i": "ground", "body_j": "bar", "s_bar_q_j": [0, "-l/2", 0],
                   "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0]}],
  "forces": [)" +
           forces + "]}";
}

const std::string length = R"-("parameters": {"m": "3*l", "T": "2*pi*sqrt(l/g)", "l": 2, "g": 9.81},)-";

dae::Description read(const std::string& text, const std::vector<std::string>& set = {})
{
    return dae::read_model(text, "p.json", set);
}

/// Message of reading the pendulum with these parameters
std::string refusal_of_model(const std::string& text, const std::vector<std::string>& set = {})
{
    try {
        read(text, set);
        return "";
    } catch (const lie::InvalidInput& e) {
        return e.what();
    }
}

}  // namespace

TEST_CASE("parameters are evaluated in any order, and every number of a model can be an expression",
          "[dae][parameters]")
{
    const dae::Description d = read(pendulum_with(length));
    const dae::Body& bar = d.model->all_bodies()[0];
    CHECK(bar.m == 6);
    CHECK(bar.J_bar(0, 0) == 6 * 4. / 12);
    CHECK(d.x.body[0].r == lie::Vec3(0, 1, 0));
    CHECK(d.end == Approx(10 * 2 * pi * std::sqrt(2 / 9.81)).epsilon(1e-15));
    CHECK(d.warnings.empty());
    using Pair = std::pair<std::string, double>;
    REQUIRE(d.parameters.size() == 4);
    CHECK(d.parameters[0] == Pair("m", 6));
    CHECK(d.parameters[2] == Pair("l", 2));
}

TEST_CASE("an expression needs no parameters", "[dae][parameters]")
{
    const dae::Description d =
        read(R"-({"hilda_model": 1, "name": "p", "gravity": ["1/3", "-sqrt(2)", "2e-3"],
        "bodies": [{"name": "a", "mass": "exp(0)", "inertia": [[1, "1/8", 0], ["1/8", 1, 0], [0, 0, "2-1"]],
                    "r": [0, 0, 0], "axis_angle": [0, 0, 1, "pi/4"]}]})-");
    CHECK(d.model->gravity == lie::Vec3(1. / 3, -std::sqrt(2.), 2e-3));
    CHECK(d.model->all_bodies()[0].J_bar(0, 1) == 0.125);
    CHECK((d.x.body[0].A - lie::exp(lie::Vec3(0, 0, pi / 4))).norm() < 1e-15);
}

TEST_CASE("the canonical form has the values of the parameters and is read as the same model",
          "[dae][parameters]")
{
    const std::string forces = R"({"type": "torque", "body": "bar", "frame": "body",
        "components": [0, 0, "-m*l*sin(2*t/l) + 2e-3"]})";
    const dae::Description d = read(pendulum_with(length, R"("m")", forces));
    CHECK_THAT(d.text, !Catch::Contains("parameters") && !Catch::Contains("l/2"));
    CHECK_THAT(d.text, Catch::Contains("-(6)*(2)*sin(2*t/(2)) + 2e-3"));
    const dae::Description again = dae::read_model(d.text, "again.json");
    CHECK(again.text == d.text);
    CHECK(again.x.body[0].r == d.x.body[0].r);
    CHECK(again.end == d.end);
}

TEST_CASE("the option --set changes a parameter, and a number to an expression", "[dae][parameters]")
{
    const dae::Description d = read(pendulum_with(length), {"/parameters/l=3", "/bodies/0/mass=\"2*m\""});
    CHECK(d.model->all_bodies()[0].m == 18);
    CHECK(d.x.body[0].r.y() == 1.5);
    CHECK(read(pendulum_with(length), {"/bodies/0/mass=2*m"}).model->all_bodies()[0].m == 12);
    CHECK(read(pendulum_with(length), {"/parameters/l=\"g/9.81\""}).model->all_bodies()[0].m == 3);
    CHECK(refusal_of_model(pendulum_with(length), {"/parameters/ll=3"}) ==
          "p.json:2:16 (/parameters/ll): the model does not use a parameter \"ll\"; did you mean 'l'? (from "
          "--set "
          "\"/parameters/ll=3\")");
    CHECK_THAT(refusal_of_model(pendulum_with(length), {"/parameters/l=0"}),
               Catch::Contains("(/end): end must be positive, got 0"));
}

TEST_CASE("drivers and force laws contain parameters besides their variables", "[dae][parameters]")
{
    const std::string spring = R"({"name": "s", "type": "spring-damper", "body_i": "ground", "body_j": "bar",
        "s_bar_p_i": [0, 0, 3], "stiffness": "g", "free_length": "l", "force": "-g*l + m*ldot"})";
    const dae::Description d = read(pendulum_with(length, R"("m")", spring));
    // l is the length of the spring in its force, and the parameter elsewhere
    CHECK_THAT(d.text, Catch::Contains("\"-(9.81)*l + (6)*ldot\"") && Catch::Contains("\"free_length\": 2"));
    REQUIRE(d.warnings.size() == 1);
    CHECK_THAT(d.warnings[0],
               Catch::StartsWith("p.json:2:") &&
                   Catch::Contains("(/parameters/l): the parameter l has the name of a variable"));
}

TEST_CASE("a parameter of negative value keeps its sign in powers and products", "[dae][parameters]")
{
    const std::string torque =
        R"({"type": "torque", "body": "bar", "frame": "body", "components": [0, 0, "a^2 - a*t"]})";
    const dae::Description d =
        read(pendulum_with(R"("parameters": {"m": 1, "T": 1, "l": 1, "a": -3},)", R"("m")", torque));
    CHECK_THAT(d.text, Catch::Contains("(-3)^2 - (-3)*t"));
}

TEST_CASE("a parameter that nothing uses gives a warning", "[dae][parameters]")
{
    const dae::Description d = read(pendulum_with(
        R"("parameters": {"note": "lengths", "m": "2*a", "T": 1, "l": 1, "a": 1, "b": "3*a"},)"));
    REQUIRE(d.warnings.size() == 1);
    CHECK(d.warnings[0] == "p.json:2:77 (/parameters/b): nothing uses the parameter b");
}

TEST_CASE("wrong parameters and expressions are refused with file, line and column", "[dae][parameters]")
{
    const auto with = [](const std::string& parameters) {
        return refusal_of_model(pendulum_with("\"parameters\": " + parameters + ","));
    };
    CHECK(with(R"({"l": "m", "m": "2*T", "T": "l"})") ==
          "p.json:2:22 (/parameters/l): the parameters depend on each other in a cycle: l -> m -> T -> l");
    CHECK_THAT(with(R"({"l": "l"})"), Catch::EndsWith("in a cycle: l -> l"));
    CHECK(with(R"({"length": 1, "m": "2*lenght"})") ==
          "p.json:2:35 (/parameters/m): unknown name 'lenght' in \"2*lenght\" at column 3; did you mean "
          "'length'?");
    CHECK(with(R"({"l": 0, "m": "1/l"})") ==
          "p.json:2:30 (/parameters/m): \"1/l\" must be finite, got inf with l = 0");
    CHECK_THAT(with(R"({"l": "1/0"})"),
               Catch::Contains("this constant part is not finite in \"1/0\" at column 2"));
    CHECK_THAT(with(R"({"l": "2*"})"), Catch::Contains("(/parameters/l): the expression ends where a value"));
    CHECK_THAT(with(R"({"l": [1]})"),
               Catch::Contains("must be a number or an expression in a string, got [1]"));
    CHECK_THAT(with(R"([1])"), Catch::Contains("(/parameters): parameters must be an object, got [1]"));
    CHECK_THAT(with(R"({"2l": 1})"), Catch::Contains("begin with a letter or _, got \"2l\""));
    CHECK_THAT(with(R"({"": 1})"), Catch::Contains("begin with a letter or _, got \"\""));
    CHECK_THAT(with(R"({"sin": 1})"), Catch::Contains("must not be that of a function, got \"sin\""));
    CHECK_THAT(with(R"({"t": 1})"), Catch::Contains("must not be t, the time"));
    CHECK_THAT(with(R"({"pi": 3})"), Catch::Contains("must not be pi, a constant"));
    std::string many = "{\"a\": 1";
    for (int k = 0; k < 1000; ++k) many += ", \"a" + std::to_string(k) + "\": 1";
    CHECK_THAT(with(many + "}"), Catch::Contains("at most 1000 parameters are allowed, got 1001"));

    const auto mass = [](const std::string& m) { return refusal_of_model(pendulum_with(length, m)); };
    CHECK(mass(R"("3*mm")") ==
          "p.json:3:38 (/bodies/0/mass): mass must be a number or an expression: unknown name 'mm' in "
          "\"3*mm\" at "
          "column 3; did you mean 'm'?");
    CHECK_THAT(mass("\"1/(l-2)\""), Catch::Contains("\"1/(l-2)\" must be finite, got inf with l = 2"));
    CHECK_THAT(mass(R"("l*t")"), Catch::Contains("unknown name 't'"));
    CHECK_THAT(mass(R"("-m")"), Catch::Contains("mass must be positive, got -6"));
    CHECK_THAT(mass(R"("")"), Catch::Contains("empty expression"));
    CHECK_THAT(mass(R"("2 l")"), Catch::Contains("missing operator before 'l'"));
    CHECK_THAT(mass(R"("1e999")"), Catch::Contains("the number '1e999' is out of range"));
}

TEST_CASE("an exponent can be a parameter", "[dae][parameters]")
{
    const std::string n = R"("parameters": {"m": "2^n", "T": 1, "l": "(n - 1)^-n", "n": 3},)";
    const std::string torque =
        R"({"type": "torque", "body": "bar", "frame": "body", "components": [0, 0, "t^n"]})";
    const dae::Description d = read(pendulum_with(n, "\"m^(1/n)\"", torque));
    CHECK(d.model->all_bodies()[0].m == Approx(2));
    CHECK(d.x.body[0].r.y() == 0.5 / 8);
    CHECK_THAT(d.text, Catch::Contains("t^(3)"));
    CHECK(d.warnings.empty());
    CHECK_THAT(refusal_of_model(pendulum_with(n, R"("m^t")")), Catch::Contains("unknown name 't'"));
    CHECK_THAT(refusal_of_model(pendulum_with(n, "\"(n-3)^(-n)\"")),
               Catch::Contains("\"(n-3)^(-n)\" must be finite, got inf with n = 3"));
    CHECK_THAT(refusal_of_model(pendulum_with(n, "\"2^(t*n)\"")),
               Catch::Contains("unknown name 't' in \"2^(t*n)\""));
}

TEST_CASE("a parameter can guard a division by itself", "[dae][parameters]")
{
    const std::string z = R"-("parameters": {"m": "if(z, 1/z, 4)", "T": 1, "l": 1, "z": 0},)-";
    CHECK(read(pendulum_with(z)).model->all_bodies()[0].m == 4);
}

TEST_CASE("a chain of 1000 parameters, each from the next, is evaluated", "[dae][parameters]")
{
    std::string chain = R"("parameters": {"m": 1, "T": 1, "l": "a0")";
    for (int k = 0; k < 996; ++k)
        chain += ", \"a" + std::to_string(k) + "\": \"a" + std::to_string(k + 1) + " + 1\"";
    CHECK(read(pendulum_with(chain + ", \"a996\": 4},")).x.body[0].r.y() == 500);
}

TEST_CASE("a model may name its schema for editors", "[dae][parameters]")
{
    const std::string text =
        pendulum_with("\"$schema\": \"https://example.org/model.schema.json\"," + length);
    const dae::Description d = read(text);
    CHECK(d.text == read(pendulum_with(length)).text);
    CHECK_THAT(refusal_of_model(text, {"/$schema=3"}),
               Catch::Contains("(/$schema): $schema must be a string, got 3"));
}
