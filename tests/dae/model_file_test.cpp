// SPDX-License-Identifier: GPL-3.0-or-later
/// The model file: all types of constraints and forces, round trip, --set, and the keys of the published
/// files.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <numbers>

#include "dae/constraints/cd.hpp"
#include "dae/constraints/d.hpp"
#include "dae/constraints/dp1.hpp"
#include "dae/constraints/dp2.hpp"
#include "dae/constraints/driven_hinge.hpp"
#include "dae/forces/prescribed.hpp"
#include "dae/forces/spring_damper.hpp"
#include "dae/forces/torsion_spring.hpp"
#include "dae/model_file.hpp"
#include "dae/object_reader.hpp"
#include "lie/euler_parameters.hpp"
#include "tests/support/paths.hpp"

using namespace hilda;
using dae::ground;
using lie::Mat3;
using lie::Vec3;

namespace {

const std::filesystem::path models = std::filesystem::path(tests::test_data) / "models";

dae::Description load(const std::string& name, const std::vector<std::string>& set = {})
{
    return dae::load_model((models / (name + ".json")).string(), set);
}

std::vector<std::string> valid_models()
{
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(models))
        if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
    std::sort(names.begin(), names.end());
    return names;
}

/// A model of one bar as JSON. `keys` is added to the bar, `more` to the model.
std::string bar(const std::string& keys, const std::string& more = "")
{
    return R"({"hilda_model": 1, "name": "m", "bodies": [{"name": "bar", "mass": 1, "inertia": [1, 1, 1], "r": [1, 2, 3])" +
           keys + "}]" + more + "}";
}

/// The rows of a constraint
std::vector<const dae::Block*> rows(const dae::Model& model, int number)
{
    std::vector<const dae::Block*> blocks;
    for (const auto& row : model.all_rows())
        if (row.constraint == number) blocks.push_back(row.block.get());
    return blocks;
}

/// The types of these rows in order, for example "CD CD CD DP1"
std::string types(const std::vector<const dae::Block*>& blocks)
{
    std::string all;
    for (const dae::Block* b : blocks) {
        all += all.empty() ? "" : " ";
        all += dynamic_cast<const dae::CD*>(b)            ? "CD"
               : dynamic_cast<const dae::DP1*>(b)         ? "DP1"
               : dynamic_cast<const dae::DP2*>(b)         ? "DP2"
               : dynamic_cast<const dae::D*>(b)           ? "D"
               : dynamic_cast<const dae::DrivenHinge*>(b) ? "hinge"
                                                          : "?";
    }
    return all;
}

}  // namespace

TEST_CASE("every valid model is read and started, and its canonical form is read as the same model",
          "[dae][model_file]")
{
    CHECK(valid_models().size() >= 5);
    for (const std::string& name : valid_models()) {
        INFO(name);
        dae::Description d = load(name);
        const dae::Description again = dae::read_model(d.text, "again.json");
        CHECK(again.text == d.text);
        CHECK(again.warnings.empty());
        CHECK(again.name == d.name);
        CHECK(again.end == d.end);
        CHECK(again.model->gravity == d.model->gravity);
        REQUIRE(again.model->bodies() == d.model->bodies());
        REQUIRE(again.model->constraints() == d.model->constraints());
        REQUIRE(again.model->forces().size() == d.model->forces().size());
        CHECK(d.constraint_place.size() == static_cast<std::size_t>(d.model->constraints()));
        CHECK(d.force_place.size() == d.model->forces().size());
        for (int b = 0; b < d.model->bodies(); ++b) {
            CHECK(again.model->all_bodies()[b].name == d.model->all_bodies()[b].name);
            CHECK(again.model->all_bodies()[b].m == d.model->all_bodies()[b].m);
            CHECK(again.model->all_bodies()[b].J_bar == d.model->all_bodies()[b].J_bar);
            const lie::Motion &x = d.x.body[b], &y = again.x.body[b];
            CHECK((x.r == y.r && x.A == y.A && x.rdot == y.rdot && x.omega_bar == y.omega_bar));
        }
        dae::Description other = dae::read_model(d.text, "again.json");
        dae::start(d);
        dae::start(other);
        CHECK(d.x.lambda == other.x.lambda);
        for (int b = 0; b < d.model->bodies(); ++b)
            CHECK((d.x.body[b].rddot == other.x.body[b].rddot &&
                   d.x.body[b].omegadot_bar == other.x.body[b].omegadot_bar));
    }
}

TEST_CASE("each type of constraint gives its rows", "[dae][model_file]")
{
    const dae::Description d = load("every_type");
    const std::vector<std::string> expected = {"DP1",
                                               "DP2",
                                               "D",
                                               "CD",
                                               "CD CD CD",
                                               "CD CD CD DP1 DP1",
                                               "DP1 DP1 DP2 DP2",
                                               "DP1 DP1 DP2 DP2 DP1",
                                               "CD CD CD DP1",
                                               "DP1 DP2 DP2",
                                               "CD CD CD DP1 DP1 DP1",
                                               "D",
                                               "hinge"};
    REQUIRE(d.model->constraints() == static_cast<int>(expected.size()));
    for (int k = 0; k < d.model->constraints(); ++k) {
        INFO(d.model->constraint_name(k));
        CHECK(types(rows(*d.model, k)) == expected[k]);
        // each connects the ground with the body of its name
        CHECK(d.model->constraint_name(k) == "the " + d.model->all_bodies()[k].name);
        for (const dae::Block* b : rows(*d.model, k))
            CHECK(std::minmax(b->i, b->j) == std::minmax(ground, k));
    }
}

TEST_CASE("the basic constraints have the values of the file", "[dae][model_file]")
{
    const dae::Description d = load("every_type");
    const auto block = [&](int k) { return rows(*d.model, k)[0]; };

    const auto& dp1 = dynamic_cast<const dae::DP1&>(*block(0));
    CHECK(dp1.i == ground);
    CHECK(dp1.j == 0);
    CHECK(dp1.a_bar_i == Vec3(1, 0, 0));
    CHECK(dp1.a_bar_j == Vec3(0, 1, 0));
    CHECK(dp1.f.text() == "0.1*t^2");

    const auto& dp2 = dynamic_cast<const dae::DP2&>(*block(1));
    CHECK(dp2.a_bar_i == Vec3(0, 0, 2));
    CHECK(dp2.s_bar_i == Vec3(2, 0, 0));
    CHECK(dp2.s_bar_j == Vec3::Zero());
    CHECK(dp2.f.text() == "sin(t)^2");

    const auto& distance = dynamic_cast<const dae::D&>(*block(2));
    CHECK(distance.s_bar_i == Vec3(3, 0, 1));
    CHECK(distance.s_bar_j == Vec3(0, 0, -1));
    CHECK(distance.f.f(0) == 4);

    const auto& cd = dynamic_cast<const dae::CD&>(*block(3));
    CHECK(cd.c == Vec3(0, 0, 1));
    CHECK(cd.s_bar_i == Vec3(4, 0, 0));
    CHECK(cd.f.f(0) == 0);

    CHECK(dynamic_cast<const dae::D&>(*block(11)).f.f(0) == 2.25);
    CHECK(dynamic_cast<const dae::DrivenHinge&>(*block(12)).g.text() == "0.5*t^2");
}

TEST_CASE("each type of force is read", "[dae][model_file]")
{
    const dae::Description d = load("every_type");
    const auto& forces = d.model->forces();
    REQUIRE(forces.size() == 4);

    const auto& spring = dynamic_cast<const dae::SpringDamper&>(*forces[0]);
    CHECK(spring.name == "spring-damper-1");
    CHECK(spring.i == 0);
    CHECK(spring.j == 1);
    CHECK(spring.s_bar_i == Vec3(0, 0, 0.25));
    CHECK(spring.s_bar_j == Vec3(0, 0, 0.5));
    CHECK(spring.stiffness == 10);
    CHECK(spring.damping == 1);
    CHECK(spring.free_length == 0.5);
    REQUIRE(spring.law);
    CHECK(spring.law->formula.value(std::vector<double>{2, 3, 0}) == 6);  // l, ldot, t

    const auto& torsion = dynamic_cast<const dae::TorsionSpring&>(*forces[1]);
    CHECK(torsion.name == "torsion-spring-2");
    CHECK(torsion.i == ground);
    CHECK(torsion.axis_bar_i == Vec3(0, 0, 1));
    CHECK(torsion.stiffness == 3);
    CHECK(torsion.damping == 0);
    CHECK(torsion.free_angle == -0.25);

    const auto& wind = dynamic_cast<const dae::PrescribedForce&>(*forces[2]);
    CHECK(wind.name == "wind");
    CHECK(d.model->all_bodies()[wind.body].name == "spherical");  // by its id
    CHECK(wind.point_bar == Vec3(0, 0, 0.1));
    CHECK(wind.frame == dae::Frame::global);
    CHECK(wind.components.value(0, 0)[0] == 1);
    CHECK(wind.components.value(0.5, 0)[1] == 1);

    const auto& motor = dynamic_cast<const dae::PrescribedTorque&>(*forces[3]);
    CHECK(motor.frame == dae::Frame::body);
    CHECK(motor.components.value(0, 0)[2] == 1);
}

TEST_CASE("the three forms of an orientation give the same rotation", "[dae][model_file]")
{
    const Vec3 u = Vec3(1, -2, 2) / 3;
    const double phi = 2.1;
    const Mat3 A = lie::exp(phi * u);
    const lie::Vec4 p = lie::euler_parameters(A);
    const auto read = [](const std::string& key, const dae::Json& v) {
        return dae::read_model(bar(", \"" + key + "\": " + written(v)), "m").x.body[0].A;
    };
    const auto list = [](const Eigen::VectorXd& v) {
        dae::Json::List all;
        for (const double x : v) all.push_back(x);
        return dae::Json(all);
    };
    CHECK(read("A", dae::json(A)) == A);
    CHECK((read("p", list(p)) - A).norm() < 1e-15);
    CHECK((read("p", list(-p)) - A).norm() < 1e-15);
    CHECK((read("axis_angle", list(lie::Vec4(u.x(), u.y(), u.z(), phi))) - A).norm() < 1e-15);
    CHECK((read("axis_angle", list(lie::Vec4(u.x(), u.y(), u.z(), phi - 6 * std::numbers::pi))) - A).norm() <
          1e-14);
    CHECK(lie::orthogonality_error(read("axis_angle", list(lie::Vec4(0, 0, 1, 1e300)))) < 1e-15);
    CHECK(dae::read_model(bar(""), "m").x.body[0].A == Mat3::Identity());

    // A with seven digits is replaced by the nearest rotation
    const Mat3 rounded = (A * 1e7).array().round() / 1e7;
    const Mat3 corrected = read("A", dae::json(rounded));
    CHECK(lie::orthogonality_error(rounded) > 1e-8);
    CHECK(lie::orthogonality_error(corrected) < 1e-14);
    CHECK((corrected - lie::nearest_rotation(rounded)).norm() == 0);
}

TEST_CASE("a missing key has its default", "[dae][model_file]")
{
    const dae::Description d = dae::read_model(
        bar("",
            R"(, "constraints": [{"type": "CD", "body_i": "ground", "body_j": "bar", "c": [1, 0, 0], "f": 1}])"),
        "m.json");
    CHECK(d.model->gravity == Vec3(0, 0, -9.81));
    CHECK(d.end == 1);
    CHECK(d.x.t == 0);
    CHECK(d.x.body[0].rdot == Vec3::Zero());
    CHECK(d.x.body[0].omega_bar == Vec3::Zero());
    CHECK(d.model->constraint_name(0) == "CD-1");
    CHECK(d.constraint_place[0].starts_with("m.json:1:"));
    CHECK(d.constraint_place[0].ends_with(" (/constraints/0)"));
    CHECK(d.warnings.empty());
}

TEST_CASE("the canonical form of a model is unique", "[dae][model_file]")
{
    const dae::Description d =
        dae::read_model(bar(R"(, "note": "a \"bar\"", "p": [0, 0, 0, 1], "omega": [-0.0, 1e-7, 0.1])"), "m");
    CHECK(d.text == R"({
  "hilda_model": 1,
  "name": "m",
  "gravity": [0, 0, -9.81],
  "end": 1,
  "bodies": [
    {
      "name": "bar",
      "mass": 1,
      "inertia": [1, 1, 1],
      "r": [1, 2, 3],
      "A": [[-1, 0, 0], [0, -1, 0], [0, 0, 1]],
      "r_dot": [0, 0, 0],
      "omega": [-0, 1e-07, 0.1],
      "note": "a \"bar\""
    }
  ],
  "constraints": [],
  "forces": []
}
)");
    CHECK(dae::read_model(d.text, "m").text == d.text);
    CHECK(std::signbit(dae::read_model(d.text, "m").x.body[0].omega_bar.x()));
}

TEST_CASE("values are changed and added by --set before the model is built", "[dae][model_file]")
{
    const dae::Description d =
        load("double_pendulum", {"/bodies/0/mass=80", "/end=0.5", "/gravity=[0, 0, -1.62]",
                                 "/name=on the moon", "/bodies/1/r_dot=[0, 1, 0]", "/bodies/0/inertia/1=0.5",
                                 "/end=0.75", "/constraints/1/name=elbow=joint"});
    CHECK(d.model->all_bodies()[0].m == 80);
    CHECK(d.end == 0.75);  // the last change applies
    CHECK(d.model->gravity == Vec3(0, 0, -1.62));
    CHECK(d.name == "on the moon");
    CHECK(d.x.body[1].rdot == Vec3(0, 1, 0));
    CHECK(d.model->all_bodies()[0].J_bar(1, 1) == 0.5);
    CHECK(d.model->constraint_name(1) == "elbow=joint");
    // the canonical form is that of the changed model
    CHECK(dae::read_model(d.text, "again").text == d.text);
    CHECK_THAT(d.text, Catch::Contains("\"mass\": 80,"));

    const dae::Description f =
        load("slider_spring", {"/constraints/2/f=0.3 + 0.1*sin(2*t)", "/forces/0/force=0"});
    CHECK(dynamic_cast<const dae::DP2&>(*rows(*f.model, 2)[0]).f.text() == "0.3 + 0.1*sin(2*t)");
}

TEST_CASE("the keys of the published files are read: ids, a ground without r, f_dot and f_ddot",
          "[dae][model_file]")
{
    const dae::Description d = load("published_style");
    CHECK(d.model->bodies() == 1);
    REQUIRE(d.model->constraints() == 5);
    for (const auto& row : d.model->all_rows()) {
        CHECK(row.block->i == 0);
        CHECK(row.block->j == ground);
    }
    REQUIRE(d.warnings.size() == 2);
    CHECK_THAT(d.warnings[0],
               Catch::Contains("published_style.json:1:1 (/): ") && Catch::Contains("hilda_model"));
    CHECK_THAT(d.warnings[1], Catch::Contains("(/constraints/0/f_dot): f_dot and f_ddot are ignored") &&
                                  Catch::Contains("in 5 constraints"));
}

TEST_CASE("the ground may be listed under another name", "[dae][model_file]")
{
    const dae::Description d = dae::read_model(R"({"name": "m", "bodies": [
        {"name": "frame", "id": 0}, {"name": "bar", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 0]}],
        "constraints": [{"type": "spherical", "body_i": "frame", "body_j": "bar"}, {"type": "CD", "body_i": 0, "body_j": "bar", "c": [1, 0, 0]}]})",
                                               "m");
    CHECK(d.model->bodies() == 1);
    for (const auto& row : d.model->all_rows()) CHECK(row.block->i == ground);
}

TEST_CASE("redundant joints of a file are named at the start", "[dae][model_file]")
{
    dae::Description d = load("four_bar");
    const dae::StartReport report = dae::start(d);
    CHECK(report.rows == 21);
    CHECK(report.rank == 18);
    CHECK(report.degrees_of_freedom == 0);
    REQUIRE(report.dropped.size() == 3);
    for (const std::string& row : report.dropped) CHECK_THAT(row, Catch::StartsWith("constraint 'D' row "));
}

TEST_CASE("a start that violates the constraints is projected on request", "[dae][model_file]")
{
    dae::Description d = load("double_pendulum", {"/bodies/1/r/2=-1.001"});
    CHECK_THROWS_AS(dae::start(d), dae::ConstraintError);
    const dae::StartReport report = dae::start(d, {.fix_initial = true});
    CHECK(report.projected);
    CHECK(d.model->largest_residual(d.x).value < 1e-12);
}

TEST_CASE("any strict JSON is stored with its locations", "[dae][model_file]")
{
    const std::string text = "{\"a\": [1, true, null, -0, 2.5e3],\n \"b\\u00e9\": {\"\": \"\\n\"}}";
    const dae::JsonSource source(text, "f");
    REQUIRE(source.root.members()->size() == 2);
    const dae::Json::List& a = *source.root.member("a")->value.list();
    CHECK(*a[0].number() == 1);
    CHECK(std::get<bool>(a[1].value));
    CHECK(a[2].value.index() == 0);
    CHECK(std::signbit(*a[3].number()));
    CHECK(*a[4].number() == 2500);
    CHECK(source.place(a[4].offset, "/a/4") == "f:1:27 (/a/4)");
    CHECK(source.place((*source.root.members())[1].offset, "") == "f:2:2 (/)");
    CHECK(*source.root.member("b\xc3\xa9")->value.member("")->value.string() == "\n");
    CHECK(written(source.root) ==
          "{\n  \"a\": [1, true, null, -0, 2500],\n  \"b\xc3\xa9\": {\n    \"\": \"\\n\"\n  }\n}");
}
