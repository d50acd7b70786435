// SPDX-License-Identifier: GPL-3.0-or-later
/// Types of constraints and forces of the model file: a reader and a schema for each.
///
/// The file of a type registers it by a constant with static initialisation:
///
///     const bool registered = io::Registry<ConstraintType>::add({.name = "spherical", ...});

#pragma once

#include "dae/block.hpp"
#include "dae/object_reader.hpp"
#include "io/expression.hpp"
#include "io/registry.hpp"
#include "io/schema/type_schema.hpp"

#include <array>
#include <set>
#include <string>
#include <utility>
#include <variant>

namespace hilda::dae {

using io::TypeSchema;

class Driver;
class Force;
class Model;
struct Description;

/// Finds bodies of the model by the name or id that a key gives. Throws io::PlacedError for an unknown body.
class BodyFinder {
public:
    virtual ~BodyFinder() = default;
    /// Number of the body whose name or id is given by a key
    virtual int body(ObjectReader& o, std::string_view key, const About& about = {}) const = 0;
    /// The same for an element of the list under a key
    virtual int body_of_list(ObjectReader& o, std::string_view key, std::size_t element) const = 0;
    /// Number of the body with this name, or nothing
    virtual std::optional<int> named(const std::string& name) const = 0;
    /// body_i and body_j, which must differ
    virtual std::pair<int, int> pair(ObjectReader& o) const = 0;
};

/// A type of constraint between two bodies: a joint, a driver or a basic constraint
struct ConstraintType {
    /// The rows of a joint, or a general constraint
    using Constraints = std::variant<Blocks, std::unique_ptr<Constraint>>;

    std::string name;  ///< value of the key "type"
    TypeSchema schema;
    /// Reads the keys of the type. x holds the initial data. Throws PlacedError, or lie::InvalidInput or
    /// io::ExpressionError without a location from the constructor of the constraint.
    ///
    /// The order of the calls of the reader is the order of the keys in the canonical form.
    Constraints (*read)(ObjectReader& o, int i, int j, const State& x);
};

/// A type of force
struct ForceType {
    std::string name;  ///< value of the key "type"
    TypeSchema schema;
    /// Reads the keys of the type, including those of the bodies. Throws as ConstraintType::read.
    std::unique_ptr<Force> (*read)(ObjectReader& o, const BodyFinder& bodies, const State& x);
};

}  // namespace hilda::dae

extern template class hilda::io::Registry<hilda::dae::ConstraintType>;
extern template class hilda::io::Registry<hilda::dae::ForceType>;

namespace hilda::dae {

/// The name of a registered type for another usual name of the same joint or force, such as "translational"
/// for "prismatic"; "" if there is none
std::string type_with_other_name(const std::string& name);

/// The function f(t) given by a key. f, ḟ and f̈ must be finite at t = 0.
Driver read_driver(ObjectReader& o, std::string_view key, const About& about,
                   const std::optional<std::string>& fallback = {});
/// f(t) of a basic constraint, from the key "f". The keys f_dot and f_ddot of the published files are
/// accepted.
Driver read_value(ObjectReader& o, const About& about, const std::optional<std::string>& fallback = {});

/// Points P and Q of the two bodies in the body frames [m], by default the centres of mass
struct Points {
    Vec3 i, j;
    explicit Points(ObjectReader& o);
};

/// Axes of the two bodies in the body frames, not zero
struct Axes {
    Vec3 i, j;
    explicit Axes(ObjectReader& o);
};

/// A list of one block
template <class B>
Blocks single_row(B block)
{
    Blocks rows;
    rows.push_back(std::make_unique<B>(std::move(block)));
    return rows;
}

/// Of an element of a list
inline constexpr About about_name = {
    .text =
        "Name in messages and results; it must be unique within its list. By default "
        "the type and the position in the list, counted from 1, for example "
        "revolute-2 (for a contact: contact-2).",
    .example = R"("crank-pin")",
    .computed = true};
/// The key "name" of an element of a list. The default consists of the kind and the number in the list.
/// PlacedError for a name that is among those that are used.
std::string unique_name(ObjectReader& o, const std::string& kind, std::set<std::string>& used,
                        const About& about = about_name);

/// A model file of which the bodies, joints and forces have been read
struct PartialModel {
    const JsonSource& source;
    const BodyFinder& bodies;
    Description& out;
    const std::string& normal_rows;  ///< argument of read_model()
};

/// Reads the key "contacts" of the model, and adds its forces and general constraints with their places.
using ReadContacts = void (*)(ObjectReader& model, const PartialModel& to);

/// Registers the reader of contacts and returns true. It replaces the earlier one; nullptr removes it. Called
/// during static initialisation: const bool registered = register_contact_reader(...);
bool register_contact_reader(ReadContacts read);
/// The registered reader of contacts, or nullptr
ReadContacts contact_reader();

}  // namespace hilda::dae
