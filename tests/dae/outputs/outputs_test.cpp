// SPDX-License-Identifier: GPL-3.0-or-later
/// Outputs of a model file: rates are derivatives of the quantities along a motion, angles count whole turns.

#include "dae/model_file.hpp"
#include "dae/outputs/output.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::dae;
using Catch::Matchers::Contains;
using tests::Random;

namespace {

/// A model of two free bodies with these outputs
Description with_outputs(const std::string& outputs, const std::string& more = "")
{
    return read_model(R"({"hilda_model": 1, "name": "two", "bodies": [
        {"name": "a", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 0]},
        {"name": "b", "mass": 1, "inertia": [1, 1, 1], "r": [1, 0, 0])" +
                          more + R"(}],
        "constraints": [], "outputs": [)" +
                          outputs + "]}",
                      "two.json");
}

std::vector<double> values(const Output& output, const State& x)
{
    std::vector<double> out(output.quantities().size());
    output.values(x, out.data());
    return out;
}

/// The values after the time tau along the motion of x
std::vector<double> after(const Output& output, const State& x, double tau)
{
    State later = x;
    for (Motion& m : later.body) m = tests::pose_after(m, tau);
    return values(output, later);
}

}  // namespace

TEST_CASE("the rates of outputs are the derivatives of their quantities", "[dae][outputs]")
{
    Random random(GENERATE(range(1u, 6u)));
    const State x = random.state(2);
    const Description model = with_outputs(
        R"({"name": "global", "type": "point", "body": "a", "point_bar": [0.1, 0.2, -0.3]},
           {"name": "seen from b", "type": "point", "body": "a", "point_bar": [0.1, 0.2, -0.3], "observer": "b"},
           {"name": "of the ground", "type": "point", "body": "ground", "point_bar": [1, 2, 3], "observer": "b"},
           {"name": "gap", "type": "length", "body_i": "a", "body_j": "b", "s_bar_p_i": [0.5, 0, 0]})");
    REQUIRE(model.outputs.size() == 4);
    const double h = 1e-4;
    for (const auto& output : model.outputs) {
        CAPTURE(output->name);
        const auto before = after(*output, x, -h), now = after(*output, x, 0), later = after(*output, x, h);
        const size_t positions = output->name == "gap" ? 1 : 3;
        for (size_t k = 0; k < positions; ++k) {
            CHECK(now[k + positions] == Approx((later[k] - before[k]) / (2 * h)).margin(1e-6));
            if (positions == 3)
                CHECK(now[k + 6] == Approx((later[k] - 2 * now[k] + before[k]) / (h * h)).margin(1e-5));
        }
    }
}

TEST_CASE("an angle in the outputs counts whole turns in both directions", "[dae][outputs]")
{
    const Description model = with_outputs(
        R"({"name": "phi", "type": "angle", "body_i": "a", "body_j": "b", "axis_bar_i": [0, 0, 2],
            "axis_bar_j": [0, 0, 1]})");
    State x = model.x;
    model.model->prepare(x);
    double angle = 0;
    for (int k = 0; k < 200; ++k) {
        const State before = x;
        angle += k < 120 ? 0.3 : -0.4;
        x.body[1].A = lie::exp(Vec3(0, 0, angle));
        x.body[1].omega_bar = {0, 0, 7};
        model.model->accepted(before, x);
        const std::vector<double> now = values(*model.outputs[0], x);
        CHECK(now[0] == Approx(angle).margin(1e-12));
        CHECK(now[1] == Approx(7));
    }
    CHECK(std::abs(angle) < 10);
}

TEST_CASE("an angle in the outputs is counted over steps of several turns", "[dae][outputs]")
{
    const Description model = with_outputs(
        R"({"name": "phi", "type": "angle", "body_i": "a", "body_j": "b", "axis_bar_i": [0, 0, 1],
            "axis_bar_j": [0, 0, 1]})");
    State x = model.x;
    x.body[1].omega_bar = {0, 0, 10};
    model.model->prepare(x);
    for (int k = 0; k < 20; ++k) {
        const State before = x;
        x.t = 0.7 * k;
        x.body[1].A = lie::exp(Vec3(0, 0, 10 * x.t + 10 * x.t * x.t));
        x.body[1].omega_bar = {0, 0, 10 + 20 * x.t};
        model.model->accepted(before, x);
        CHECK(values(*model.outputs[0], x)[0] == Approx(10 * x.t + 10 * x.t * x.t).margin(1e-11));
    }
    // Back within the step, as for a node inside the last internal step of an adaptive scheme
    State node = x;
    node.t = x.t - 0.3;
    node.body[1].A = lie::exp(Vec3(0, 0, 10 * node.t + 10 * node.t * node.t));
    node.body[1].omega_bar = {0, 0, 10 + 20 * node.t};
    model.model->accepted(x, node);
    CHECK(values(*model.outputs[0], node)[0] == Approx(10 * node.t + 10 * node.t * node.t).margin(1e-11));
}

TEST_CASE("a counted angle has no load and is not one of the forces", "[dae][outputs]")
{
    const Description model = with_outputs(
        R"({"name": "phi", "type": "angle", "body_i": "a", "body_j": "b", "axis_bar_i": [0, 0, 1],
            "axis_bar_j": [0, 0, 1]})");
    State x = model.x;
    model.model->prepare(x);
    CHECK(model.model->forces().empty());
    CHECK(model.model->load_pattern().block.empty());
    CHECK(x.discrete_state == std::vector<int>{0});
    CHECK_FALSE(model.model->counts_turns());
    CHECK_FALSE(model.model->internal_states_are_history());
    Model other;
    CHECK_THROWS_WITH(other.count(model.outputs[0]->turns()), Contains("no body has this number"));
}

TEST_CASE("outputs are part of the canonical form, and wrong outputs are rejected with their place",
          "[dae][outputs]")
{
    const Description model = with_outputs(
        R"({"type": "point", "body": "a"}, {"name": "E", "type": "expression", "value": "a.rx"})");
    CHECK(model.outputs[0]->name == "point-1");
    CHECK(model.outputs[1]->expression() == "a.rx");
    const Description with_parameters =
        read_model(R"({"hilda_model": 1, "name": "p", "parameters": {"m": "1 + 1", "a": 3},
        "bodies": [{"name": "a", "mass": "m", "inertia": [1, 1, 1], "r": [0, 0, "a"]}],
        "outputs": [{"type": "expression", "value": "0.5*m*a.vx^2 + {a.m} + a"}]})",
                   "p.json");
    CHECK(with_parameters.outputs[0]->expression() == "0.5*(2)*a.vx^2 + {a.m} + (3)");
    CHECK(with_parameters.warnings.empty());
    // A column takes precedence over a parameter of the same name, with a warning.
    const Description shadowed =
        read_model(R"({"hilda_model": 1, "name": "p", "parameters": {"energy": 3, "x": 7},
        "bodies": [{"name": "a", "mass": "energy", "inertia": [1, 1, 1], "r": [0, 0, "x"]}],
        "outputs": [{"name": "x", "type": "expression", "value": "energy"},
                    {"type": "expression", "value": "2*x"}]})",
                   "p.json");
    CHECK(shadowed.outputs[0]->expression() == "energy");
    CHECK(shadowed.outputs[1]->expression() == "2*x");
    CHECK(shadowed.warnings.size() == 2);

    const Description again = read_model(model.text, "again.json");
    CHECK(again.text == model.text);
    CHECK(again.outputs.size() == 2);

    const auto rejected = [](const std::string& output, const std::string& message) {
        CHECK_THROWS_WITH(with_outputs(output), Contains("two.json:4:") && Contains(message));
    };
    rejected(R"({"type": "pont", "body": "a"})", "did you mean 'point'");
    rejected(R"({"type": "point", "body": "c"})", "no body has this name, got \"c\"");
    rejected(R"({"type": "point", "body": "a", "observer": "a"})", "must be different");
    rejected(R"({"type": "point", "body": "a", "pointbar": [0, 0, 0]})", "unknown key \"pointbar\"");
    rejected(
        R"({"type": "angle", "body_i": "a", "body_j": "b", "axis_bar_i": [1, 0, 0], "axis_bar_j": [0, 1, 0]})",
        "parallel");
    rejected(R"({"type": "expression", "value": ""})", "value");
    rejected(R"({"name": "x", "type": "point", "body": "a"}, {"name": "x", "type": "point", "body": "b"})",
             "already used");
}
