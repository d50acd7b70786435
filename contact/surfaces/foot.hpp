// SPDX-License-Identifier: GPL-3.0-or-later
/// The flat face of a body that slides without tipping.

#pragma once

#include "contact/surfaces/plane.hpp"

namespace hilda::contact {

/// A plane that touches at the origin of its frame and nowhere else: all of its load acts there.
/// A brick on an incline is a foot on a plane. Put the origin where the resultant of the true pressure acts;
/// what that pressure does to hold the brick flat is not modelled.
class Foot final : public Flat {
public:
    std::string name() const override { return "foot"; }
};

}  // namespace hilda::contact
