// SPDX-License-Identifier: GPL-3.0-or-later
/// The walls of a square bin for piles of bodies.

#pragma once

#include <fmt/format.h>

#include <string>

namespace hilda::studies {

/// The contacts of all bodies with the planes of a bin, from 0 to `width` [m] in x and y and with the floor
/// z = 0, each with a comma in front. `surface`: that of the bodies, `laws`: the keys of the contact laws
inline std::string walls_of_bin(const std::string& surface, const std::string& laws, double width)
{
    std::string contacts;
    const auto wall = [&](const char* name, double x, double y, const char* normal) {
        contacts += fmt::format(
            R"(, {{"name": "{}", "body_i": "all", "body_j": "ground", "surface_i": {}, "surface_j": )"
            R"({{"type": "plane", "position": [{}, {}, 0], "normal": [{}]}}, {}}})",
            name, surface, x, y, normal, laws);
    };
    wall("floor", 0, 0, "0, 0, 1");
    wall("left", 0, 0, "1, 0, 0"), wall("right", width, 0, "-1, 0, 0");
    wall("front", 0, 0, "0, 1, 0"), wall("back", 0, width, "0, -1, 0");
    return contacts;
}

}  // namespace hilda::studies
