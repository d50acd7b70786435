// SPDX-License-Identifier: GPL-3.0-or-later
/// The pairs of bodies of an element of "contacts" of a model file.

#pragma once

#include "dae/model_types.hpp"

namespace hilda::contact {

/// One pair, or the pairs of a group:
///
///     "bodies": "all" or a list of bodies, "surface"              each two of them, with the same surface
///     "body_i", "body_j": a body, a list of bodies, or "all"      each of body_i with each of body_j
///
/// "all" denotes all bodies with mass, unless it is the name of a body.
struct ContactPairs {
    static constexpr std::size_t most = 100000;  ///< largest number of pairs of a group

    std::vector<std::pair<int, int>> pairs;  ///< of different bodies; each pair once
    bool is_group = false;                   ///< whether the pairs are given by a list or by "all"
    std::string surface_i = "surface_i", surface_j = "surface_j";  ///< keys of the surfaces
};

/// Names the definition of an element of "contacts" for the schema.
void define_contact(dae::ObjectReader& o);

/// Reads the keys body_i and body_j, or bodies. `count` is the number of bodies with mass. Throws
/// io::PlacedError for unknown and repeated bodies and for a group without a pair.
ContactPairs read_contact_pairs(dae::ObjectReader& o, const dae::BodyFinder& bodies, int count);

}  // namespace hilda::contact
