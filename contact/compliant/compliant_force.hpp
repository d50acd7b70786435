// SPDX-License-Identifier: GPL-3.0-or-later
/// What all compliant contacts of a model have in common.

#pragma once

#include "lie/state.hpp"

namespace hilda::contact {

/// The overlap of two bodies with a compliant contact, for the checks of a run
class CompliantForce {
public:
    virtual ~CompliantForce() = default;

    /// Overlap at the last accepted node [m]; 0 while the surfaces are apart
    virtual double overlap(const lie::State& x) const = 0;
    /// CompliantContact::relative_overlap() at the last accepted node
    virtual double relative_overlap(const lie::State& x) const = 0;
};

}  // namespace hilda::contact
