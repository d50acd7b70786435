// SPDX-License-Identifier: GPL-3.0-or-later
/// Counts heap allocations. The functions below replace malloc, calloc and realloc. A test program that
/// includes this file in one of its sources counts all allocations, including those of operator new and of
/// KLU.
#pragma once

#include <atomic>
#include <cstdlib>
#include <new>

namespace hilda::tests {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HILDA_SANITIZED
inline constexpr bool counts_allocations = false;  ///< a sanitizer replaces malloc itself
#else
inline constexpr bool counts_allocations = true;
#endif

inline std::atomic<long> allocations{0}, allocated_bytes{0};

/// Number of allocations during f()
template <class F>
long allocations_during(F&& f)
{
    const long before = allocations.load();
    f();
    return allocations.load() - before;
}

}  // namespace hilda::tests

#ifndef HILDA_SANITIZED
extern "C" void* __libc_malloc(std::size_t);
extern "C" void* __libc_realloc(void*, std::size_t);
extern "C" void* __libc_calloc(std::size_t, std::size_t);

extern "C" __attribute__((weak)) void* malloc(std::size_t size)
{
    ++hilda::tests::allocations;
    hilda::tests::allocated_bytes += static_cast<long>(size);
    return __libc_malloc(size);
}
extern "C" __attribute__((weak)) void* realloc(void* p, std::size_t size)
{
    ++hilda::tests::allocations;
    hilda::tests::allocated_bytes += static_cast<long>(size);
    return __libc_realloc(p, size);
}
extern "C" __attribute__((weak)) void* calloc(std::size_t n, std::size_t size)
{
    ++hilda::tests::allocations;
    hilda::tests::allocated_bytes += static_cast<long>(n * size);
    return __libc_calloc(n, size);
}
#endif
