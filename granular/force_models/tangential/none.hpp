// SPDX-License-Identifier: GPL-3.0-or-later
/// No friction.

#pragma once

#include "granular/core/contact_point.hpp"

namespace hilda::granular {

struct NoFriction {
    static constexpr const char* name = "none";
    static constexpr const char* description = "No tangential force.";

    template <class R>
    HILDA_HD Vec<R> operator()(const ContactPoint<R>&, const NormalForce<R>&, History<R>&) const
    {
        return {R(0.f), R(0.f), R(0.f)};
    }
    template <class Keys>
    static NoFriction read(Keys&)
    {
        return {};
    }
};

}  // namespace hilda::granular
