// SPDX-License-Identifier: GPL-3.0-or-later
/// The kinds of types of a contact in the schema of model files.

#pragma once

#include "io/schema/type_schema.hpp"

namespace hilda::contact {

inline const io::TypeKind surface_kind = {"Surface", "type", "Type of the surface."};
inline const io::TypeKind normal_kind = {"Normal law", "type", "Type of the normal law."};
inline const io::TypeKind friction_kind = {"Friction law", "law", "Name of the friction law."};

/// Adds the selection among the registered surfaces and laws to the definitions of the schema.
void add_contacts(io::Json& definitions);

}  // namespace hilda::contact
