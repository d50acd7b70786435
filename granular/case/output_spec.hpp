// SPDX-License-Identifier: GPL-3.0-or-later
/// The outputs that a case requests.

#pragma once

#include "granular/fields/field_spec.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace hilda::granular {

/// Number of steps h in a time between outputs or of a stage [s], at least 1
inline long steps_in(double time, double h) { return std::max(1L, std::lround(std::min(time / h, 9e15))); }

/// Lists of contacts, and their network in the frames
struct ContactSpec {
    double interval = 0;             ///< time between lists [s]; 0: none
    std::vector<double> times = {};  ///< of further lists [s]
    bool network = false;            ///< whether the frames have the contacts

    bool has_lists() const { return interval > 0 || !times.empty(); }
};

/// Means of the loads on boundaries over time
struct LoadSpec {
    double interval = 0;  ///< time of a mean [s]
    long samples = 1;     ///< equally spaced instants in it
};

struct OutputSpecs {
    std::vector<FieldSpec> fields = {};
    std::optional<ContactSpec> contacts = {};
    std::optional<LoadSpec> loads = {};

    /// Whether an output has a list of all contacts at an instant, in memory
    bool lists_contacts() const { return !fields.empty() || contacts; }
};

}  // namespace hilda::granular
