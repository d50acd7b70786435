// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/program/device_name.hpp"

#include "io/option_values.hpp"

namespace hilda::granular {

std::optional<Device> device_named(const std::string& name)
{
    if (name == "cpu") return Device{};
    if (name == "cuda") return Device{.kind = Device::cuda};
    const auto number = io::number_in<int>(name.starts_with("cuda:") ? name.substr(5) : "");
    if (number && *number >= 0) return Device{.kind = Device::cuda, .number = *number};
    return {};
}

}  // namespace hilda::granular
