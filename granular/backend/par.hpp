// SPDX-License-Identifier: GPL-3.0-or-later
/// Parallel primitives for the CPU, with OpenMP and Thrust; par_gpu.cuh implements them with CUDA.
///
/// A functor is a struct with raw pointers and `HILDA_HD void operator()(std::uint32_t) const`. The results
/// of all primitives are independent of the number of threads: sorts are stable, and floating-point numbers
/// are not summed.

#pragma once

#include "granular/backend/real.hpp"

#include <cstddef>
#include <cstdint>
#include <utility>

namespace hilda::granular::par {

/// Tag of the CPU back end. A back end overloads the functions below for its tag.
struct Cpu {};

void* allocate(Cpu, std::size_t bytes);  ///< aligned to 64 bytes; throws std::bad_alloc
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

inline void wait(Cpu) {}  ///< waits until all work of the device is finished

/// An array in the memory of a back end. resize() does not preserve the content when the capacity grows.
template <class Backend, class T>
class Array {
public:
    Array() = default;
    explicit Array(std::size_t n) { resize(n); }
    Array(Array&& o) noexcept : first(o.first), count(o.count), capacity(o.capacity)
    {
        o.first = nullptr, o.count = o.capacity = 0;
    }
    Array& operator=(Array&& o) noexcept
    {
        std::swap(first, o.first), std::swap(count, o.count), std::swap(capacity, o.capacity);
        return *this;
    }
    Array(const Array&) = delete;
    Array& operator=(const Array&) = delete;
    ~Array() { release(Backend(), first); }

    void resize(std::size_t n)
    {
        if (n > capacity) {
            release(Backend(), first);
            first = nullptr, count = capacity = 0;
            const std::size_t new_capacity = n + n / 32;
            first = static_cast<T*>(allocate(Backend(), new_capacity * sizeof(T)));
            capacity = new_capacity;
        }
        count = n;
    }
    std::size_t size() const { return count; }
    std::size_t bytes() const { return capacity * sizeof(T); }
    T* data() const { return first; }

private:
    T* first = nullptr;
    std::size_t count = 0, capacity = 0;
};

// The functions below return after their work on the CPU is finished.

/// Calls f(k) for k = 0 … n - 1. Up to `serial_below` calls run on one thread, where starting threads costs
/// more.
template <class Functor>
void for_each(Cpu, std::size_t n, const Functor& f, std::size_t serial_below = 2048)
{
#pragma omp parallel for schedule(static) if (n > serial_below)
    for (std::ptrdiff_t k = 0; k < static_cast<std::ptrdiff_t>(n); ++k) f(static_cast<std::uint32_t>(k));
}

/// The maximum; NaN if one of the arguments is NaN
HILDA_HD inline float nan_max(float a, float b) { return a != a || b <= a ? a : b; }
#pragma omp declare reduction(nanmax:float : omp_out = nan_max(omp_out, omp_in)) initializer(omp_priv = 0)

/// Maximum of 0 and f(k), k = 0 … n - 1; NaN if one of them is NaN. Up to `serial_below` calls run on one
/// thread.
template <class Functor>
float largest(Cpu, std::size_t n, const Functor& f, std::size_t serial_below = 2048)
{
    float maximum = 0;
#pragma omp parallel for schedule(static) reduction(nanmax : maximum) if (n > serial_below)
    for (std::ptrdiff_t k = 0; k < static_cast<std::ptrdiff_t>(n); ++k)
        maximum = nan_max(maximum, f(static_cast<std::uint32_t>(k)));
    return maximum;
}

/// Prefix sums: out[0] = 0, out[k + 1] = out[k] + in[k], n + 1 numbers. Returns out[n].
std::uint64_t exclusive_scan(Cpu, const std::uint32_t* in, std::uint32_t* out, std::size_t n);
/// Sorts keys and values by key. Only the lowest `bits` bits of the keys are significant.
void stable_sort_by_key(Cpu, std::uint32_t* keys, std::uint32_t* values, std::size_t n, int bits);

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
    const std::uint32_t* index;
    HILDA_HD void operator()(std::uint32_t k) const { to[k] = from[index[k]]; }
};
/// to[k] = value
template <class Backend, class T>
void fill(Backend b, T* to, std::size_t n, T value)
{
    for_each(b, n, FillWith<T>{to, value});
}
/// to[k] = from[index[k]]
template <class Backend, class T>
void gather(Backend b, T* to, const T* from, const std::uint32_t* index, std::size_t n)
{
    for_each(b, n, GatherFrom<T>{to, from, index});
}

}  // namespace hilda::granular::par
