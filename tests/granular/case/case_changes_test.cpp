// SPDX-License-Identifier: GPL-3.0-or-later
/// Entries in which two cases differ, those that a run can change, and groups of particles.
#include "granular/stages/case_changes.hpp"
#include "granular/world/groups.hpp"
#include "io/archive.hpp"
#include "io/json_source.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::granular;

TEST_CASE("the entries in which two cases differ are found, and those that can change", "[granular][changes]")
{
    const io::JsonSource before(
        R"({"gravity": [0, 0, -9.81], "step": 1e-5, "laws": [{"mu": 0.3, "between": ["a", "b"]}],
        "boundaries": [{"r": [0, 0, 0], "v": [0, 0, 1]}, {"r": ["t", 0, 0], "radius": 1}], "insert": [{"rate": 3, "seed": 2}]})",
        "before");
    const auto changes = [&](const std::string& set, ChangeIn where = ChangeIn::resumed_run) {
        io::JsonSource now = before;
        now.set(set);
        std::string all;
        for (const CaseChange& change : changes_of(before.root, now.root))
            all +=
                (all.empty() ? "" : "; ") + change.text() + (change.is_possible(where) ? "" : ": impossible");
        return all;
    };
    CHECK(changes("/step=1e-5").empty());
    CHECK(changes("/gravity=[0,0,1]") == "/gravity was [0, 0, -9.81] and is [0, 0, 1] now");
    CHECK(changes("/name=x") == "/name was missing and is \"x\" now");
    CHECK(changes("/laws/0/mu=0.2") == "/laws/0/mu was 0.3 and is 0.2 now");
    CHECK(changes("/laws/0/rolling={\"law\": \"epsd\"}") ==
          "/laws/0/rolling was missing and is another value now");
    CHECK(changes("/laws/0/between=[\"b\",\"a\"]").ends_with(": impossible"));
    CHECK(changes("/step=2e-5") == "/step was 1e-05 and is 2e-05 now: impossible");
    // a place cannot change, a motion can
    CHECK(changes("/boundaries/0/r=[0,0,1]").ends_with(": impossible"));
    CHECK(changes("/boundaries/0/r=[0,0,\"t\"]") == "/boundaries/0/r was [0, 0, 0] and is [0, 0, \"t\"] now");
    CHECK(changes("/boundaries/1/r=[0,0,0]") == "/boundaries/1/r was [\"t\", 0, 0] and is [0, 0, 0] now");
    CHECK(changes("/boundaries/1/radius=2").ends_with(": impossible"));
    CHECK(changes("/boundaries=[]").ends_with(": impossible"));
    CHECK(changes("/insert/0/rate=4") == "/insert/0/rate was 3 and is 4 now");
    CHECK(changes("/insert/0/seed=4").ends_with(": impossible"));

    using enum ChangeIn;
    const std::tuple<const char*, bool, bool, bool> entries[] = {
        {"/name=x", true, true, false},
        {"/interval=3", true, true, false},
        {"/boundaries/0/note=x", true, true, true},
        {"/note=x", true, true, false},
        {"/gravity=[0,0,1]", true, false, true},
        {"/laws/0/mu=0.2", true, false, true},
        {"/insert/0/rate=4", true, false, true},
        {"/boundaries/0/F=[1,2,3]", true, false, true},
        {"/step=2e-5", false, false, false},
        {"/insert/0/seed=4", false, false, false}};
    for (const auto& [set, in_run, in_stages, in_stage] : entries) {
        INFO(set);
        CHECK(changes(set, resumed_run).ends_with(": impossible") == !in_run);
        CHECK(changes(set, resumed_stages).ends_with(": impossible") == !in_stages);
        CHECK(changes(set, stage).ends_with(": impossible") == !in_stage);
    }
    const std::string others =
        "gravity; r, v, omega, F and T of boundaries; the numbers of laws; and rate, mass_rate, to, v, "
        "random_v and active of insertions";
    CHECK(changeable_entries(resumed_run) == "a run can change name, note, end, interval and " + others);
    CHECK(changeable_entries(resumed_stages) == "a run with stages can change name, note, end and interval");
    CHECK(changeable_entries(stage) == "a stage can set " + others);
}

TEST_CASE("the group of a particle follows from its id, also after a checkpoint", "[granular][groups]")
{
    Groups groups;
    const int bed = groups.number("bed"), lid = groups.number("lid");
    CHECK(groups.number("bed") == bed);
    groups.add(0, Groups::none), groups.add(3, bed), groups.add(5, bed), groups.add(9, lid),
        groups.add(12, Groups::none);
    const auto check = [&](const Groups& of) {
        for (std::uint32_t id = 0; id < 20; ++id)
            CHECK(of.of(id) == (id < 3 ? Groups::none : id < 9 ? bed : id < 12 ? lid : Groups::none));
    };
    check(groups);
    io::Archive writes;
    groups.transfer(writes);
    const std::string bytes = writes.bytes();
    Groups again;
    again.names = groups.names;
    io::Archive reads(bytes, "file");
    again.transfer(reads);
    check(again);
    again.names = {"bed"};
    io::Archive other(bytes, "file");
    CHECK_THROWS_WITH(again.transfer(other), Catch::Contains("invalid group of particles, got 1 from id 9"));
}
