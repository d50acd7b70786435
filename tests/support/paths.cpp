// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/paths.hpp"

namespace hilda::tests {

const char* const source_dir = HILDA_SOURCE_DIR;
const char* const test_data = HILDA_SOURCE_DIR "/tests/data";
const char* const hilda_program = HILDA_PROGRAM;
const char* const hilda_ending_program = HILDA_ENDING_PROGRAM;

}  // namespace hilda::tests
