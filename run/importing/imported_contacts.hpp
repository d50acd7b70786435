// SPDX-License-Identifier: GPL-3.0-or-later
/// Rigid contacts between the collision shapes of an imported model.

#pragma once

#include "io/json.hpp"
#include "run/importing/imported_model.hpp"

namespace hilda::run {

/// The list "contacts" of the model file: those of each two shapes of different bodies that
///
///     may touch by their masks, and are not excluded (ImportedModel::without_contact),
///     are not neighbours in the tree: a joint other than a free one connects their bodies,
///     do not overlap at the start,
///     have a detector of rigid contacts.
///
/// `bodies`: after welding, in the places of ImportedModel::bodies. `owners`: the body to which each is
/// welded, -1 for the ground. Shapes that are equal in the frames of several bodies have one entry for all of
/// their pairs, unless a pair is left out. Adds a warning for each pair that is left out because it overlaps
/// and for each kind of pair without a detector, and sets ImportedModel::contact_pairs.
///
/// Throws io::InvalidInput "FILE: ..." for more than 10000 entries.
io::Json imported_contacts(ImportedModel& model, const std::vector<ImportedBody>& bodies,
                           const std::vector<int>& owners, const std::string& file);

}  // namespace hilda::run
