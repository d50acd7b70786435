// SPDX-License-Identifier: GPL-3.0-or-later
/// Checksum of the contents of a file.

#pragma once

#include <cstddef>
#include <cstdint>

namespace hilda::io {

/// 64-bit checksum: a variant of FNV-1a over words of eight bytes and the remaining single bytes, with an additional
/// shift
std::uint64_t checksum(const char* bytes, std::size_t count);

}  // namespace hilda::io
