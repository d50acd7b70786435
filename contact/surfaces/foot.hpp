// SPDX-License-Identifier: GPL-3.0-or-later
/// A point contact that represents the flat face of a sliding body.

#pragma once

#include "contact/surfaces/plane.hpp"

namespace hilda::contact {

/// A plane whose contact point is always the origin of its frame; the whole contact force acts there.
/// Example: a brick on an incline. Place the origin where the resultant of the contact pressure acts. The
/// restoring moment of the pressure against tipping is not modelled.
class Foot final : public Flat {
public:
    std::string name() const override { return "foot"; }
    bool is_smooth() const override { return false; }
    PolygonMesh drawing(const DrawingExtent& extent) const override;
};

}  // namespace hilda::contact
