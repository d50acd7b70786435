// SPDX-License-Identifier: GPL-3.0-or-later
/// Contacts between groups of bodies in a model file.
#include <catch2/catch.hpp>

#include "contact/compliant/contact_force.hpp"
#include "contact/evolving/contact.hpp"
#include "dae/model_file.hpp"

using namespace hilda;

namespace {

/// Four balls of radius 0.1 in a row, 0.3 m apart, and these contacts on line 3
std::string balls(const std::string& contacts)
{
    std::string bodies;
    for (int k = 1; k <= 4; ++k)
        bodies += (k > 1 ? ", " : "") + (R"({"name": "b)" + std::to_string(k)) +
                  R"(", "mass": 1, "shape": {"sphere": 0.1}, "r": [)" + std::to_string(0.3 * k) +
                  ", 0, 0.1]}";
    return "{\"hilda_model\": 1, \"name\": \"balls\",\n\"bodies\": [" + bodies + "],\n\"contacts\": [" +
           contacts + "]}";
}

const std::string spring = R"("normal": {"type": "hooke", "stiffness": 1e4})";
const std::string ball_surface = R"({"type": "sphere", "radius": 0.1})";
const std::string each_two =
    R"({"name": "balls", "bodies": "all", "surface": )" + ball_surface + ", " + spring + "}";

std::vector<std::string> names(const dae::Description& d)
{
    std::vector<std::string> all;
    for (const auto& force : d.model->forces()) all.push_back(force->name);
    return all;
}

std::string refusal_of_contacts(const std::string& contacts)
{
    try {
        dae::Description d = dae::read_model(balls(contacts), "m.json");
        dae::start(d);
        return "accepted";
    } catch (const lie::InvalidInput& e) {
        return e.what();
    }
}

/// A contact of a group given by `keys`, between spheres and planes of the same kind
std::string entry(const std::string& keys, const std::string& surface_j = ball_surface)
{
    return "{" + keys + ", \"surface_i\": " + ball_surface + ", \"surface_j\": " + surface_j + ", " + spring +
           "}";
}

}  // namespace

TEST_CASE("a group of n bodies is read as n (n - 1) / 2 contacts", "[contact][groups]")
{
    const dae::Description d = dae::read_model(balls(each_two), "m.json");
    CHECK(names(d) == std::vector<std::string>{"balls: b1-b2", "balls: b1-b3", "balls: b1-b4", "balls: b2-b3",
                                               "balls: b2-b4", "balls: b3-b4"});
    CHECK(d.force_place.size() == 6);
    CHECK(d.force_place[5].starts_with("m.json:3:14 (/contacts/0)"));
    const auto& first = dynamic_cast<const contact::ContactForce&>(*d.model->forces()[0]);
    const auto& last = dynamic_cast<const contact::ContactForce&>(*d.model->forces()[5]);
    CHECK(first.contact.i.surface == last.contact.j.surface);  // read once

    // The canonical form lists the pairs.
    const dae::Description again = dae::read_model(d.text, "again.json");
    CHECK(again.text == d.text);
    CHECK(names(again) == names(d));
}

TEST_CASE("a group gives the same motion as its pairs written one by one", "[contact][groups]")
{
    std::string pairs;
    for (const auto& [i, j] : {std::pair(1, 2), {1, 3}, {1, 4}, {2, 3}, {2, 4}, {3, 4}})
        pairs += (pairs.empty() ? "" : ", ") + entry("\"body_i\": \"b" + std::to_string(i) +
                                                     "\", \"body_j\": \"b" + std::to_string(j) + "\"");
    // overlapping by 0.005 m and 0.1 m apart
    const std::vector<std::string> near = {"/bodies/1/r/0=0.495"};
    dae::Description group = dae::read_model(balls(each_two), "m.json", near),
                     single = dae::read_model(balls(pairs), "m.json", near);
    dae::start(group);
    dae::start(single);
    CHECK(group.x.body[0].rddot.x() == Approx(-1e4 * 0.005));
    for (int b = 0; b < 4; ++b) CHECK(group.x.body[b].rddot == single.x.body[b].rddot);
}

TEST_CASE("each body of one list meets each body of another", "[contact][groups]")
{
    const auto of = [](const std::string& keys, const std::string& surface_j = ball_surface) {
        return names(dae::read_model(balls(entry(keys, surface_j)), "m.json"));
    };
    using Names = std::vector<std::string>;
    CHECK(of(R"("body_i": "all", "body_j": "ground")", R"({"type": "plane"})") ==
          Names{"contact-1: b1-ground", "contact-1: b2-ground", "contact-1: b3-ground",
                "contact-1: b4-ground"});
    CHECK(of(R"("body_i": ["b3", "b1"], "body_j": ["b2", "b4"])") ==
          Names{"contact-1: b3-b2", "contact-1: b3-b4", "contact-1: b1-b2", "contact-1: b1-b4"});
    // no body meets itself, and each pair is taken once
    CHECK(of(R"("body_i": ["b1", "b2"], "body_j": ["b2", "b1"])") == Names{"contact-1: b1-b2"});
    CHECK(of(R"("body_i": "b1", "body_j": "all")") ==
          Names{"contact-1: b1-b2", "contact-1: b1-b3", "contact-1: b1-b4"});
    CHECK(of(R"("body_i": "b1", "body_j": "b2")") == Names{"contact-1"});
    // the numbers of contacts without a name are their places in the list
    CHECK(
        names(dae::read_model(balls(each_two + ", " + entry(R"("body_i": "b1", "body_j": "b2")")), "m.json"))
            .back() == "contact-2");
}

TEST_CASE("a group of constraint contacts reads the surfaces once and keeps the place of each",
          "[contact][groups]")
{
    const std::string floor = R"({"name": "floor", "body_i": "all", "body_j": "ground", "surface_i": )" +
                              ball_surface +
                              R"(, "surface_j": {"type": "plane"}, "normal": {"type": "constraint"}})";
    dae::Description d = dae::read_model(balls(floor), "m.json", {}, "fixed-xy");
    CHECK(d.general_place.size() == 4);
    CHECK(d.changes == std::vector<std::string>{"/contacts/0/normal/rows=fixed-xy"});
    dae::start(d);
    CHECK(d.model->general_constraints().size() == 4);
}

TEST_CASE("an error of one pair names the group and the pair", "[contact][groups]")
{
    std::string deep = balls(each_two);
    try {
        dae::Description d = dae::read_model(deep, "m.json", std::vector<std::string>{"/bodies/2/r/0=0.65"});
        dae::start(d);
        FAIL("the overlap is too large");
    } catch (const lie::InvalidInput& e) {
        CHECK(std::string(e.what()) ==
              "m.json:3:14 (/contacts/0): contact 'balls: b2-b3': the surfaces must not overlap by more than "
              "0.01 m, a "
              "tenth of the radius of curvature 0.1 m, got 0.15 m");
    }
    CHECK_THAT(
        refusal_of_contacts(
            R"({"name": "balls", "bodies": "all", "surface": {"type": "sphere", "radius": 0.1, "concave": true}, )" +
            spring + "}"),
        Catch::StartsWith("m.json:3:14 (/contacts/0): contact 'balls: b1-b2': contact::make_detector: "));
    CHECK_THAT(refusal_of_contacts(R"({"bodies": "all", "surface": {"type": "sphere", "radius": -1}, )" +
                                   spring + "}"),
               Catch::Contains("(/contacts/0/surface/radius): radius must be positive, got -1"));
}

TEST_CASE("wrong groups are refused", "[contact][groups]")
{
    const auto group = [](const std::string& bodies) {
        return refusal_of_contacts(R"({"bodies": )" + bodies + ", \"surface\": " + ball_surface + ", " +
                                   spring + "}");
    };
    CHECK_THAT(group("[]"), Catch::Contains("(/contacts/0/bodies): bodies must not be an empty list"));
    CHECK_THAT(group(R"(["b1"])"), Catch::Contains("a group must have at least two bodies, got 1"));
    CHECK_THAT(group(R"(["b1", "b7"])"),
               Catch::Contains("(/contacts/0/bodies/1): no body has this name, got \"b7\"; did you mean"));
    CHECK_THAT(group(R"(["b1", "b2", "b1"])"),
               Catch::Contains("(/contacts/0/bodies/2): bodies lists a body twice, got \"b1\""));
    CHECK_THAT(group(R"(["b1", 7])"), Catch::Contains("no body has this id, got 7"));
    CHECK_THAT(group(R"(["b1", null])"), Catch::Contains("must be the name or the id of a body, got null"));
    CHECK_THAT(group(R"("b1")"), Catch::Contains("bodies must be a list of bodies or \"all\", got \"b1\""));
    CHECK_THAT(refusal_of_contacts(entry(R"("bodies": "all")")),
               Catch::Contains("(/contacts/0/surface_i): surface_i does not go with bodies"));
    CHECK_THAT(refusal_of_contacts(R"({"bodies": "all", )" + spring + "}"),
               Catch::Contains("missing key 'surface'"));
    CHECK_THAT(refusal_of_contacts(entry(R"("body_i": ["b1"], "body_j": "b1")")),
               Catch::Contains("must contain two different bodies"));
    CHECK_THAT(refusal_of_contacts(entry(R"("body_i": "b1", "body_j": "b1")")),
               Catch::Contains("body_i and body_j must be two different bodies, got 'b1' twice"));
    CHECK_THAT(refusal_of_contacts(entry(R"("body_i": "al", "body_j": "ground")")),
               Catch::Contains("no body has this name, got \"al\""));
    CHECK_THAT(refusal_of_contacts(each_two + ", " + each_two),
               Catch::Contains("(/contacts/1/name): this name is already used, got \"balls\""));
}

TEST_CASE("a body called all is a body", "[contact][groups]")
{
    const std::string text = balls(entry(R"("body_i": "all", "body_j": "b1")"));
    const dae::Description d =
        dae::read_model(text, "m.json", std::vector<std::string>{"/bodies/3/name=\"all\""});
    CHECK(names(d) == std::vector<std::string>{"contact-1"});
}
