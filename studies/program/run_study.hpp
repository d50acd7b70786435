// SPDX-License-Identifier: GPL-3.0-or-later
/// hilda study KIND: finds the study and gives it a directory.

#pragma once

#include "studies/framework/study.hpp"

#include <string>

namespace hilda::studies {

/// Runs the study of that kind; returns its exit code. Its directory is out/KIND, or options.output, and must
/// be empty unless options.force. With options.json and no output it writes no files.
int run_study(const std::string& kind, StudyOptions options);

}  // namespace hilda::studies
