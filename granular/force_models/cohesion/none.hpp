// SPDX-License-Identifier: GPL-3.0-or-later
/// No attraction between bodies.

#pragma once

#include "granular/core/contact_point.hpp"

namespace hilda::granular {

struct NoCohesion {
    static constexpr const char* name = "none";
    static constexpr const char* description = "No cohesion.";

    template <class R>
    HILDA_HD R operator()(const ContactPoint<R>&) const
    {
        return R(0.f);
    }
    template <class R>
    HILDA_HD R energy(const ContactPoint<R>&) const
    {
        return R(0.f);
    }
    template <class Keys>
    static NoCohesion read(Keys&)
    {
        return {};
    }
};

}  // namespace hilda::granular
