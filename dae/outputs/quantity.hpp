// SPDX-License-Identifier: GPL-3.0-or-later
/// Names of the columns of the output.

#pragma once

#include <string>

namespace hilda::dae {

/// A scalar quantity for the output
struct Quantity {
    std::string name;           ///< of a force or an output without the name of the object
    std::string unit, meaning;  ///< meaning with frame and sign convention
};

}  // namespace hilda::dae
