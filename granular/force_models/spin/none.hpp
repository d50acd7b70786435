// SPDX-License-Identifier: GPL-3.0-or-later
/// No resistance to relative rotation about the contact normal.

#pragma once

#include "granular/core/contact_point.hpp"

namespace hilda::granular {

struct NoSpin {
    static constexpr const char* name = "none";
    static constexpr const char* description = "No spin resistance.";

    template <class R>
    HILDA_HD R operator()(const ContactPoint<R>&, const NormalForce<R>&, R, R, History<R>&) const
    {
        return R(0.f);
    }
    template <class Keys>
    static NoSpin read(Keys&)
    {
        return {};
    }
};

}  // namespace hilda::granular
