// SPDX-License-Identifier: GPL-3.0-or-later
/// Which constraint rows say nothing new.

#pragma once

#include "dae/model.hpp"

namespace hilda::dae {

/// The rows that add less than `tolerance` to those before them, as numbers into model.active_rows(). In the
/// metric of the mass, so that the answer does not depend on units. A contact among them has a force that is not
/// determined: it is handed over in x, and lie::NumericalFailure "contact_rank" tells of those that cannot be.
std::vector<int> dependent_rows(const Model& model, State& x, double tolerance);

}  // namespace hilda::dae
