// SPDX-License-Identifier: GPL-3.0-or-later
/// The program hilda-granular, which is a program of its own: where it is built for a GPU it links CUDA, and this one
/// links GSL.

#pragma once

#include <string>
#include <vector>

namespace hilda::studies {

/// Becomes that program, which lies beside this one. NotAvailable where it does not.
int start_granular(const std::vector<std::string>& arguments);

}  // namespace hilda::studies
