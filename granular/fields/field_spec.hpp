// SPDX-License-Identifier: GPL-3.0-or-later
/// A field output of a case.

#pragma once

#include "granular/fields/cell_weights.hpp"

#include <string>

namespace hilda::granular {

struct FieldSpec {
    std::string name;
    FieldGrid grid;
    Kernel kernel;
    double interval = 0;  ///< time between rows [s]
    /// Number of instants of a row: the mean over equally spaced instants up to its time, or with 1 that
    /// instant
    long samples = 1;
    int replica = 0;         ///< whose particles it has
    std::string group = "";  ///< whose particles it has; empty: all
};

}  // namespace hilda::granular
