// SPDX-License-Identifier: GPL-3.0-or-later
// Groups of particles: assignments in comparison with a list of the group of each id.
#include "granular/world/groups.hpp"

#include <catch2/catch.hpp>

#include <random>

using hilda::granular::Groups;

TEST_CASE("particles are in the group to which they were added or assigned last", "[granular][world]")
{
    std::mt19937 random(5);
    const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
    for (int repetition = 0; repetition < 200; ++repetition) {
        Groups groups;
        for (const char* name : {"a", "b", "c"}) groups.number(name);
        std::vector<int> expected;
        const auto check = [&] {
            for (std::uint32_t id = 0; id < expected.size(); ++id) CHECK(groups.of(id) == expected[id]);
        };
        for (int change = 0; change < 10; ++change) {
            const int group = static_cast<int>(below(4)) - 1;  // also none
            if (below(2) == 0) {
                groups.add(static_cast<std::uint32_t>(expected.size()), group);
                expected.resize(expected.size() + 1 + below(5), group);
            } else {
                std::vector<std::uint32_t> ids;
                const std::uint32_t one_in = 1 + below(4);
                for (std::uint32_t id = 0; id < expected.size(); ++id)
                    if (below(one_in) == 0) ids.push_back(id), expected[id] = group;
                groups.assign(ids, group);
            }
            check();
        }
    }
}
