// SPDX-License-Identifier: GPL-3.0-or-later
// Built-in models as model files: hilda models --write.
#include "studies/framework/problem.hpp"

#include "io/json.hpp"
#include "io/json_source.hpp"
#include "tests/support/program/program.hpp"
#include "tests/support/program/refused.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cctype>

using namespace hilda;
using namespace hilda::tests;
using Catch::Matchers::Contains;

namespace {

std::vector<std::string> all_names()
{
    std::vector<std::string> names = {"n_pendulum_3"};
    for (const studies::Problem& p : studies::problems()) names.push_back(p.name);
    return names;
}

/// The numbers of a JSON text, outside its strings
std::vector<std::string> numbers_of(const std::string& text)
{
    std::vector<std::string> all;
    bool in_string = false;
    for (size_t k = 0; k < text.size(); ++k) {
        if (text[k] == '"') in_string = !in_string;
        if (in_string || (text[k] != '-' && std::isdigit(text[k]) == 0)) continue;
        const size_t end = std::min(text.find_first_not_of("+-.eE0123456789", k), text.size());
        all.push_back(text.substr(k, end - k));
        k = end - 1;
    }
    return all;
}

/// The number of significant digits of a decimal number
size_t significant_digits(const std::string& number)
{
    std::string digits;
    for (const char c : number.substr(0, number.find_first_of("eE")))
        if (std::isdigit(c) != 0) digits += c;
    digits.erase(0, digits.find_first_not_of('0'));
    while (digits.ends_with('0')) digits.pop_back();
    return digits.size();
}

}  // namespace

TEST_CASE("each built-in model written to a file passes the check and gives the same bytes of a run",
          "[studies][command line]")
{
    const Scratch in;
    // integrators, and the number of models that each accepts: rA-full-1 and rA-half-2 have no rolling
    // without slip and diverge with the stiff springs of the governor, rA-full-1 with the strut as well, and
    // ida-rp has no contacts and no redundant rows
    const auto [integrator, accepted] = GENERATE(table<std::string, size_t>(
        {{"rA-half-1", 28}, {"rA-full-1", 23}, {"rA-half-2", 24}, {"ida-rp", 15}}));
    size_t runs = 0;
    for (const std::string& name : all_names()) {
        CAPTURE(name);
        const std::string file = name + ".json";
        REQUIRE(call(in, {"models", name, "--write", file}).code == 0);
        const Ended checked = call(in, {"check", file, "--quiet"});
        CHECK(checked.code == 0);
        CHECK(checked.err.empty());
        const auto run = [&, scheme = integrator](const std::string& model, const std::string& output) {
            std::vector<std::string> arguments = {"run",  model,      "--integrator", scheme,    "--end",
                                                  "0.01", "--output", output,         "--force", "--quiet"};
            if (scheme != "ida-rp") arguments.insert(arguments.end(), {"--step", "1e-3"});
            return call(in, arguments);
        };
        const Ended built_in = run(name, "a"), from_file = run(file, "b");
        CHECK(from_file.code == built_in.code);
        if (built_in.code != 0) continue;  // the integrator does not accept the contacts of the model
        ++runs;
        const std::string rows = read(in / "b/trajectory.csv");
        CHECK(std::count(rows.begin(), rows.end(), '\n') > 2);
        CHECK(rows == read(in / "a/trajectory.csv"));
    }
    CHECK(runs == accepted);
}

TEST_CASE("the texts of the built-in models have the name first, ordered keys and the shortest exact numbers",
          "[studies][command line]")
{
    const std::vector<std::string> order = {"hilda_model", "name",   "note",        "gravity", "end",
                                            "redundant",   "bodies", "constraints", "forces",  "contacts"};
    for (const std::string& name : all_names()) {
        CAPTURE(name);
        const std::string text = studies::problem(name).model;
        const io::JsonSource model(text, name);
        CHECK(*model.root.member("name")->value.string() == name);
        size_t last = 0;
        for (const io::Json::Member& member : *model.root.members()) {
            CAPTURE(member.key);
            const auto at = std::find(order.begin(), order.end(), member.key);
            REQUIRE(at != order.end());
            CHECK(static_cast<size_t>(at - order.begin()) >= last);
            last = static_cast<size_t>(at - order.begin());
        }
        for (const char* list : {"bodies", "constraints", "contacts"})
            if (const io::Json::Member* entries = model.root.member(list))
                for (const io::Json& entry : *entries->value.list())
                    CHECK(entry.members()->front().key == "name");
        const std::vector<std::string> numbers = numbers_of(text);
        CHECK(numbers.size() > 8);
        for (const std::string& number : numbers)
            if (significant_digits(number) > significant_digits(io::shortest(std::stod(number))))
                FAIL_CHECK(number << " is longer than " << io::shortest(std::stod(number)));
        CHECK_THAT(text, !Contains("\r") && !Contains("\t"));
    }
}

TEST_CASE("hilda models writes one model to a file or folder, and all models to a folder",
          "[studies][command line]")
{
    const Scratch in;
    const Ended shown = call(in, {"models", "double_pendulum"});
    CHECK(shown.code == 0);
    CHECK(call(in, {"models", "double_pendulum", "--write", "mine.json"}).code == 0);
    CHECK(read(in / "mine.json") == shown.out);
    fs::create_directory(in / "folder");
    CHECK(call(in, {"models", "double_pendulum", "--write", "folder"}).code == 0);
    CHECK(read(in / "folder/double_pendulum.json") == shown.out);

    const Ended all = call(in, {"models", "--write", "new/all"});
    CHECK(all.code == 0);
    CHECK(all.out == "written " + std::to_string(studies::problems().size()) + " models to new/all\n");
    for (const studies::Problem& p : studies::problems())
        CHECK(call(in, {"models", p.name}).out == read(in / ("new/all/" + p.name + ".json")));

    const Ended file = call(in, {"models", "--write", "mine.json"});
    CHECK(file.code == 2);
    CHECK_THAT(
        file.err,
        Contains("--write without NAME writes all models to a folder; 'mine.json' is the name of a file"));
    CHECK(read(in / "mine.json") == shown.out);
    CHECK(call(in, {"models", "--write", "/dev/null/x"}).code == 5);

    // a model that was changed is not replaced
    const std::string changed = read(in / "new/all/slider_crank.json") + "\n";
    write(in / "new/all/slider_crank.json", changed);
    fs::remove(in / "new/all/andrews_squeezer.json");
    const std::string message =
        "new/all/slider_crank.json exists and is another model; remove it, or choose another name";
    check_refused(in, {"models", "--write", "new/all"}, 2, message);
    check_refused(in, {"models", "slider_crank", "--write", "new/all"}, 2, message);
    CHECK(read(in / "new/all/slider_crank.json") == changed);
    CHECK(call(in, {"models", "four_link", "--write", "new/all"}).code == 0);
}
