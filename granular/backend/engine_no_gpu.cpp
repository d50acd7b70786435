// SPDX-License-Identifier: GPL-3.0-or-later
// Replaces engine_gpu.cu in a build without CUDA.
#include "granular/backend/engine.hpp"

namespace hilda::granular {

namespace {

constexpr const char* no_cuda =
    "the program is built without CUDA; use the device cpu, or rebuild with nvcc in PATH";

}

std::unique_ptr<Engine> make_gpu_engine(int) { throw DeviceError(no_cuda); }

std::size_t gpu_memory(int) { throw DeviceError(no_cuda); }

std::vector<std::string> gpus(std::string& why_not)
{
    why_not = "the program is built without CUDA";
    return {};
}

}  // namespace hilda::granular
