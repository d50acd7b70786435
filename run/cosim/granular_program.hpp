// SPDX-License-Identifier: GPL-3.0-or-later
/// The command hilda granular, which starts the separate program hilda-granular. The programs are separate
/// because hilda links GSL and a GPU build of hilda-granular links the CUDA runtime; their licences do not
/// permit both in one binary.

#pragma once

#include <string>
#include <vector>

namespace hilda::run {

/// Path of hilda-granular, which must be in the directory of this program. Empty if that is not known.
std::string granular_program();

/// Replaces this process by hilda-granular, which must be in the same directory. Returns only by the
/// exception io::NotAvailable, if the program cannot be started.
int start_granular(const std::vector<std::string>& arguments);

}  // namespace hilda::run
