// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "studies/framework/study.hpp"

namespace hilda::studies {

/// The study of the order of the schemes; returns the exit code. Writes study.csv, study.json and a figure
/// for each problem into options.output.
int convergence(const StudyOptions& options);

}  // namespace hilda::studies
