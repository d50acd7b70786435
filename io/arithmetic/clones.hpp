// SPDX-License-Identifier: GPL-3.0-or-later
/// Functions that are compiled for several instruction sets.

#pragma once

// HILDA_CLONES("avx2", "default") compiles the function that follows for these instruction sets, and the
// program takes the version that its processor can run. The versions give the same bits, because no product
// is fused with a sum. Not with sanitizers, whose start is later than this choice, and not where the whole
// program is compiled for AVX2.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__AVX2__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define HILDA_CLONES(...) __attribute__((target_clones(__VA_ARGS__)))
#else
#define HILDA_CLONES(...)
#endif
