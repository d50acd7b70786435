// SPDX-License-Identifier: GPL-3.0-or-later
// The engine of a GPU: the same functors as on the CPU, a thread for each particle or pair.
#include "granular/backend/par_gpu.cuh"

#include "granular/backend/engine_impl.hpp"
#include "granular/core/loops.hpp"
#include "granular/core/neighbours_impl.hpp"

namespace hilda::granular {

void device_failed(const std::string& what) { throw DeviceError(what); }

std::vector<std::string> gpus(std::string& why_not)
{
    int count = 0;
    const cudaError_t code = cudaGetDeviceCount(&count);
    // no driver at all (35) and a driver without a device (100) are the same to a user
    if (code != cudaSuccess) {
        why_not = cudaGetErrorString(code);
        return {};
    }
    std::vector<std::string> names;
    for (int k = 0; k < count; ++k) {
        cudaDeviceProp properties{};
        par::check(cudaGetDeviceProperties(&properties, k), "the properties of a GPU");
        names.emplace_back(properties.name);
    }
    if (names.empty()) why_not = "there is none";
    return names;
}

namespace {

void choose(int number)
{
    std::string why;
    const std::vector<std::string> there = gpus(why);
    if (there.empty()) throw DeviceError("no GPU can be used: " + why);
    if (number < 0 || number >= static_cast<int>(there.size()))
        throw DeviceError("there is no GPU " + std::to_string(number) + ", only 0 to " +
                          std::to_string(there.size() - 1));
    constexpr int least = 8;  // of what this is compiled for
    int major = 0;
    par::check(cudaDeviceGetAttribute(&major, cudaDevAttrComputeCapabilityMajor, number),
               "what a GPU can do");
    if (major < least)
        throw DeviceError("GPU " + std::to_string(number) + ", " + there[static_cast<std::size_t>(number)] +
                          ", has compute capability " + std::to_string(major) + " and not " +
                          std::to_string(least));
    static int chosen = number;
    if (number != chosen)
        throw DeviceError("a process uses one GPU, and this one has used GPU " + std::to_string(chosen));
    par::check(cudaSetDevice(number), "the choice of a GPU");
}

}  // namespace

std::size_t gpu_memory(int number)
{
    choose(number);
    std::size_t free = 0, total = 0;
    par::check(cudaMemGetInfo(&free, &total), "the memory of a GPU");
    return free;
}

std::unique_ptr<Engine> make_gpu_engine(int number)
{
    choose(number);
    return std::make_unique<EngineOn<par::Gpu>>();
}

}  // namespace hilda::granular
