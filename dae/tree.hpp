// SPDX-License-Identifier: GPL-3.0-or-later
/// Recognises the joints of a model whose constraints form a tree.

#pragma once

#include "lie/state.hpp"
#include "lie/tree/tree.hpp"

namespace hilda::dae {

class Model;

/// The tree of the joints of a model in the consistent state x, which determines the directions of axes and
/// the orientations that fixed and translational joints keep. A body without a joint to the ground or to a
/// body before it is free.
///
/// The rows between two bodies must be those of one revolute, translational, spherical or fixed joint,
/// however they are named in the model: the rows CD, DP1 and DP2 are compared. Otherwise, and for closed
/// loops, drivers, other constraints and removed rows, the result is the reason.
lie::Tree find_tree(const Model& model, const lie::State& x);

}  // namespace hilda::dae
