// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surfaces/plane.hpp"

#include "contact/surface_types.hpp"

namespace hilda::contact {

namespace {

const bool registered = register_surface(
    {.name = "plane",
     .read = [](dae::ObjectReader&) -> std::shared_ptr<const Surface> { return std::make_shared<Plane>(); },
     .z = "normal"});

}  // namespace

}  // namespace hilda::contact
