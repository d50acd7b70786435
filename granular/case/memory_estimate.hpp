// SPDX-License-Identifier: GPL-3.0-or-later
/// Estimate of the memory that a case requires.

#pragma once

#include "granular/case/case_file.hpp"
#include "granular/case/particles/fill.hpp"

namespace hilda::granular {

/// What the memory of a case depends on, besides its options, fills and outputs
struct CaseSize {
    double particles = 0;                    ///< that are in the world already
    const Insertions* insertions = nullptr;  ///< or nullptr
    double end = 0;                          ///< of the run [s]
    double diameter = 0;                     ///< largest one of the particles that are not in fills [m]
    bool rotation_laws = false;              ///< whether a law has rolling or spin
};

/// Compares an estimate of the required memory with the available memory. Throws io::PlacedError.
void check_memory(const io::JsonSource& source, const CaseSize& size, const WorldOptions& o,
                  const std::vector<FillSpec>& fills, const OutputSpecs& outputs,
                  const Environment& available);

}  // namespace hilda::granular
