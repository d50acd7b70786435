// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surfaces/foot.hpp"

#include "contact/surface_types.hpp"

namespace hilda::contact {

namespace {

const bool registered = register_surface(
    {.name = "foot",
     .read = [](dae::ObjectReader&) -> std::shared_ptr<const Surface> { return std::make_shared<Foot>(); },
     .z = "normal"});

}  // namespace

}  // namespace hilda::contact
