// SPDX-License-Identifier: GPL-3.0-or-later
/// The pairs of bodies of an element of "contacts" of a model file.

#pragma once

#include "dae/model_types.hpp"
#include "lie/system.hpp"

namespace hilda::contact {

/// One pair, or the pairs of a group:
///
///     "bodies": "all" or a list of bodies, "surface"              each two of them, with the same surface
///     "body_i", "body_j": a body, a list of bodies, or "all"      each of body_i with each of body_j
///
/// "all" denotes all bodies with mass, unless it is the name of a body. A body does not touch itself, and
/// each pair is taken once. The pair of first[a] and second[b] has the number a · second.size() + b.
struct ContactPairs {
    /// Largest number of pairs of a group whose contacts are constraints or act at a distance
    static constexpr long most_listed = 100000;
    /// Largest number of bodies of a group: the number of a pair is an int
    static constexpr std::size_t most_bodies = 30000;

    std::vector<int> first, second;  ///< body numbers
    bool each_two = false;           ///< second is first, and only pairs with a < b count
    bool is_group = false;           ///< whether the pairs are given by a list or by "all"
    std::string surface_i = "surface_i", surface_j = "surface_j";  ///< keys of the surfaces

    /// Sets the places of the bodies. Call it once the lists are complete.
    void index();
    int numbers() const { return static_cast<int>(first.size() * second.size()); }
    int number(int a, int b) const { return a * static_cast<int>(second.size()) + b; }
    bool has(int a, int b) const;
    bool has(int number) const
    {
        const auto width = static_cast<int>(second.size());
        return has(number / width, number % width);
    }
    std::pair<int, int> pair(int number) const;  ///< body numbers
    long count() const;                          ///< number of pairs
    int first_number() const;                    ///< number of the first pair, -1 if there is none
    /// Place of a body in a list, -1 if it is not in it
    int place_in_first(int body) const { return place(places_in_first, body); }
    int place_in_second(int body) const { return place(places_in_second, body); }
    /// Name of a pair of the group `name`
    static std::string name_of_pair(const lie::System& model, const std::string& name, int i, int j);

private:
    static int place(const std::vector<int>& places, int body);

    std::vector<int> places_in_first, places_in_second;  ///< by body number plus 1
};

/// Names the definition of an element of "contacts" for the schema.
void define_contact(dae::ObjectReader& o);

/// Reads the keys body_i and body_j, or bodies. `count` is the number of bodies with mass. Throws
/// io::PlacedError for unknown and repeated bodies and for a group without a pair.
ContactPairs read_contact_pairs(dae::ObjectReader& o, const dae::BodyFinder& bodies, int count);

}  // namespace hilda::contact
