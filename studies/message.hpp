// SPDX-License-Identifier: GPL-3.0-or-later
/// Lines on stderr.

#pragma once

#include <cstdio>
#include <string>

namespace hilda::studies {

/// Writes a text to stderr. Where nobody listens (a closed stderr, a full disk behind it) it is lost, and
/// that is no error: fmt::print would throw.
inline void message(const std::string& text) noexcept
{
    std::fputs(text.c_str(), stderr);
    std::fflush(stderr);
}

inline void warning(const std::string& what) { message("hilda: warning: " + what + '\n'); }

}  // namespace hilda::studies
