// SPDX-License-Identifier: GPL-3.0-or-later
// Tests of the registry: order, search, and entries with equal names.
#include "io/registry.hpp"

#include <catch2/catch.hpp>

namespace {

struct Fruit {
    std::string name;
    int seeds = 0;
};
using Fruits = hilda::io::Registry<Fruit>;

// Registered in this order by static initialisation.
const bool pear = Fruits::add({.name = "pear", .seeds = 10});
const bool apple = Fruits::add({.name = "apple", .seeds = 5});

}  // namespace

TEST_CASE("registered entries are sorted by name and found by name", "[io]")
{
    CHECK(apple);
    CHECK(pear);
    CHECK(Fruits::names() == std::vector<std::string>{"apple", "pear"});
    REQUIRE(Fruits::find("pear") != nullptr);
    CHECK(Fruits::find("pear")->seeds == 10);
    CHECK(Fruits::find("plum") == nullptr);
    CHECK(&Fruits::all()[0] == Fruits::find("apple"));
}

TEST_CASE("a name is registered once", "[io]")
{
    CHECK_THROWS_AS(Fruits::add({.name = "apple", .seeds = 1}), std::logic_error);
    CHECK(Fruits::all().size() == 2);
    CHECK(Fruits::find("apple")->seeds == 5);
}
