// SPDX-License-Identifier: GPL-3.0-or-later
/// Absolute paths of this checkout and this build.

#pragma once

namespace hilda::tests {

// Variables, not macros: the paths are then part of one object file, and ccache reuses all others in another
// clone.

extern const char* const source_dir;            ///< root of the source tree
extern const char* const test_data;             ///< tests/data
extern const char* const hilda_program;         ///< the program hilda
extern const char* const hilda_ending_program;  ///< the same with tests/support/end_at_write.cpp

}  // namespace hilda::tests
