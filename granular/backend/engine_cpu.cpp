// SPDX-License-Identifier: GPL-3.0-or-later
// Creation of an engine, and the neighbour search on the CPU.
#include "granular/backend/engine_impl.hpp"
#include "granular/core/neighbours/neighbours_impl.hpp"

namespace hilda::granular {

template class Neighbours<par::Cpu>;

std::unique_ptr<Engine> make_engine(Device device)
{
    if (device.kind == Device::cuda) return make_gpu_engine(device.number);
    if (device.source != nullptr) return device.source->make();
    return std::make_unique<EngineOn<par::Cpu>>();
}

}  // namespace hilda::granular
