// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/nearest.hpp"

#include <catch2/catch.hpp>

using namespace hilda;

TEST_CASE("the nearest word is at most two edits away", "[io][nearest]")
{
    const std::vector<std::string> keys{"mass", "inertia", "r_dot", "r", "omega"};
    CHECK(io::nearest("mas", keys) == "mass");
    CHECK(io::nearest("Mass", keys) == "mass");
    CHECK(io::nearest("inretia", keys) == "inertia");
    CHECK(io::nearest("rdot", keys) == "r_dot");
    CHECK(io::nearest("omegas", keys) == "omega");
    CHECK(io::nearest("q", keys).empty());
    CHECK(io::nearest("", keys).empty());
    CHECK(io::nearest("moss_i", keys).empty());
    CHECK(io::nearest(std::string(100000, 'a'), keys).empty());
    CHECK(io::edit_distance("kitten", "sitting") == 3);
    CHECK(io::edit_distance("sni", "sin") == 1);
}
