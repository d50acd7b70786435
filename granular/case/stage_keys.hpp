// SPDX-License-Identifier: GPL-3.0-or-later
/// The entries of `stages`: parts of a run with changes of the case at their starts.

#pragma once

#include "granular/case/selection.hpp"

#include <optional>
#include <string>
#include <vector>

namespace hilda::granular {

/// The particles are at rest. All bounds that are given must be met.
struct RestCondition {
    std::optional<double> kinetic_energy;  ///< largest kinetic energy over the number of particles [J]
    std::optional<double> share;           ///< largest kinetic energy over the largest one of the stage
    double from = 0;      ///< time after the start of the stage from which it is evaluated [s]
    double interval = 0;  ///< between evaluations [s]
};

struct StageSpec {
    std::string name;
    std::optional<double> duration;                     ///< largest one [s]
    std::optional<double> end;                          ///< largest time of the run [s]
    std::optional<RestCondition> until;                 ///< ends the stage earlier
    bool fails = false;                                 ///< the run fails if the condition is not met in time
    std::vector<std::pair<std::string, io::Json>> set;  ///< pointers and new values
    /// Names of groups and the particles that are assigned to them at the start, one after the other
    std::vector<std::pair<std::string, std::vector<Selection>>> groups;
    std::vector<Selection> remove;  ///< particles that are removed at the start, after `groups`
};

/// Reads an entry of `stages` of a case with a step h [s]. Throws io::PlacedError.
StageSpec read_stage(ObjectReader& o, double h);

}  // namespace hilda::granular
