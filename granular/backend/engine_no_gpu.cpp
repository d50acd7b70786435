// SPDX-License-Identifier: GPL-3.0-or-later
// Where there is no CUDA to build with.
#include "granular/backend/engine.hpp"

namespace hilda::granular {

std::unique_ptr<Engine> make_gpu_engine(int) { throw DeviceError("this program was built without CUDA"); }

std::size_t gpu_memory(int) { throw DeviceError("this program was built without CUDA"); }

std::vector<std::string> gpus(std::string& why_not)
{
    why_not = "built without CUDA";
    return {};
}

}  // namespace hilda::granular
