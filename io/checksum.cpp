// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/checksum.hpp"

#include <cstring>

namespace hilda::io {

std::uint64_t checksum(const char* bytes, std::size_t count)
{
    std::uint64_t h = 0xcbf29ce484222325u;
    const auto take = [&](std::uint64_t w) { h = (h ^ w) * 0x100000001b3u, h ^= h >> 29; };
    for (; count >= 8; bytes += 8, count -= 8) {
        std::uint64_t w = 0;
        std::memcpy(&w, bytes, 8);
        take(w);
    }
    for (; count > 0; ++bytes, --count) take(static_cast<unsigned char>(*bytes));
    return h;
}

}  // namespace hilda::io
