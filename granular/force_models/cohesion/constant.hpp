// SPDX-License-Identifier: GPL-3.0-or-later
/// Constant attractive force while two bodies overlap.
///
/// Fang (2022), Ch. 6 (introduction), lists cohesion among the force models of Chrono::GPU and gives no
/// formula. Chrono::GPU uses a constant force, which it specifies as a multiple of the weight of a particle.

#pragma once

#include "granular/core/contact_point.hpp"

namespace hilda::granular {

///     F_c = const.,    independent of the overlap
struct ConstantCohesion {
    static constexpr const char* name = "constant";
    static constexpr const char* description =
        "Constant attractive force F_c while the bodies touch (Fang 2022, introduction of Ch. 6).";
    static constexpr const char* example = R"("F_c": 1e-6)";

    float F_c = 0;  ///< attraction [N]

    template <class R>
    HILDA_HD R operator()(const ContactPoint<R>&) const
    {
        return R(F_c);
    }
    /// Energy -F_c δ [J]
    template <class R>
    HILDA_HD R energy(const ContactPoint<R>& contact) const
    {
        return -F_c * contact.delta;
    }
    template <class Keys>
    static ConstantCohesion read(Keys& keys)
    {
        return {.F_c = keys.coefficient("F_c", "Force F_c [N].", 1e-6)};
    }
};

}  // namespace hilda::granular
