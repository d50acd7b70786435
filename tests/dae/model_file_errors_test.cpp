// SPDX-License-Identifier: GPL-3.0-or-later
/// Invalid model files. Each is rejected with file, line, column, JSON pointer, the error, and the value.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <random>
#include <regex>

#include "dae/model_file.hpp"
#include "dae/object_reader.hpp"

using namespace hilda;

namespace {

const std::string valid_model = R"json({
  "hilda_model": 1,
  "name": "bench",
  "gravity": [0, 0, -9.81],
  "end": 2,
  "bodies": [
    {"name": "bar", "id": 1, "mass": 3, "inertia": [0.01, 1, 1], "r": [1, 0, 0], "A": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]},
    {"name": "bob", "id": 2, "mass": 0.5, "inertia": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "r": [2, 0, -1], "p": [1, 0, 0, 0]},
    {"name": "gear", "mass": 4, "inertia": [2, 2, 3], "r": [0, 3, 0], "axis_angle": [0, 0, 1, 0.5], "omega": [0, 0, 0]}
  ],
  "constraints": [
    {"name": "pin", "type": "revolute", "body_i": "ground", "body_j": "bar", "s_bar_q_j": [-1, 0, 0], "axis_bar_i": [0, 1, 0], "axis_bar_j": [0, 1, 0]},
    {"name": "rod", "type": "D", "body_i": "bar", "body_j": "bob", "s_bar_p_i": [1, 0, 0], "f": "1 + t^2"},
    {"name": "plane", "type": "CD", "body_i": "ground", "body_j": 2, "c": [0, 1, 0]},
    {"name": "angle", "type": "DP1", "body_i": "ground", "body_j": "bob", "a_bar_i": [1, 0, 0], "a_bar_j": [0, 0, 1], "f": "sin(t^2)"},
    {"name": "bearing", "type": "revolute", "body_i": "ground", "body_j": "gear", "s_bar_p_i": [0, 3, 0], "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 2]},
    {"name": "turn", "type": "hinge-driver", "body_i": "ground", "body_j": "gear", "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 1], "angle": "0.5*t^2"}
  ],
  "forces": [
    {"name": "spring", "type": "spring-damper", "body_i": "bar", "body_j": "gear", "stiffness": 10, "free_length": 1, "force": "ldot*l"},
    {"name": "twist", "type": "torsion-spring", "body_i": "ground", "body_j": "gear", "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 1], "stiffness": 1, "free_angle": 0},
    {"name": "wind", "type": "force", "body": "bob", "point_bar": [0, 0, 1], "frame": "global", "components": ["cos(t)", 0, 1]},
    {"name": "motor", "type": "torque", "body": 1, "frame": "body", "components": [0, 0, "t"]}
  ]
}
)json";

/// A modification of the valid model and the expected message. An empty `find` replaces the whole text.
struct InvalidModel {
    std::string find, replace, pointer, piece;
};

std::string edited(const InvalidModel& bad)
{
    if (bad.find.empty()) return bad.replace;
    std::string text = valid_model;
    const std::size_t at = text.find(bad.find);
    INFO(bad.find);
    REQUIRE(at != std::string::npos);
    return text.replace(at, bad.find.size(), bad.replace);
}

/// Message of reading and starting a model, or an empty string
std::string error_message(const std::string& text, const std::vector<std::string>& set = {})
{
    try {
        dae::Description d = dae::read_model(text, "bad.json", set);
        dae::start(d);
        return "";
    } catch (const lie::InvalidInput& e) {
        return e.what();
    }
}

void check_message(const InvalidModel& bad, const std::string& message)
{
    INFO(bad.find << " -> " << bad.replace.substr(0, 200));
    INFO(message);
    // '.' does not match a line break
    static const std::regex form(R"(bad\.json:[1-9]\d*:[1-9]\d* \((/[^ ]*)\): .+)");
    std::smatch match;
    CHECK(std::regex_match(message, match, form));
    CHECK((match.empty() ? "" : match[1].str()) == bad.pointer);
    CHECK(message.find(bad.piece) != std::string::npos);
    CHECK(message.find("json.exception") == std::string::npos);
}

std::string repeated(const std::string& s, int n)
{
    std::string all;
    for (int k = 0; k < n; ++k) all += s;
    return all;
}

// One line per case, of any length
// clang-format off
const std::vector<InvalidModel> syntax = {
    {"", "", "/", "the text is empty"},
    {"", " \n\t ", "/", "the text is empty"},
    {"", "{", "/", "unexpected end of the text"},
    {"", "[1, 2", "/2", "unexpected end of the text; expected ']'"},
    {"", "nonsense", "/", "got 'nonsense'"},
    {"", "[]", "/", "must be an object, got []"},
    {"", "3", "/", "must be an object, got 3"},
    {"", "{} {}", "/", "not JSON: unexpected '{'"},
    {"\"end\": 2,", "\"end\": 2", "/end", "not JSON: unexpected string literal, got \"bodies\"; expected '}'"},
    {"\"end\": 2,", "\"end\" 2,", "/end", "expected ':'"},
    {"\"end\": 2,", "\"end\": ,", "/end", "not JSON: unexpected ','"},
    {"\"end\": 2,", "\"end\": 2,,", "/end", "not JSON: unexpected ','"},
    {"\"end\": 2,", "end: 2,", "/gravity", "got 'end'"},
    {"\"end\": 2,", "\"end\": 2, // seconds\n", "/end", "JSON has no comments"},
    {"\"end\": 2,", "\"end\": 'two',", "/end", "double quotes"},
    {"\"end\": 2,", "\"end\": 02,", "/end", "not JSON: unexpected number literal"},
    {"\"end\": 2,", "\"end\": 2.,", "/end", "expected digit after '.'"},
    {"\"end\": 2,", "\"end\": .5,", "/end", "got '.5'"},
    {"\"end\": 2,", "\"end\": +2,", "/end", "got '+2'"},
    {"\"end\": 2,", "\"end\": NaN,", "/end", "numbers must be finite"},
    {"\"end\": 2,", "\"end\": nan,", "/end", "numbers must be finite"},
    {"\"end\": 2,", "\"end\": Infinity,", "/end", "numbers must be finite"},
    {"\"end\": 2,", "\"end\": -inf,", "/end", "numbers must be finite"},
    {"\"end\": 2,", "\"end\": 1e999,", "/end", "the number is outside the range of double precision, got '1e999'"},
    {"\"end\": 2,", "\"end\": -1e400,", "/end", "outside the range"},
    {"\"end\": 2,", "\"end\": 99999999999999999999,", "/end", "the integer is too large to be exact, got '99999999999999999999'"},
    {"\"end\": 2,", "\"end\": 9007199254740993,", "/end", "the integer is too large to be exact"},
    {"\"end\": 2,", "\"end\": -18446744073709551617,", "/end", "the integer is too large to be exact"},
    {"-9.81]", "-9.81,]", "/gravity/3", "a comma without a following value, before ']'"},
    {"\"free_angle\": 0}", "\"free_angle\": 0, }", "/forces/1/free_angle", "a comma without a following value, before '}'"},
    {"\"bench\"", "\"bench", "/name", "a string must be closed on its line, got \"bench,\""},
    {"", "{\"name\": \"bench", "/name", "missing closing quote"},
    {"\"bench\"", "\"be\\qnch\"", "/name", "forbidden character after backslash"},
    {"\"bench\"", "\"be\\u12\"", "/name", "4 hex digits"},
    {"\"bench\"", "\"be\\ud800\"", "/name", "surrogate"},
    {"\"bench\"", "\"be\tnch\"", "/name", "control character"},
    {"\"bench\"", "\"be\xff\"", "/name", "ill-formed UTF-8"},
    {"\"bench\"", "\"be\xc0\x80\"", "/name", "ill-formed UTF-8"},
    {"\"end\": 2,", "\"end\": 2, \"end\": 3,", "/end", "the key \"end\" is given twice; first at bad.json:5:3"},
    {"\"mass\": 0.5,", "\"mass\": 0.5, \"r\": [0, 0, 0],", "/bodies/1/r", "twice"},
    {"\"type\": \"CD\"", "\"type\": \"CD\", \"type\": \"CD\"", "/constraints/2/type", "twice"},
    {"\"end\": 2,", "\"note\": " + repeated("[", 64) + repeated("]", 64) + ",", "/note" + repeated("/0", 63), "nested deeper than 64"},
    {"", repeated("[", 2000000), repeated("/0", 64), "nested deeper than 64"},
    {"\"bench\"", "\"" + std::string(4097, 'b') + "\"", "/name", "a string of 4097 bytes"},
};

const std::vector<InvalidModel> keys_and_types = {
    {"\"hilda_model\": 1", "\"hilda_model\": 2", "/hilda_model", "must be 1, got 2"},
    {"\"hilda_model\": 1", "\"hilda_model\": \"1\"", "/hilda_model", "must be a number, got \"1\""},
    {"\"name\": \"bench\",", "", "/", "missing key 'name'"},
    {"\"name\": \"bench\"", "\"name\": 7", "/name", "name must be a string, got 7"},
    {"\"name\": \"bench\"", "\"name\": \"\"", "/name", "must be a name"},
    {"\"name\": \"bench\"", "\"name\": \"a\\nb\"", "/name", "must be a name without control characters, got \"a\\nb\""},
    {"\"gravity\"", "\"gravty\"", "/gravty", "unknown key \"gravty\"; did you mean 'gravity'?"},
    {"\"end\": 2,", "\"colour\": 2,", "/colour", "unknown key \"colour\"; allowed: $schema, hilda_model, "
     "name, parameters, gravity, end, redundant, bodies, constraints, forces, contacts, outputs, events, note"},
    {"[0, 0, -9.81]", "-9.81", "/gravity", "gravity must be a list of 3 numbers, got -9.81"},
    {"[0, 0, -9.81]", "[0, -9.81]", "/gravity", "got [0, -9.81]"},
    {"[0, 0, -9.81]", "[0, 0, null]", "/gravity/2", "gravity must be a number, got null"},
    {"\"end\": 2,", "\"end\": 0,", "/end", "end must be positive, got 0"},
    {"\"end\": 2,", "\"end\": -1,", "/end", "end must be positive, got -1"},
    {"\"end\": 2,", "\"end\": true,", "/end", "must be a number, got true"},
    {"\"end\": 2,", "\"note\": 5,", "/note", "note must be a string, got 5"},
    {"\"end\": 2,", "\"contacts\": [{}],", "/contacts", "this program is built without contacts; the list must be empty, got 1"},
    {"\"end\": 2,", "\"contacts\": {},", "/contacts", "must be a list"},
    {"", R"({"hilda_model": 1, "name": "x", "bodies": []})", "/bodies", "at least one body with mass"},
    {"", R"({"hilda_model": 1, "name": "x", "bodies": {}})", "/bodies", "must be a list, got an object of 0 keys"},
    {"", R"({"hilda_model": 1, "name": "x"})", "/", "missing key 'bodies'"},
    {"", R"({"hilda_model": 1, "name": "x", "bodies": [{"name": "base", "id": 0}]})", "/bodies", "at least one body with mass"},
    {"", R"({"hilda_model": 1, "name": "x", "bodies": [5]})", "/bodies/0", "must be an object, got 5"},
};

const std::vector<InvalidModel> bodies = {
    {"\"name\": \"bar\", ", "", "/bodies/0", "missing key 'name'"},
    {"\"name\": \"bob\"", "\"name\": \"bar\"", "/bodies/1/name", "two bodies have the same name, got \"bar\""},
    {"\"name\": \"bob\"", "\"name\": \"ground\"", "/bodies/1/name", "the name 'ground' is reserved for the fixed body"},
    {"\"id\": 2", "\"id\": 1", "/bodies/1/id", "two bodies have the same id, got 1"},
    {"\"id\": 2", "\"id\": 2.5", "/bodies/1/id", "must be an integer"},
    {"\"id\": 2", "\"id\": \"two\"", "/bodies/1/id", "must be a number, got \"two\""},
    {"\"mass\": 3", "\"masss\": 3", "/bodies/0/masss", "unknown key \"masss\"; did you mean 'mass'?"},
    {"\"mass\": 3, ", "", "/bodies/0", "missing key 'mass'"},
    {"\"mass\": 3", "\"mass\": 0", "/bodies/0/mass", "mass must be positive, got 0"},
    {"\"mass\": 3", "\"mass\": -2", "/bodies/0/mass", "mass must be positive, got -2"},
    {"\"mass\": 3", "\"mass\": [3]", "/bodies/0/mass", "mass must be a number, got [3]"},
    {"\"inertia\": [2, 2, 3], ", "", "/bodies/2", "missing key 'inertia'"},
    {"[2, 2, 3]", "[2, 2]", "/bodies/2/inertia", "got [2, 2]"},
    {"[2, 2, 3]", "[2, 2, 0]", "/bodies/2/inertia", "positive definite"},
    {"[2, 2, 3]", "[2, -2, 3]", "/bodies/2/inertia", "positive definite"},
    {"[2, 2, 3]", "[1, 1, 2.1]", "/bodies/2/inertia", "no principal moment of inertia may exceed"},
    {"[2, 2, 3]", "[2, 2, \"three\"]", "/bodies/2/inertia/2", "must be a number or an expression: unknown name 'three'"},
    {"[[1, 0, 0], [0, 1, 0], [0, 0, 1]], \"r\"", "[[1, 0.1, 0], [0, 1, 0], [0, 0, 1]], \"r\"", "/bodies/1/inertia", "must be symmetric"},
    {"[[1, 0, 0], [0, 1, 0], [0, 0, 1]], \"r\"", "[[1, 0, 0], [0, 1], [0, 0, 1]], \"r\"", "/bodies/1/inertia", "three rows of three numbers"},
    {"[[1, 0, 0], [0, 1, 0], [0, 0, 1]], \"r\"", "[[1, 0, 0], [0, 1, 0], [0, 0, {}]], \"r\"", "/bodies/1/inertia/2/2", "must be a number"},
    {"\"r\": [2, 0, -1], ", "", "/bodies/1", "missing key 'r'"},
    {"\"r\": [2, 0, -1]", "\"r\": [2, 0, \"-1 0\"]", "/bodies/1/r/2", "r must be a number or an expression: missing operator before '0' in \"-1 0\" at column 4"},
    {"\"A\": [[1,", "\"A\": [[1.1,", "/bodies/0/A", "must be a rotation matrix"},
    {"\"A\": [[1,", "\"A\": [[-1,", "/bodies/0/A", "reflection"},
    {"\"A\": [[1, 0, 0],", "\"A\": [", "/bodies/0/A", "three rows"},
    {"\"A\": [[1,", "\"A\": [[1.00001,", "/bodies/0/A", "deviations up to 1e-06 are corrected"},
    {"\"p\": [1, 0, 0, 0]", "\"p\": [1, 0, 0, 0.1]", "/bodies/1/p", "p must have length 1, got 1.00498"},
    {"\"p\": [1, 0, 0, 0]", "\"p\": [0, 0, 0, 0]", "/bodies/1/p", "p must have length 1, got 0"},
    {"\"p\": [1, 0, 0, 0]", "\"p\": [1, 0, 0]", "/bodies/1/p", "list of 4 numbers"},
    {"\"p\": [1, 0, 0, 0]", "\"p\": [1, 0, 0, 0], \"A\": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]", "/bodies/1", "one of A, p, axis_angle and euler_angles; got 2"},
    {"[0, 0, 1, 0.5]", "[0, 0, 0, 0.5]", "/bodies/2/axis_angle", "must have length 1, got 0"},
    {"[0, 0, 1, 0.5]", "[1, 0, 1, 0.5]", "/bodies/2/axis_angle", "must have length 1, got 1.414"},
    {"\"omega\": [0, 0, 0]", "\"omega\": 0", "/bodies/2/omega", "list of 3 numbers, got 0"},
    {"\"omega\": [0, 0, 0]", "\"omegga\": [0, 0, 0]", "/bodies/2/omegga", "did you mean 'omega'?"},
};

const std::vector<InvalidModel> constraints = {
    {"\"name\": \"rod\"", "\"name\": \"pin\"", "/constraints/1/name", "already used, got \"pin\""},
    {"\"type\": \"revolute\", ", "", "/constraints/0", "missing key 'type'"},
    {"\"type\": \"DP1\"", "\"type\": \"DP3\"", "/constraints/3/type", "unknown type \"DP3\"; did you mean 'DP1'?"},
    {"\"type\": \"DP1\"", "\"type\": \"slot\"", "/constraints/3/type", "allowed: CD, D, DP1, DP2, cylindrical, distance"},
    {"\"type\": \"DP1\"", "\"type\": 1", "/constraints/3/type", "type must be a string, got 1"},
    {"\"body_j\": \"bar\", ", "", "/constraints/0", "missing key 'body_j'"},
    {"\"body_j\": \"bar\"", "\"body_j\": \"baar\"", "/constraints/0/body_j", "no body has this name, got \"baar\"; did you mean 'bar'?"},
    {"\"body_j\": \"bar\"", "\"body_j\": \"\"", "/constraints/0/body_j", "no body has this name, got \"\""},
    {"\"body_j\": 2", "\"body_j\": 3", "/constraints/2/body_j", "no body has this id, got 3"},
    {"\"body_j\": 2", "\"body_j\": 1.5", "/constraints/2/body_j", "must be an integer"},
    {"\"body_j\": 2", "\"body_j\": null", "/constraints/2/body_j", "must be the name or the id of a body, got null"},
    {"\"body_j\": 2", "\"body_j\": \"ground\"", "/constraints/2/body_j", "two different bodies, got 'ground' twice"},
    {"\"a_bar_i\": [1, 0, 0], ", "", "/constraints/3", "missing key 'a_bar_i'"},
    {"\"a_bar_i\": [1, 0, 0]", "\"a_bar_i\": [0, 0, 0]", "/constraints/3/a_bar_i", "must have a direction, got [0, 0, 0]"},
    {"\"a_bar_i\": [1, 0, 0]", "\"a_bar_i\": [1e200, 0, 0]", "/constraints/3/a_bar_i", "must have a direction"},
    {"\"a_bar_j\": [0, 0, 1]", "\"a_bar_j\": [0, 0, 0]", "/constraints/3/a_bar_j", "must have a direction"},
    {"\"c\": [0, 1, 0]", "\"c\": [0, 0, 0]", "/constraints/2/c", "must have a direction"},
    {"\"c\": [0, 1, 0]", "\"c\": [0, 1, 0], \"s_bar_i\": [0, 0, 0]", "/constraints/2/s_bar_i", "unknown key \"s_bar_i\"; did you mean 's_bar_p_i'?"},
    {"\"axis_bar_i\": [0, 1, 0]", "\"axis_bar_i\": [0, 0, 0]", "/constraints/0/axis_bar_i", "must have a direction"},
    {", \"axis_bar_j\": [0, 1, 0]", "", "/constraints/0", "missing key 'axis_bar_j'"},
    {"\"axis_bar_j\": [0, 1, 0]", "\"axis_bar_j\": [0, 1, 0], \"f\": 0", "/constraints/0/f", "unknown key \"f\""},
    {"\"axis_bar_j\": [0, 1, 0]", "\"axis_bar_j\": [0, 1, 0], \"f_dot\": 0", "/constraints/0/f_dot", "unknown key \"f_dot\""},
    {", \"f\": \"1 + t^2\"", "", "/constraints/1", "missing key 'f'"},
    {", \"angle\": \"0.5*t^2\"", "", "/constraints/5", "missing key 'angle'"},
    {"\"type\": \"D\", ", "\"type\": \"distance\", \"length\": 0, ", "/constraints/1/length", "length must be positive, got 0"},
    {"\"type\": \"D\", ", "\"type\": \"distance\", ", "/constraints/1", "missing key 'length'"},
    {"\"axis_bar_j\": [0, 0, 1], \"angle\"", "\"axis_bar_j\": [1, 0, 0], \"angle\"", "/constraints/5", "the two axes must be parallel at the start and point in the same direction; cosine of their angle, got"},
    {"\"axis_bar_j\": [0, 0, 1], \"angle\"", "\"axis_bar_j\": [0, 0, -1], \"angle\"", "/constraints/5", "the same direction; cosine of their angle, got -1"},
};

const std::vector<InvalidModel> expressions = {
    {"sin(t^2)", "sine(2*t)", "/constraints/3/f", "unknown function 'sine' in \"sine(2*t)\" at column 1; did you mean 'sin'?"},
    {"sin(t^2)", "2*sin(t", "/constraints/3/f", "'(' is never closed in \"2*sin(t\" at column 6"},
    {"sin(t^2)", "0*x", "/constraints/3/f", "unknown name 'x' in \"0*x\" at column 3"},
    {"sin(t^2)", "2 t", "/constraints/3/f", "missing operator before 't' in \"2 t\" at column 3"},
    {"sin(t^2)", "", "/constraints/3/f", "empty expression in \"\" at column 1"},
    {"sin(t^2)", "t^t", "/constraints/3/f", "the exponent must be constant"},
    {"sin(t^2)", "1/0", "/constraints/3/f", "not finite"},
    {"sin(t^2)", "sin(t,t)", "/constraints/3/f", "wrong number of arguments"},
    {"sin(t^2)", "system(t)", "/constraints/3/f", "unknown function 'system'"},
    {"\"sin(t^2)\"", "[0]", "/constraints/3/f", "f must be a number or an expression in a string, got [0]"},
    {"sin(t^2)", "sqrt(t)", "/constraints/3/f", "f and its derivatives must be finite at t = 0, got \"sqrt(t)\" with the value 0 and the derivatives inf"},
    {"sin(t^2)", "log(t)", "/constraints/3/f", "f and its derivatives must be finite at t = 0, got \"log(t)\" with the value -inf"},
    {"sin(t^2)", "0*sin(t)/t", "/constraints/3/f", "f and its derivatives must be finite at t = 0"},
    {"sin(t^2)", "t^1.5", "/constraints/3/f", "f and its derivatives must be finite at t = 0"},
    {"0.5*t^2", "asin(1 - t)", "/constraints/5/angle", "angle and its derivatives must be finite at t = 0"},
    {"0.5*t^2", "l", "/constraints/5/angle", "unknown name 'l'"},
    {"ldot*l", "ldot*length", "/forces/0/force", "unknown name 'length' in \"ldot*length\" at column 6; known: l, ldot, t"},
    {"\"cos(t)\"", "\"cos(x)\"", "/forces/2/components/0", "unknown name 'x' in \"cos(x)\" at column 5"},
    {"\"cos(t)\"", "\"1/t\"", "/forces/2/components/0", "finite at t = 0, got \"1/t\" with inf"},
    {"\"cos(t)\"", "null", "/forces/2/components/0", "a number or an expression in a string, got null"},
};

const std::vector<InvalidModel> forces = {
    {"\"name\": \"twist\"", "\"name\": \"spring\"", "/forces/1/name", "already used"},
    {"\"torsion-spring\"", "\"torsion_spring\"", "/forces/1/type", "did you mean 'torsion-spring'?"},
    {"\"stiffness\": 10, ", "", "/forces/0", "missing key 'stiffness'"},
    {"\"stiffness\": 10", "\"stiffness\": -10", "/forces/0/stiffness", "stiffness must not be negative, got -10"},
    {"\"stiffness\": 10", "\"stiffness\": \"stiff\"", "/forces/0/stiffness", "must be a number or an expression: unknown name 'stiff'"},
    {"\"stiffness\": 10", "\"stiffness\": 10, \"damping\": -1", "/forces/0/damping", "must not be negative, got -1"},
    {"\"free_length\": 1", "\"free_length\": -1", "/forces/0/free_length", "must not be negative, got -1"},
    {"\"free_length\": 1", "\"free_length\": 1, \"implicit\": 1", "/forces/0/implicit", "implicit must be true or false, got 1"},
    {"\"frame\": \"body\"", "\"frame\": \"body\", \"implicit\": true", "/forces/3/implicit", "unknown key \"implicit\""},
    {"\"free_length\": 1", "\"free_lenght\": 1", "/forces/0/free_lenght", "did you mean 'free_length'?"},
    {"\"stiffness\": 1, ", "", "/forces/1", "missing key 'stiffness'"},
    {", \"free_angle\": 0", "", "/forces/1", "missing key 'free_angle'"},
    {"\"axis_bar_i\": [0, 0, 1], \"axis_bar_j\": [0, 0, 1], \"stiffness\"", "\"axis_bar_i\": [0, 1, 1], \"axis_bar_j\": [0, 0, 1], \"stiffness\"", "/forces/1", "the two axes must be parallel at the start"},
    {"\"body\": \"bob\"", "\"body\": \"ground\"", "/forces/2/body", "a force must act on a movable body, got 'ground'"},
    {"\"body\": \"bob\"", "\"body\": \"Bib\"", "/forces/2/body", "did you mean 'bob'?"},
    {"\"body\": \"bob\"", "\"body_i\": \"bob\"", "/forces/2/body_i", "unknown key \"body_i\"; did you mean 'body'?"},
    {"\"frame\": \"global\"", "\"frame\": \"globel\"", "/forces/2/frame", "unknown frame \"globel\"; did you mean 'global'?"},
    {"\"frame\": \"global\", ", "", "/forces/2", "missing key 'frame'"},
    {"[\"cos(t)\", 0, 1]", "[\"cos(t)\", 0]", "/forces/2/components", "three numbers or expressions in t, got a list of 2"},
    {"[\"cos(t)\", 0, 1]", "\"cos(t)\"", "/forces/2/components", "must be a list, got \"cos(t)\""},
    {"\"body\": 1,", "\"body\": 1, \"point_bar\": [0, 0, 0],", "/forces/3/point_bar", "unknown key \"point_bar\""},
    {"\"body\": 1,", "\"body\": 9,", "/forces/3/body", "no body has this id, got 9"},
};

/// Errors that are detected at the start only
const std::vector<InvalidModel> starts = {
    {"1 + t^2", "0", "/constraints/1", "f is a squared distance and must be positive, got 0"},
    {"1 + t^2", "-1", "/constraints/1", "must be positive, got -1"},
    {"sin(t^2)", "2", "/constraints/3", "f must be between -|a_i||a_j| and |a_i||a_j| = 1, got 2"},
    {"sin(t^2)", "-1.5 + t", "/constraints/3", "got -1.5"},
    {"\"a_bar_j\": [0, 0, 1], \"f\": \"sin(t^2)\"", "\"a_bar_j\": [1, 0, 0], \"f\": \"cos(t)\"", "/constraints/3", "the two vectors are parallel at the start"},
    {"\"r\": [1, 0, 0]", "\"r\": [1, 0, 0.25]", "/constraints/0", "the initial positions violate constraint 'pin' row 3; bodies 'ground', 'bar' by 0.25 m, more than 1e-09; use --fix-initial"},
    {"\"axis_bar_j\": [0, 1, 0]", "\"axis_bar_j\": [1, 0, 0]", "/constraints/0", "the initial positions violate constraint 'pin'"},
    {"\"axis_bar_j\": [0, 0, 2]", "\"axis_bar_j\": [0, 0.1, 2]", "/constraints/4", "the initial positions violate constraint 'bearing' row 4; bodies 'ground', 'gear' by 0.0438 rad, more"},
    {"1 + t^2", "1.1 + t^2", "/constraints/1", "the initial positions violate constraint 'rod' row 1; bodies 'bar', 'bob' by 0.0488 m, more"},
    {"sin(t^2)", "0.5", "/constraints/3", "the initial positions violate constraint 'angle' row 1; bodies 'ground', 'bob' by 0.524 rad, more"},
    {"\"r\": [2, 0, -1]", "\"r\": [2, 0, -1], \"r_dot\": [0, 1, 0]", "/constraints/2", "the initial velocities violate constraint 'plane' row 1; bodies 'ground', 'bob' by 1 m/s, more than 1e-09"},
    {"\"omega\": [0, 0, 0]", "\"omega\": [0, 0, 1]", "/constraints/5", "the initial velocities violate constraint 'turn' row 1; bodies 'ground', 'gear' by 1 rad/s, more"},
    {"\"angle\": \"0.5*t^2\"", "\"angle\": \"2*t\"", "/constraints/5", "the initial velocities violate constraint 'turn'"},
    {"\"name\": \"turn\",", "\"name\": \"again\", \"type\": \"hinge-driver\", \"body_i\": \"ground\", \"body_j\": \"gear\", \"axis_bar_i\": [0, 0, 1], \"axis_bar_j\": [0, 0, 1], \"angle\": \"t^2\"}, {\"name\": \"turn\",", "/constraints/6", "constraint 'turn' row 1; bodies 'ground', 'gear': contradicts the constraints before it in acceleration"},
    {"\"name\": \"angle\",", "\"type\": \"CD\", \"body_i\": \"ground\", \"body_j\": \"bob\", \"c\": [0, 1, 0], \"f\": \"3*t^2\"}, {\"name\": \"angle\",", "/constraints/3", "contradicts the constraints before it in acceleration"},
};

// clang-format on
const std::vector<std::pair<std::string, const std::vector<InvalidModel>*>> tables = {
    {"syntax", &syntax},           {"keys and types", &keys_and_types}, {"bodies", &bodies},
    {"constraints", &constraints}, {"expressions", &expressions},       {"forces", &forces},
    {"starts", &starts},
};

}  // namespace

TEST_CASE("the model from which the invalid ones are derived is valid", "[dae][model_file]")
{
    CHECK(error_message(valid_model) == "");
    dae::Description d = dae::read_model(valid_model, "good.json");
    CHECK(d.warnings.empty());
    const dae::StartReport report = dae::start(d);
    CHECK(report.rows == report.rank);
}

TEST_CASE("an invalid model file is rejected with its location, the error and the value", "[dae][model_file]")
{
    std::size_t count = 0;
    for (const auto& [name, table] : tables) {
        CAPTURE(name);
        for (const InvalidModel& bad : *table) {
            check_message(bad, error_message(edited(bad)));
            ++count;
        }
    }
    CHECK(count >= 150);
}

TEST_CASE("a location is the line and column of the value, counted in characters from 1", "[dae][model_file]")
{
    struct Place {
        std::string text, start;
    };
    const std::vector<Place> places = {
        {edited({"\"mass\": 3", "\"mass\": -3", "", ""}), "bad.json:7:38 (/bodies/0/mass): "},
        {edited({"\"mass\": 3", "\"mass\":\n-3", "", ""}), "bad.json:8:1 (/bodies/0/mass): "},
        {edited({"\"mass\": 3", "\"mass\"\r\n\r\n:\r\n   -3", "", ""}), "bad.json:10:4 (/bodies/0/mass): "},
        {edited({"\"gravity\": [0, 0, -9.81]", "\"gravity\": [0,0,\"\"]", "", ""}),
         "bad.json:4:19 (/gravity/2): "},
        {edited({"\"gravity\": [0, 0, -9.81]", "\"gravity\": [0 , 0\t, {}]", "", ""}),
         "bad.json:4:23 (/gravity/2): "},
        {edited({"\"end\": 2", "\"énd\": 2", "", ""}), "bad.json:5:3 (/énd): "},
        {edited({"\"name\": \"bench\"", "\"name\": \"bénch\", \"endd\": 1", "", ""}),
         "bad.json:3:20 (/endd): "},
        {"\xEF\xBB\xBF" + edited({"\"end\": 2", "\"end\": -2", "", ""}), "bad.json:5:10 (/end): "},
        {edited({"\"end\": 2,", "\"end\": 2", "", ""}), "bad.json:6:3 (/end): "},
        {edited({"\"bench\"", "\"bench", "", ""}), "bad.json:3:11 (/name): "},
        {"{\"name\": \"x\",\n \"a/b\": {\"~\": [1 2]}}", "bad.json:2:18 (/a~1b/~0/1): "},
        {"\n\n  [1,\n  NaN]", "bad.json:4:3 (/1): "},
    };
    for (const Place& place : places) {
        const std::string message = error_message(place.text);
        CHECK_THAT(message, Catch::StartsWith(place.start));
    }
}

TEST_CASE("a message quotes at most one line of the file", "[dae][model_file]")
{
    const std::string name(3000, 'x');
    const std::string message =
        error_message(edited({"\"body_j\": \"bar\"", "\"body_j\": \"" + name + "\"", "", ""}));
    CHECK(message.size() < 200);
    const std::string e_acute = "\xc3\xa9";
    const std::string other = error_message(edited({"\"end\"", "\"" + repeated(e_acute, 61) + "\"", "", ""}));
    CHECK(other.size() < 500);
    CHECK_NOTHROW(dae::JsonSource("[\"" + other.substr(0, other.find(" (")) + "\"]", "is UTF-8"));
}

TEST_CASE("a file that is too large or not a regular file is rejected before it is read", "[dae][model_file]")
{
    const std::string large(dae::JsonSource::max_bytes + 1, ' ');
    CHECK_THAT(error_message(large),
               Catch::StartsWith("bad.json:1:1 (/): the text has 67108865 bytes; at most 67108864"));
    std::string many = "[0";
    for (std::size_t k = 0; k < dae::JsonSource::max_values; ++k) many += ",0";
    CHECK_THAT(error_message(many + "]"), Catch::Contains("more than 2000000 values"));

    const std::filesystem::path folder = std::filesystem::temp_directory_path();
    CHECK_THROWS_AS(dae::load_model((folder / "hilda-there-is-no-such-file.json").string()),
                    lie::InvalidInput);
    CHECK_THROWS_WITH(dae::load_model((folder / "hilda-there-is-no-such-file.json").string()),
                      Catch::Contains("the file does not exist"));
    CHECK_THROWS_WITH(dae::load_model(folder.string()), Catch::Contains("regular file"));
    CHECK_THROWS_WITH(dae::load_model("/dev/zero"), Catch::Contains("regular file"));

    const std::filesystem::path sparse =
        folder / ("hilda-too-large-" + std::to_string(std::random_device{}()) + ".json");
    std::ofstream(sparse).put(' ');
    std::filesystem::resize_file(sparse, (1ull << 20) + dae::JsonSource::max_bytes);
    CHECK_THROWS_WITH(dae::load_model(sparse.string()),
                      Catch::Contains("the file has 68157440 bytes; at most 67108864"));
    std::filesystem::remove(sparse);
}

TEST_CASE("an invalid --set is quoted in the message", "[dae][model_file]")
{
    struct BadSet {
        std::string set, pointer, piece;
    };
    // clang-format off
    const std::vector<BadSet> sets = {
        {"end=3", "/", "--set \"end=3\": must be /json/pointer=VALUE"},
        {"/end", "/", "must be /json/pointer=VALUE"},
        {"=3", "/", "must be /json/pointer=VALUE"},
        {"", "/", "must be /json/pointer=VALUE"},
        {"/bodies/7/mass=2", "/bodies", "there is no \"7\" in a list of 3"},
        {"/bodies/-1/mass=2", "/bodies", "there is no \"-1\""},
        {"/bodies/0x1/mass=2", "/bodies", "there is no \"0x1\""},
        {"/bodies/3={}", "/bodies", "there is no \"3\""},
        {"/end/x=2", "/end", "there is no \"x\" in 2"},
        {"/solver/step=2", "/", "there is no \"solver\" in an object"},
        {"/a~2=2", "/", "'~' is written ~0"},
        {"/a~=2", "/", "'~' is written ~0"},
        {"/end=-1", "/end", "end must be positive, got -1 (from --set \"/end=-1\")"},
        {"/end=", "/end", "must be a number or an expression: empty expression in \"\" at column 1 (from --set \"/end=\")"},
        {"/end=1e999", "/end", "must be a number or an expression: the number '1e999' is out of range"},
        {"/endd=1", "/endd", "did you mean 'end'? (from --set \"/endd=1\")"},
        {"/bodies/0/mass=heavy", "/bodies/0/mass", "must be a number or an expression: unknown name 'heavy' in \"heavy\" at column 1; known: pi, e (from --set"},
        {"/bodies/0/r/1=[]", "/bodies/0/r/1", "must be a number, got []"},
        {"/constraints/3/f=sine(t)", "/constraints/3/f", "unknown function 'sine' in \"sine(t)\" at column 1; did you mean 'sin'? (from --set"},
        {"/bodies/0={\"name\": \"bar\"}", "/bodies/0", "missing key 'mass' (from --set"},
        {"/bodies/0/r/2=0.5", "/constraints/0", "the initial positions violate"},
    };
    // clang-format on
    for (const BadSet& bad : sets)
        check_message({"", bad.set, bad.pointer, bad.piece}, error_message(valid_model, {bad.set}));
}

TEST_CASE("a mutated model file is read, rejected, or fails numerically", "[dae][model_file]")
{
    static const std::string alphabet = "{}[]\",:.-+eE0123456789 \nabmnfr_\\/\xff\x80";
    std::mt19937 random(20);
    const auto below = [&](std::size_t n) { return random() % n; };
    int read = 0, started = 0;
    for (int k = 0; k < 2000; ++k) {
        std::string text = valid_model;
        for (std::size_t n = 1 + below(3); n > 0; --n) {
            const std::size_t at = below(text.size());
            switch (below(5)) {
                case 0:
                    text[at] = alphabet[below(alphabet.size())];
                    break;
                case 1:
                    text.erase(at, 1 + below(4));
                    break;
                case 2:
                    text.insert(at, 1, alphabet[below(alphabet.size())]);
                    break;
                case 3:
                    text.insert(at, text.substr(below(text.size()), below(40)));
                    break;
                default:
                    text.resize(at);
                    break;
            }
        }
        INFO(text);
        try {
            dae::Description d = dae::read_model(text, "mutant.json");
            ++read;
            CHECK(dae::read_model(d.text, "again.json").text == d.text);
            dae::start(d);
            ++started;
        } catch (const lie::InvalidInput& e) {
            REQUIRE_THAT(e.what(), Catch::StartsWith("mutant.json:"));
        } catch (const lie::NumericalFailure&) {
        }
    }
    CHECK(read > 20);
    CHECK(started > 5);
}
