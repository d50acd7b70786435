// SPDX-License-Identifier: GPL-3.0-or-later
/// No rolling resistance.

#pragma once

#include "granular/core/contact_point.hpp"

namespace hilda::granular {

struct NoRolling {
    static constexpr const char* name = "none";
    static constexpr const char* description = "No rolling resistance.";

    template <class R>
    HILDA_HD Vec<R> operator()(const ContactPoint<R>&, const NormalForce<R>&, R, History<R>&) const
    {
        return {R(0.f), R(0.f), R(0.f)};
    }
    template <class Keys>
    static NoRolling read(Keys&)
    {
        return {};
    }
};

}  // namespace hilda::granular
