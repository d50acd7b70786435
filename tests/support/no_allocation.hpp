// SPDX-License-Identifier: GPL-3.0-or-later
/// Counts what the program takes from the heap. The counters replace malloc and operator new, so the one test
/// program that includes this file in one of its sources counts everything in it, KLU included.
#pragma once

#include <atomic>
#include <cstdlib>
#include <new>

namespace hilda::tests {

inline std::atomic<long> allocations{0};

/// Allocations while f runs
template <class F>
long allocations_during(F&& f)
{
    const long before = allocations.load();
    f();
    return allocations.load() - before;
}

}  // namespace hilda::tests

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
// A sanitizer owns malloc; what goes through operator new is counted all the same.
void* operator new(std::size_t size)
{
    ++hilda::tests::allocations;
    if (void* p = std::malloc(size == 0 ? 1 : size)) return p;
    throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
#else
extern "C" void* __libc_malloc(std::size_t);
extern "C" void* __libc_realloc(void*, std::size_t);
extern "C" void* __libc_calloc(std::size_t, std::size_t);

extern "C" void* malloc(std::size_t size)
{
    ++hilda::tests::allocations;
    return __libc_malloc(size);
}
extern "C" void* realloc(void* p, std::size_t size)
{
    ++hilda::tests::allocations;
    return __libc_realloc(p, size);
}
extern "C" void* calloc(std::size_t n, std::size_t size)
{
    ++hilda::tests::allocations;
    return __libc_calloc(n, size);
}
#endif
