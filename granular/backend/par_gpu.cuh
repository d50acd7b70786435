// SPDX-License-Identifier: GPL-3.0-or-later
// The primitives of par.hpp with CUDA. All work is issued to one stream. Functions that return a number wait
// for the device.
#pragma once

#include "granular/backend/par.hpp"

#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>

#include <string>

namespace hilda::granular {

/// Throws DeviceError after a CUDA call has failed.
[[noreturn]] void device_failed(const std::string& what);

namespace par {

/// Tag of the GPU back end
struct Gpu {};

/// Throws DeviceError if a CUDA call has failed; `operation` names it in the message.
inline void check(cudaError_t code, const char* operation)
{
    if (code == cudaSuccess) return;
    cudaGetLastError();  // resets the error, so that the next call does not report it again
    device_failed(std::string(operation) + ": " + cudaGetErrorString(code) + " (CUDA error " +
                  std::to_string(static_cast<int>(code)) + ')');
}

inline void* allocate(Gpu, std::size_t bytes)
{
    void* memory = nullptr;
    if (bytes > 0)
        check(cudaMalloc(&memory, bytes),
              ("allocation of " + std::to_string(bytes) + " bytes on the GPU").c_str());
    return memory;
}
inline void release(Gpu, void* memory) noexcept
{
    if (memory != nullptr) cudaFree(memory);  // fails only after an error that was reported
}
inline void copy_bytes(Gpu, void* to, const void* from, std::size_t bytes)
{
    if (bytes > 0) check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToDevice), "copy on the GPU");
}
inline void copy_to_host(Gpu, void* to, const void* from, std::size_t bytes)
{
    if (bytes > 0) check(cudaMemcpy(to, from, bytes, cudaMemcpyDeviceToHost), "copy from the GPU");
}
inline void copy_to_device(Gpu, void* to, const void* from, std::size_t bytes)
{
    if (bytes > 0) check(cudaMemcpy(to, from, bytes, cudaMemcpyHostToDevice), "copy to the GPU");
}

inline void wait(Gpu) { check(cudaDeviceSynchronize(), "synchronisation with the GPU"); }

/// Work memory of a function, reused by its next call
template <class Tag>
inline Array<Gpu, unsigned char>& scratch()
{
    // never released: the CUDA runtime ends before static objects are destroyed
    static auto* buffer = new Array<Gpu, unsigned char>;
    return *buffer;
}

constexpr unsigned block = 128;
inline unsigned blocks(std::size_t n) { return static_cast<unsigned>((n + block - 1) / block); }

template <class Functor>
__global__ void for_each_kernel(std::uint32_t n, Functor f)
{
    const std::uint32_t k = blockIdx.x * blockDim.x + threadIdx.x;
    if (k < n) f(k);
}
template <class Functor>
void for_each(Gpu, std::size_t n, const Functor& f, std::size_t /*serial_below*/ = 0)
{
    if (n == 0) return;
    for_each_kernel<<<blocks(n), block>>>(static_cast<std::uint32_t>(n), f);
    check(cudaGetLastError(), "loop on the GPU");
}

/// Maximum of non-negative floats by their bit patterns, which have the same order. The pattern of NaN is the
/// largest.
template <class Functor>
__global__ void largest_kernel(std::uint32_t n, Functor f, unsigned* maximum)
{
    const std::uint32_t k = blockIdx.x * blockDim.x + threadIdx.x;
    unsigned bits = k < n ? __float_as_uint(f(k)) & 0x7fffffffu : 0u;
    bits = __reduce_max_sync(0xffffffffu, bits);
    // The maximum only grows, so most warps need no atomic operation.
    if (threadIdx.x % 32 == 0 && bits > *static_cast<volatile unsigned*>(maximum)) atomicMax(maximum, bits);
}
struct LargestTag;
template <class Functor>
float largest(Gpu on, std::size_t n, const Functor& f)
{
    if (n == 0) return 0;
    auto& memory = scratch<LargestTag>();
    memory.resize(sizeof(float));
    check(cudaMemsetAsync(memory.data(), 0, sizeof(float)), "maximum on the GPU");
    largest_kernel<<<blocks(n), block>>>(static_cast<std::uint32_t>(n), f,
                                         reinterpret_cast<unsigned*>(memory.data()));
    check(cudaGetLastError(), "maximum on the GPU");
    static float* maximum = nullptr;  // pinned host memory, which the GPU writes directly
    if (maximum == nullptr) check(cudaMallocHost(&maximum, sizeof *maximum), "allocation of pinned memory");
    copy_to_host(on, maximum, memory.data(), sizeof *maximum);
    return *maximum;
}

struct ScanTag;
inline std::uint64_t exclusive_scan(Gpu on, const std::uint32_t* in, std::uint32_t* out, std::size_t n)
{
    check(cudaMemsetAsync(out, 0, sizeof *out), "prefix sum on the GPU");
    if (n == 0) return 0;
    const auto count = static_cast<std::int64_t>(n);
    std::size_t bytes = 0;
    check(cub::DeviceScan::InclusiveSum(nullptr, bytes, in, out + 1, count), "prefix sum on the GPU");
    auto& memory = scratch<ScanTag>();
    memory.resize(bytes);
    check(cub::DeviceScan::InclusiveSum(memory.data(), bytes, in, out + 1, count), "prefix sum on the GPU");
    std::uint32_t last = 0;
    copy_to_host(on, &last, out + n, sizeof last);
    return last;
}

struct SortTag;
struct SortedTag;
inline void stable_sort_by_key(Gpu on, std::uint32_t* keys, std::uint32_t* values, std::size_t n, int bits)
{
    if (n == 0) return;
    auto& sorted = scratch<SortedTag>();
    sorted.resize(n * (sizeof *keys + sizeof *values));
    auto* keys_out = reinterpret_cast<std::uint32_t*>(sorted.data());
    auto* values_out = keys_out + n;
    const auto count = static_cast<std::int64_t>(n);
    std::size_t size = 0;
    check(cub::DeviceRadixSort::SortPairs(nullptr, size, keys, keys_out, values, values_out, count, 0, bits),
          "sort on the GPU");
    auto& memory = scratch<SortTag>();
    memory.resize(size);
    check(cub::DeviceRadixSort::SortPairs(memory.data(), size, keys, keys_out, values, values_out, count, 0,
                                          bits),
          "sort on the GPU");
    copy_bytes(on, keys, keys_out, n * sizeof *keys);
    copy_bytes(on, values, values_out, n * sizeof *values);
}

}  // namespace par

}  // namespace hilda::granular
