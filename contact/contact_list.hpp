// SPDX-License-Identifier: GPL-3.0-or-later
/// The list "contacts" of a model file. Each element stands for one pair of bodies, or for a group of pairs.

#pragma once

#include "contact/contact_pairs.hpp"

#include <memory>
#include <string>
#include <vector>

namespace hilda::contact {

/// Arguments of the reader of a contact: its name, its two different bodies, the model with all bodies,
/// joints, forces and the preceding contacts, and the initial data
struct ContactPair {
    const std::string& name;
    int i, j;
    dae::Model& model;
    const lie::State& start;
    const std::string& normal_rows;  ///< argument of dae::read_model()
    std::vector<std::string>&
        changes;  ///< of dae::Description, for each contact to which normal_rows applies
    /// Keys of the surfaces of body i and j. A group of equal bodies has one key "surface" for both.
    std::string surface_i = "surface_i", surface_j = "surface_j";
    /// What the reader keeps from one pair of a group for the next, empty for the first pair
    std::shared_ptr<const void>& shared;
    /// The pairs of a large group, for its first pair: the reader may add all of them as a ContactGroup
    const ContactPairs* group = nullptr;
    const std::string& group_name;
};

/// A group with more pairs than this is read as a ContactGroup if its contacts are compliant.
constexpr long most_single_pairs = 30;

/// Reads an element of "contacts", except for the keys name, body_i, body_j and bodies, and adds the forces
/// and general constraints of one pair of bodies to the model. It is called for each pair of a group. Throws
/// PlacedError, or lie::InvalidInput or io::ExpressionError without a location from the constructor of the
/// contact.
/// Returns whether it has added all pairs of pair.group.
using ReadContact = bool (*)(dae::ObjectReader& o, const ContactPair& pair);

/// Reads the key "contacts" of a model file, and adds what `read` makes of its pairs.
void read_contacts(dae::ObjectReader& model, const dae::PartialModel& to, ReadContact read);

}  // namespace hilda::contact
