// SPDX-License-Identifier: GPL-3.0-or-later
/// The keys that several kinds of entries of a case share: material, group, replica and attached_to.

#pragma once

#include "granular/core/material.hpp"
#include "granular/reading/object_reader.hpp"
#include "granular/world/groups.hpp"

namespace hilda::granular {

struct Case;

/// Each function throws io::PlacedError.
struct EntryKeys {
    std::vector<Material> materials;
    Groups groups;
    std::string free;        ///< pointer of the first boundary with a mass; empty if there is none
    bool has_fixed = false;  ///< whether a particle is fixed by its entry

    /// The number of the material of an entry. A single material is the default. `more`: a further sentence
    /// of the description
    int material(ObjectReader& o, const std::string& more = "") const;
    /// Fails at the key if the name cannot be that of a group.
    static void check_group_name(const ObjectReader& o, const char* key, const std::string& name);
    /// The number of the group of an entry, or Groups::none
    int group(ObjectReader& o);
    std::uint16_t replica(ObjectReader& o) const;
    /// The number of the boundary that the key attached_to names, or -1
    static int attached_to(ObjectReader& o, const Case& c);
};

}  // namespace hilda::granular
