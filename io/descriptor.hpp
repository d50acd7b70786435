// SPDX-License-Identifier: GPL-3.0-or-later
/// Whole reads and writes on file descriptors, which the system may divide or interrupt.

#pragma once

#include <cstddef>

namespace hilda::io {

/// Writes `count` bytes and returns the number of written ones: all, or fewer after an error, which is in
/// errno.
std::size_t write_all(int descriptor, const void* bytes, std::size_t count);
/// Reads `count` bytes and returns the number of read ones: all, or fewer at the end of the file, where errno
/// is 0, or after an error, which is in errno.
std::size_t read_all(int descriptor, void* bytes, std::size_t count);

}  // namespace hilda::io
