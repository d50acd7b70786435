// SPDX-License-Identifier: GPL-3.0-or-later
/// Particles and contacts of a world for its fields.

#pragma once

#include "granular/fields/field_sums.hpp"
#include "granular/world/groups.hpp"
#include "granular/world/world.hpp"

namespace hilda::granular {

/// The free particles of a replica at t and their contacts. Fixed particles and those attached to boundaries
/// are parts of the boundaries: they have no density, and a contact with one of them is a contact with a
/// boundary at the point on its surface. With `groups` the particles outside of the group with this number
/// are such parts as well. A clump is one point with its mass at the centre of mass.
FieldInput field_input(const World& world, const std::vector<ContactRecord>& contacts, int replica,
                       const Groups* groups = nullptr, int group = Groups::none);

}  // namespace hilda::granular
