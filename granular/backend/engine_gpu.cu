// SPDX-License-Identifier: GPL-3.0-or-later
// The engine of a GPU: the functors of the CPU, with one thread per particle or pair.
#include "granular/backend/par_gpu.cuh"

#include "granular/backend/engine_impl.hpp"
#include "granular/core/loops.hpp"
#include "granular/core/neighbours/neighbours_impl.hpp"

namespace hilda::granular {

void device_failed(const std::string& what) { throw DeviceError(what); }

std::vector<std::string> gpus(std::string& why_not)
{
    int count = 0;
    const cudaError_t code = cudaGetDeviceCount(&count);
    // Without a driver the runtime reports a driver that is older than itself, of version 0.
    int driver = 0;
    if (code == cudaErrorInsufficientDriver && cudaDriverGetVersion(&driver) == cudaSuccess && driver == 0) {
        why_not = "no NVIDIA driver is loaded";
        return {};
    }
    if (code != cudaSuccess) {
        why_not = cudaGetErrorString(code);
        return {};
    }
    std::vector<std::string> names;
    for (int k = 0; k < count; ++k) {
        cudaDeviceProp properties{};
        par::check(cudaGetDeviceProperties(&properties, k), "query of the GPU properties");
        names.emplace_back(properties.name);
    }
    if (names.empty()) why_not = "no GPU was found";
    return names;
}

namespace {

void select_device(int number)
{
    std::string reason;
    const std::vector<std::string> names = gpus(reason);
    if (names.empty()) throw DeviceError("no GPU is available: " + reason);
    if (number < 0 || number >= static_cast<int>(names.size()))
        throw DeviceError("GPU number must be from 0 to " + std::to_string(names.size() - 1) + ", got " +
                          std::to_string(number));
    constexpr int least = 8;  // lowest compute capability that the program is compiled for
    int major = 0;
    par::check(cudaDeviceGetAttribute(&major, cudaDevAttrComputeCapabilityMajor, number),
               "query of the compute capability of a GPU");
    if (major < least)
        throw DeviceError("GPU " + std::to_string(number) + " (" + names[static_cast<std::size_t>(number)] +
                          "): the compute capability must be at least " + std::to_string(least) + ".0, got " +
                          std::to_string(major));
    static int selected = number;
    if (number != selected)
        throw DeviceError("GPU " + std::to_string(number) +
                          " cannot be used: this process already uses GPU " + std::to_string(selected));
    par::check(cudaSetDevice(number), "selection of a GPU");
}

}  // namespace

std::size_t gpu_memory(int number)
{
    select_device(number);
    std::size_t free = 0, total = 0;
    par::check(cudaMemGetInfo(&free, &total), "query of the free memory of a GPU");
    return free;
}

std::unique_ptr<Engine> make_gpu_engine(int number)
{
    select_device(number);
    return std::make_unique<EngineOn<par::Gpu>>();
}

}  // namespace hilda::granular
