// SPDX-License-Identifier: GPL-3.0-or-later
/// The contacts of a model file and their registered reader. Here the contacts are bristle forces.
#include <catch2/catch.hpp>

#include "dae/model_file.hpp"
#include "tests/support/bristle_contacts.hpp"

using namespace hilda;
using tests::Bristle;
using tests::BristleContacts;

namespace {

std::string model(const std::string& contacts)
{
    return R"({"hilda_model": 1, "name": "m", "contacts": )" + contacts + R"(,
 "bodies": [{"name": "bar", "id": 4, "mass": 2, "inertia": [1, 1, 1], "r": [3, 0, 0]},
            {"name": "bob", "mass": 5, "inertia": [1, 1, 1], "r": [3, 4, 0]}],
 "forces": [{"type": "torque", "body": "bob", "frame": "body", "components": [0, 0, 1]}]})";
}

std::string contact_error(const std::string& text)
{
    try {
        dae::Description d = dae::read_model(text, "m.json");
        dae::start(d);
        return "";
    } catch (const lie::InvalidInput& e) {
        return e.what();
    }
}

}  // namespace

TEST_CASE("the reader of a contact receives the model and the initial data",
          "[contact][model_file][contacts]")
{
    const BristleContacts reader;
    dae::Description d = dae::read_model(model(R"([
  {"body_i": "bar", "body_j": "bob", "note": "by default"},
  {"name": "brush", "body_i": "ground", "body_j": 4, "most": 0.5, "stiffness": 3}])"),
                                         "m.json");
    REQUIRE(d.model->forces().size() == 3);
    const auto bristle = [&](int k) { return dynamic_cast<const Bristle&>(*d.model->forces()[k]); };
    CHECK(bristle(1).name == "contact-1");
    CHECK(bristle(1).i == 0);
    CHECK(bristle(1).j == 1);
    CHECK(bristle(1).stiffness == 2);
    CHECK(bristle(1).max_stretch == Approx(0.4));
    CHECK(bristle(2).name == "brush");
    CHECK(bristle(2).i == dae::ground);
    CHECK(bristle(2).j == 0);
    CHECK(d.force_place[2] == "m.json:3:3 (/contacts/1)");

    // the canonical form contains defaults and names
    CHECK_THAT(d.text, Catch::Contains("\"contact-1\"") && Catch::Contains("\"stiffness\""));
    const dae::Description again = dae::read_model(d.text, "again.json");
    CHECK(again.text == d.text);
    CHECK(again.model->forces()[1]->name == "contact-1");

    dae::start(d);
    CHECK(d.x.internal_state == std::vector<double>{1, 0, 4, 0, 1, 3, 0, 0});
    CHECK(d.model->stable_step(d.x).force == 2);

    // the canonical form of a model without contacts has no key "contacts"
    CHECK_THAT(dae::read_model(model("[]"), "m.json").text, !Catch::Contains("contacts"));
}

TEST_CASE("an invalid contact is rejected with its location", "[contact][model_file][contacts]")
{
    const BristleContacts reader;
    struct InvalidContact {
        std::string contacts, message;
    };
    const std::string head = "m.json:1:", pair = R"({"body_i": "bar", "body_j": "bob")";
    const std::vector<InvalidContact> all = {
        {"3", "45 (/contacts): contacts must be a list, got 3"},
        {"[3]", "46 (/contacts/0): must be an object, got 3"},
        {R"([{"body_j": "bar"}])", "46 (/contacts/0): missing key 'body_i'"},
        {R"([{"body_i": "ground", "body_j": "ground"}])",
         "77 (/contacts/0/body_j): body_i and body_j must be two different bodies, got 'ground' twice"},
        {R"([{"body_i": "bar", "body_j": "bab"}])",
         "74 (/contacts/0/body_j): no body has this name, got \"bab\"; did you mean 'bar'?"},
        {"[" + pair + R"(, "stiffness": -1}])",
         "94 (/contacts/0/stiffness): stiffness must be positive, got -1"},
        {"[" + pair + R"(, "stifness": 1}])", "81 (/contacts/0/stifness): unknown key \"stifness\""},
        {"[" + pair + R"(, "type": "soft"}])", "81 (/contacts/0/type): unknown key \"type\""},
        {"[" + pair + R"(, "most": 11}])",
         "46 (/contacts/0): bristle: the length must be at most 10 m, got 11"},
        {"[" + pair + R"(, "name": ""}])", "89 (/contacts/0/name): name must be a name"},
        {"[" + pair + R"(, "name": "a"},)" + pair + R"(, "name": "a"}])",
         "137 (/contacts/1/name): this name is already used, got \"a\""},
    };
    for (const InvalidContact& bad : all) {
        INFO(bad.contacts);
        CHECK_THAT(contact_error(model(bad.contacts)), Catch::StartsWith(head + bad.message));
    }

    // errors that are detected at the start only
    std::string together = model("[" + pair + R"(, "most": 1, "name": "brush"}])");
    together.replace(together.find("[3, 4, 0]"), 9, "[3, 0, 0]");
    CHECK(contact_error(together) ==
          "m.json:1:46 (/contacts/0): bristle 'brush': the bodies must be apart at the start");
}

TEST_CASE("without a registered reader contacts are rejected", "[contact][model_file][contacts]")
{
    const BristleContacts restores_the_reader;
    dae::register_contact_reader(nullptr);
    CHECK(contact_error(model("[]")) == "");
    CHECK(contact_error(model("[{}, {}]")) ==
          "m.json:1:45 (/contacts): this program is built without contacts; the list must be empty, got 2");
    CHECK_THAT(contact_error(model("{}")), Catch::Contains("contacts must be a list"));
}
