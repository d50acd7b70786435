// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "contact/friction/friction.hpp"

#include <memory>

namespace hilda::tests {

/// The friction law of Fang (2022) for sliding, rolling and spinning
inline std::shared_ptr<const contact::FrictionModel> slide_roll_spin(const contact::FrictionParameters& p)
{
    return contact::friction_law("slide-roll-spin").make(p);
}

}  // namespace hilda::tests
