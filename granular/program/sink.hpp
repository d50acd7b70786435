// SPDX-License-Identifier: GPL-3.0-or-later
/// Sinks of a run of a case. A new output format is one file in granular/program.

#pragma once

#include "granular/case/case_file.hpp"
#include "io/sink.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

/// What the sinks of a run are made from. The references outlive the sinks.
struct CaseSetup {
    using Node = World;

    const Case& c;
    const std::string& directory;
    const io::SinkOptions& options;

    /// Number of steps in a time between outputs [s], at least 1
    long steps_in(double time) const { return std::max(1L, std::lround(std::min(time / c.h, 9e15))); }
};

using Sink = io::Sink<World>;
using SinkType = io::SinkType<CaseSetup>;

}  // namespace hilda::granular
