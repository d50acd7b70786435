// SPDX-License-Identifier: GPL-3.0-or-later
/// A granular case in JSON.

#pragma once

#include "granular/motion.hpp"

namespace hilda::granular {

/// What a case file says, ready to run
struct Case {
    std::string name;
    std::unique_ptr<World> world;
    double h = 0, end = 0, every = 0;  ///< step, end, and time between outputs [s]
    double anew = 0;                   ///< time between the steps at which a checkpoint may be written [s]
    std::vector<std::string> boundaries;
    std::vector<std::string> notices;  ///< what was mended on the way
    std::string text;                  ///< of the file
};

/// What a case meets in the program that reads it
struct Surroundings {
    std::size_t memory = std::numeric_limits<std::size_t>::max();  ///< that there is [bytes]
    Compile compile = {};                                          ///< of formulas; none: they are refused
    Device device = {};
};

/// InvalidCase, with line, column and JSON pointer of what is wrong; DeviceError. Nothing large is allocated before it is
/// known that the memory will do.
Case read_case(const std::string& text, const std::string& file, const Surroundings& surroundings = {});

}  // namespace hilda::granular
