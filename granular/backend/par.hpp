// SPDX-License-Identifier: GPL-3.0-or-later
/// Parallel primitives for the CPU, with threads and Thrust; par_gpu.cuh implements them with CUDA.
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

constexpr int most_parts = 128;  ///< of a loop
/// Number of parts of a loop: omp_get_max_threads(), at most most_parts
int threads_of_loops();
/// Calls part(context, p) for p = 0 … parts - 1 on up to `parts` threads; see thread_team.cpp. Throws the
/// first exception of a part, when all are done.
void run_parts(int parts, void (*part)(const void* context, int p), const void* context);

/// Calls part(begin, end, p) for parts p of 0 … n - 1 that are of the same size. Up to `serial_below` numbers
/// are one part, where threads cost more.
template <class Part>
void divide(std::size_t n, std::size_t serial_below, const Part& part)
{
    const std::size_t threads = n > serial_below ? static_cast<std::size_t>(threads_of_loops()) : 1,
                      parts = threads < n ? threads : n;
    if (parts <= 1) return part(std::size_t{0}, n, 0);
    const auto one = [&](int p) {
        const auto k = static_cast<std::size_t>(p);
        part(n * k / parts, n * (k + 1) / parts, p);
    };
    using One = decltype(one);
    run_parts(
        static_cast<int>(parts), [](const void* of, int p) { (*static_cast<const One*>(of))(p); }, &one);
}

/// Calls f(k) for k = 0 … n - 1. Up to `serial_below` calls run on one thread.
template <class Functor>
void for_each(Cpu, std::size_t n, const Functor& f, std::size_t serial_below = 2048)
{
    divide(n, serial_below, [&](std::size_t begin, std::size_t end, int) {
        for (std::size_t k = begin; k < end; ++k) f(static_cast<std::uint32_t>(k));
    });
}

/// The maximum; NaN if one of the arguments is NaN
HILDA_HD inline float nan_max(float a, float b) { return a != a || b <= a ? a : b; }

/// Maximum of 0 and f(k), k = 0 … n - 1; NaN if one of them is NaN. Up to `serial_below` calls run on one
/// thread.
template <class Functor>
float largest(Cpu, std::size_t n, const Functor& f, std::size_t serial_below = 2048)
{
    float of_part[most_parts] = {};
    divide(n, serial_below, [&](std::size_t begin, std::size_t end, int p) {
        float maximum = 0;
        for (std::size_t k = begin; k < end; ++k)
            maximum = nan_max(maximum, f(static_cast<std::uint32_t>(k)));
        of_part[p] = maximum;
    });
    float maximum = 0;
    for (const float m : of_part) maximum = nan_max(maximum, m);
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
