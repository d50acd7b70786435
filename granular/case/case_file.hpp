// SPDX-License-Identifier: GPL-3.0-or-later
/// A granular case in JSON.

#pragma once

#include "granular/case_text.hpp"

#include <optional>

namespace hilda::granular {

/// What a case file says, ready to run
struct Case {
    CaseText source;
    std::string name = {};
    std::unique_ptr<World> world = {};
    double h = 0, end = 0, every = 0;  ///< step, end, and time between rows [s]
    double frames_every = 0;           ///< time between frames [s]
    double anew = 0;                   ///< time between the steps at which a checkpoint may be written [s]
    std::vector<std::string> boundaries = {};
    std::vector<std::string> notices = {};  ///< what was mended on the way
    std::string files_read = {};            ///< checksums of other files that it is made of
    /// Ids of the first particles of entries, and their JSON pointers
    std::vector<std::pair<std::uint32_t, std::string>> entries = {};
};

/// What a case meets in the program that reads it
struct Environment {
    static constexpr std::size_t any = std::numeric_limits<std::size_t>::max();

    std::size_t memory = any, device_memory = any;  ///< that there is [bytes]
    Compile compile = {};                           ///< of formulas; none: they are refused
    Device device = {};
    std::vector<Setting> settings = {};      ///< in their order
    std::optional<std::uint64_t> seed = {};  ///< of the first fill; the others have the numbers that follow
};

/// InvalidCase, with line, column and JSON pointer of what is wrong; DeviceError. Nothing large is allocated before it is
/// known that the memory will do.
Case read_case(const std::string& text, const std::string& file, const Environment& environment = {});

/// Takes the particles into their cells. InvalidCase, with the entry of what cannot begin so
void settle(const Case& c);

}  // namespace hilda::granular
