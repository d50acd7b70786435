// SPDX-License-Identifier: GPL-3.0-or-later
/// Types of constraints and forces in the model file, and the keys of each type.
///
/// A new type is a new entry in the tables of the .cpp file. Contacts are read by the library `contact`,
/// which depends on this one and registers its reader here.

#pragma once

#include "dae/block.hpp"
#include "dae/object_reader.hpp"

namespace hilda::dae {

class Force;
class Model;

/// Names of the constraint types: "DP1", "revolute", ...
const std::vector<std::string>& constraint_types();

/// Reads the keys of a constraint of this type between the bodies i and j. x holds the initial data. Throws
/// PlacedError, or lie::InvalidInput or io::ExpressionError without a location from the constructor of the
/// constraint.
Blocks read_constraint(const std::string& type, ObjectReader& o, int i, int j, const State& x);

/// Names of the types of forces between two bodies: "spring-damper", ...
const std::vector<std::string>& pair_force_types();

/// Reads the keys of a force of this type, as read_constraint() does.
std::unique_ptr<Force> read_pair_force(const std::string& type, ObjectReader& o, int i, int j,
                                       const State& x);

/// Arguments of the reader of a contact: its name, its two different bodies, the model with all bodies,
/// joints, forces and the preceding contacts, and the initial data
struct ContactPair {
    const std::string& name;
    int i, j;
    Model& model;
    const State& start;
};

/// Reads an element of "contacts", except for the keys name, body_i and body_j, and adds its forces and
/// general constraints to the model. Throws PlacedError, or lie::InvalidInput or io::ExpressionError without a
/// location from the constructor of the contact.
using ReadContact = void (*)(ObjectReader& o, const ContactPair& pair);

/// Registers the reader of contacts and returns true. It replaces the earlier one; nullptr removes it. Called
/// during static initialisation: const bool registered = register_contact_reader(...);
bool register_contact_reader(ReadContact read);
/// The registered reader of contacts, or nullptr
ReadContact contact_reader();

}  // namespace hilda::dae
