// SPDX-License-Identifier: GPL-3.0-or-later
/// The few parallel primitives that everything else is made of: here on the CPU, with OpenMP and Thrust; par_gpu.cuh has
/// those of CUDA.
///
/// A functor is a struct with raw pointers and `HILDA_HD void operator()(std::uint32_t) const`. The results of all
/// primitives are the same for any number of threads: sorts are stable, and there are no sums of floats.

#pragma once

#include "granular/backend/real.hpp"

#include <cstddef>
#include <cstdint>
#include <utility>

namespace hilda::granular::par {

/// Where arrays live and loops run: what a back end overloads the functions below with
struct Cpu {};

void* allocate(Cpu, std::size_t bytes);  ///< aligned to 64 bytes; std::bad_alloc
void release(Cpu, void* memory) noexcept;
void copy_bytes(Cpu, void* to, const void* from, std::size_t bytes);
inline void copy_to_host(Cpu b, void* to, const void* from, std::size_t bytes)
{
    copy_bytes(b, to, from, bytes);
}
inline void copy_to_device(Cpu b, void* to, const void* from, std::size_t bytes)
{
    copy_bytes(b, to, from, bytes);
}

inline void wait(Cpu) {}  ///< until all that was begun is done

/// Memory of a back end. Growing does not keep what was in it.
template <class Backend, class T>
class Array {
public:
    Array() = default;
    explicit Array(std::size_t n) { resize(n); }
    Array(Array&& o) noexcept : first(o.first), count(o.count), room(o.room)
    {
        o.first = nullptr, o.count = o.room = 0;
    }
    Array& operator=(Array&& o) noexcept
    {
        std::swap(first, o.first), std::swap(count, o.count), std::swap(room, o.room);
        return *this;
    }
    Array(const Array&) = delete;
    Array& operator=(const Array&) = delete;
    ~Array() { release(Backend(), first); }

    void resize(std::size_t n)
    {
        if (n > room) {
            release(Backend(), first);
            first = nullptr, count = room = 0;
            const std::size_t wanted = n + n / 32;
            first = static_cast<T*>(allocate(Backend(), wanted * sizeof(T)));
            room = wanted;
        }
        count = n;
    }
    std::size_t size() const { return count; }
    std::size_t bytes() const { return room * sizeof(T); }
    T* data() const { return first; }

private:
    T* first = nullptr;
    std::size_t count = 0, room = 0;
};

// All of these are synchronous to the caller.
/// Fewer than `few` calls are not worth waking threads for.
template <class Functor>
void for_each(Cpu, std::size_t n, const Functor& f, std::size_t few = 2048)
{
#pragma omp parallel for schedule(static) if (n > few)
    for (std::ptrdiff_t k = 0; k < static_cast<std::ptrdiff_t>(n); ++k) f(static_cast<std::uint32_t>(k));
}

/// The larger one; what is not a number is larger than all numbers
HILDA_HD inline float worse(float a, float b) { return a != a || b <= a ? a : b; }
#pragma omp declare reduction(worst:float : omp_out = worse(omp_out, omp_in)) initializer(omp_priv = 0)

/// The largest f(k) of all k, at least 0; not a number where one of them is none. Fewer than `few` stay on one thread.
template <class Functor>
float largest(Cpu, std::size_t n, const Functor& f, std::size_t few = 2048)
{
    float most = 0;
#pragma omp parallel for schedule(static) reduction(worst : most) if (n > few)
    for (std::ptrdiff_t k = 0; k < static_cast<std::ptrdiff_t>(n); ++k)
        most = worse(most, f(static_cast<std::uint32_t>(k)));
    return most;
}

/// out[0] = 0, out[k + 1] = out[k] + in[k]: n + 1 numbers. Returns the last.
std::uint64_t exclusive_scan(Cpu, const std::uint32_t* in, std::uint32_t* out, std::size_t n);
/// Keys differ in their lowest `bits` alone.
void stable_sort_by_key(Cpu, std::uint64_t* keys, std::uint32_t* values, std::size_t n, int bits);

template <class T>
struct FillWith {
    T* to;
    T value;
    HILDA_HD void operator()(std::uint32_t k) const { to[k] = value; }
};
template <class T>
struct GatherFrom {
    T* to;
    const T* from;
    const std::uint32_t* where;
    HILDA_HD void operator()(std::uint32_t k) const { to[k] = from[where[k]]; }
};
template <class Backend, class T>
void fill(Backend b, T* to, std::size_t n, T value)
{
    for_each(b, n, FillWith<T>{to, value});
}
/// to[k] = from[where[k]]
template <class Backend, class T>
void gather(Backend b, T* to, const T* from, const std::uint32_t* where, std::size_t n)
{
    for_each(b, n, GatherFrom<T>{to, from, where});
}

}  // namespace hilda::granular::par
