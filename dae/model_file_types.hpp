// SPDX-License-Identifier: GPL-3.0-or-later
/// The types of constraints and forces of the model file, and the keys of each. A new type is one more entry
/// in the .cpp. Contacts are read by the room that knows them, above this one, which enrols its reader here.

#pragma once

#include "dae/model.hpp"
#include "dae/object_reader.hpp"

namespace hilda::dae {

/// "DP1", "revolute", ...
const std::vector<std::string>& constraint_types();

/// Reads the keys of one of these types between the bodies i and j; x is the start. Throws PlacedError, and
/// without a place lie::InvalidInput or ExpressionError for what the joint itself refuses.
Blocks read_constraint(const std::string& type, ObjectReader& o, int i, int j, const State& x);

/// The types of forces between two bodies: "spring-damper", ...
const std::vector<std::string>& pair_force_types();

std::unique_ptr<Force> read_pair_force(const std::string& type, ObjectReader& o, int i, int j,
                                       const State& x);

/// Between whom a contact is: its name, two different bodies, the model with all its bodies and joints and the contacts
/// before this one, and the start
struct ContactPair {
    const std::string& name;
    int i, j;
    Model& model;
    const State& start;
};

/// Reads the keys of an element of "contacts" but for name, body_i and body_j, and adds what it is to the model: forces,
/// constraints with unknowns, under its name. Throws PlacedError, and without a place lie::InvalidInput or
/// ExpressionError for what the contact itself refuses.
using ReadContact = void (*)(ObjectReader& o, const ContactPair& pair);

/// Makes this the reader of contacts; there is one at most, the last, and none after a nullptr. Called while
/// the program starts: const bool enrolled = enrol_contacts(...);
bool register_contact_reader(ReadContact read);
ReadContact contact_reader();

}  // namespace hilda::dae
