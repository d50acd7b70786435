// SPDX-License-Identifier: GPL-3.0-or-later
// Creation of an engine
#include "granular/backend/engine_impl.hpp"

namespace hilda::granular {

std::unique_ptr<Engine> make_engine(Device device)
{
    if (device.kind == Device::cuda) return make_gpu_engine(device.number);
    if (device.source != nullptr) return device.source->make();
    return std::make_unique<EngineOn<par::Cpu>>();
}

}  // namespace hilda::granular
