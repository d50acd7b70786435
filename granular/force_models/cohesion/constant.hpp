// SPDX-License-Identifier: GPL-3.0-or-later
/// Attraction of constant size while bodies touch.                                            Fang (2022), Sec. 6.2

#pragma once

#include "granular/core/contact_point.hpp"

namespace hilda::granular {

/// F_c, however deep they overlap
struct ConstantCohesion {
    static constexpr const char* name = "constant";

    float F_c = 0;  ///< [N]

    template <class R>
    HILDA_HD R operator()(const ContactPoint<R>&) const
    {
        return R(F_c);
    }
    template <class Keys>
    static ConstantCohesion read(Keys& keys)
    {
        return {.F_c = keys.not_negative("F_c")};
    }
};

}  // namespace hilda::granular
