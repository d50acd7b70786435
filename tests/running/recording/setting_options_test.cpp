// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/recording/setting_options.hpp"

#include "io/error.hpp"
#include "lie/schemes.hpp"
#include "tests/support/program/program.hpp"

#include <catch2/catch.hpp>

#include <map>
#include <set>

using namespace hilda;
using namespace hilda::tests;
using Catch::Matchers::Contains;
using run::setting_options;

namespace {

/// A value of each option that is not its default. A new option needs one here.
const std::map<std::string, std::string> other = {{"--tolerance", "1e-11"},   {"--max-iterations", "29"},
                                                  {"--linear-solver", "klu"}, {"--rho-infinity", "0.5"},
                                                  {"--reparametrise", ""},    {"--rtol", "1e-08"},
                                                  {"--atol", "1e-07"},        {"--max-step", "0.05"}};

}  // namespace

TEST_CASE("each setting is written as its option takes it, and is recorded unless it has its default value",
          "[run][settings]")
{
    REQUIRE(other.size() == setting_options().size());
    const lie::Settings defaults;
    for (const run::SettingOption& option : setting_options()) {
        CAPTURE(option.name);
        CHECK(option.is_default(defaults));
        lie::Settings settings;
        option.set(settings, option.name, other.at(option.name));
        CHECK_FALSE(option.is_default(settings));
        CHECK(option.text(settings) == other.at(option.name));
        CHECK(run::settings_json(settings).member(option.key()) != nullptr);
        int users = 0;
        for (const lie::Scheme& listed : lie::schemes())
            for (const lie::Scheme* scheme : {&listed, &listed.with_adaptive_steps()}) {
                CAPTURE(scheme->name);
                const bool uses = scheme->uses_option(option.name);
                users += uses;
                CHECK(run::given_settings(defaults, *scheme).empty());
                CHECK(run::given_settings(settings, *scheme) ==
                      (uses ? run::RunSettings{{option.name, other.at(option.name)}} : run::RunSettings()));
                CHECK((run::settings_json(settings, scheme).member(option.key()) != nullptr) == uses);
            }
        CHECK(users > 0);
    }
    // Checkpoints of version 0.2.0 have some settings with their default values.
    CHECK(run::with_defaults({{"--tolerance", "1e-10"}, {"--linear-solver", "klu"}}) ==
          run::with_defaults({{"--linear-solver", "klu"}, {"--max-iterations", "30"}}));
    CHECK(run::with_defaults({{"--linear-solver", "klu"}}) != run::with_defaults({}));
}

TEST_CASE(
    "every setting is in the help, in summary.json and study.json, and in the identity of a run and of "
    "shards",
    "[run][settings]")
{
    const Scratch in;
    const std::string help_of_run = call(in, {"help", "run"}).out,
                      help_of_fit = call(in, {"help", "fit"}).out;
    REQUIRE(call(in, {"run", "double_pendulum", "--end", "0.1", "--output", "fixed"}).code == 0);
    REQUIRE(call(in, {"run", "double_pendulum", "--integrator", "rA-dop853", "--end", "0.1", "--output",
                      "adaptive"})
                .code == 0);
    const std::string fixed = read(in / "fixed/summary.json"), adaptive = read(in / "adaptive/summary.json");
    const std::vector<std::string> study = {"study", "energy",  "--problem", "double_pendulum", "--end",
                                            "0.1",   "--steps", "1e-2,5e-3", "--quiet",         "--no-plot"};
    REQUIRE(call(in, with(study, {"--shard", "1/2", "--output", "s1"})).code == 0);
    for (const run::SettingOption& option : setting_options()) {
        CAPTURE(option.name);
        CHECK_THAT(help_of_run, Contains(option.name));
        CHECK_THAT(help_of_fit, Contains(option.name));
        const bool of_fixed = lie::scheme("rA-half-1-momentum").uses_option(option.name),
                   of_adaptive = lie::scheme("rA-dop853").with_adaptive_steps().uses_option(option.name);
        CHECK((fixed.find('"' + option.key() + '"') != std::string::npos) == of_fixed);
        CHECK((adaptive.find('"' + option.key() + '"') != std::string::npos) == of_adaptive);
        std::vector<std::string> given = {option.name};
        if (!option.is_switch()) given.push_back(other.at(option.name));
        // A resumed run with another value, unless no run with this integrator takes the option
        const bool is_adaptive = of_adaptive && !of_fixed, refused_here = !of_adaptive && !of_fixed;
        const Ended resumed = call(
            in,
            with(is_adaptive ? std::vector<std::string>{"run", "double_pendulum", "--integrator", "rA-dop853",
                                                        "--end", "0.2", "--resume", "--output", "adaptive"}
                             : std::vector<std::string>{"run", "double_pendulum", "--end", "0.2", "--resume",
                                                        "--output", "fixed"},
                 given));
        CHECK(resumed.code == 2);
        CHECK_THAT(resumed.err, Contains(refused_here ? option.name : "belongs to another run"));
        if (is_adaptive || refused_here) continue;  // the study has a fixed step and rA schemes
        fs::remove_all(in / "s2");
        REQUIRE(call(in, with(with(study, {"--shard", "2/2", "--output", "s2"}), given)).code == 0);
        const Ended collected = call(in, {"collect", "s1", "s2", "--output", "all", "--no-plot"});
        CHECK(collected.code == 2);
        CHECK_THAT(collected.err, Contains("the shards differ in " + option.name));
    }
}

TEST_CASE("the options that a scheme uses are in the table", "[run][settings]")
{
    std::set<std::string> known;
    for (const run::SettingOption& option : setting_options()) known.insert(option.name);
    for (const lie::Scheme& scheme : lie::schemes())
        for (const lie::Scheme* form : {&scheme, &scheme.with_adaptive_steps()})
            for (const std::string& option : form->option_names()) {
                CAPTURE(form->name, option);
                CHECK(known.contains(option));
                CHECK_NOTHROW(run::refuse_unused_settings("run", {option}, {form}));
            }
    for (const std::string& option : known)
        CHECK_THROWS_AS(run::refuse_unused_settings("run", {option}, {}), io::UsageError);
}
