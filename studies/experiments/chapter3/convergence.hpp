// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "studies/framework/study.hpp"

namespace hilda::studies {

/// Runs the convergence study (Fang 2022, Figs. 3.4, 3.6-3.8) and returns the exit code.
///
/// Writes study.csv, study.json and figures into options.output. The default selection has one figure for the
/// positions and one for the constraint loads; any other selection has one figure for each problem.
int convergence(const StudyOptions& options);

}  // namespace hilda::studies
