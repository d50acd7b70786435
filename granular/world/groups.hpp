// SPDX-License-Identifier: GPL-3.0-or-later
/// Groups of particles: the names that entries of `particles`, `fill` and `insert` give to their particles.

#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace hilda::io {
class Archive;
}

namespace hilda::granular {

class Groups {
public:
    static constexpr int none = -1;

    std::vector<std::string> names;  ///< in the order of their first entries

    /// The number of the group with this name, which is added if there is none
    int number(const std::string& name);
    /// The particles with ids from `first` on are in this group. The calls have ascending ids.
    void add(std::uint32_t first, int group);
    /// The particles with these ids, in ascending order, are in this group from now on.
    void assign(const std::vector<std::uint32_t>& ids, int group);
    int of(std::uint32_t id) const;  ///< number of a group, or none
    /// For checkpoints: insertions add particles during a run, and stages assign them to other groups.
    void transfer(io::Archive& a);

private:
    struct Run {
        std::uint32_t first;
        std::int32_t group;
    };
    std::vector<Run> runs;  ///< ordered by first; neighbours have different groups
};

}  // namespace hilda::granular
