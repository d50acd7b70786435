// SPDX-License-Identifier: GPL-3.0-or-later
/// Rank of the constraint rows: detection of redundant rows.

#pragma once

#include "lie/state.hpp"

#include <vector>

namespace hilda::dae {

class Model;
using lie::State;

/// Redundant rows in the state x, as indices into model.active_rows().
///
/// The rows C are scaled to length one in the metric of the mass, C diag(M, J̄)^{-1/2}, and factored by
/// SuiteSparseQR without reordering. A row is redundant if its component orthogonal to the preceding rows is
/// shorter than `tolerance`. Of two equal rows the later one is redundant; the rows of general constraints
/// other than contacts precede those of blocks, which alone are dropped. The scaling makes the result
/// independent of the units. Of J̄ the diagonal is used.
///
/// Algebraic variables are eliminated first, so that one row remains of a contact. If this row is redundant
/// the contact force is not determined. The contact then takes ContactConstraint::mode_if_redundant() in x.
/// Throws lie::NumericalFailure "contact_rank" with the names of such contacts if that mode is `active`, and
/// of general constraints that depend on each other; lie::SingularMatrix if SuiteSparseQR fails.
std::vector<int> dependent_rows(const Model& model, State& x, double tolerance);

}  // namespace hilda::dae
