// SPDX-License-Identifier: GPL-3.0-or-later
/// How bodies lie: Euler parameters, which are kept where a world is asked for them. Spheres do not feel them.

#pragma once

#include "granular/real.hpp"

namespace hilda::granular {

/// e0 = cos(chi/2), e = sin(chi/2) a of the turn by chi about a that takes the frame of the body to the global one
template <class R>
struct EulerParameters {
    R e0;
    Vec<R> e;
};

/// What a turn by a rotation vector [rad], in the global frame, adds to p: (exp(angle/2) - 1) ⊗ p, by series that are exact
/// in single precision up to a radian; and what brings p back to the length of one.
template <class R>
HILDA_HD inline EulerParameters<R> turn_by(const Vec<R>& angle, const EulerParameters<R>& p)
{
    const auto c = [](double constant) { return R(static_cast<Number<R>>(constant)); };
    const Vec<R> half = c(0.5) * angle;
    const R q = half.dot(half);
    const R sine = c(1) - q * (c(1. / 6) - q * (c(1. / 120) - q * c(1. / 5040)));  // over the half angle
    const R cosine = -(q * (c(0.5) - q * (c(1. / 24) - q * c(1. / 720))));         // less one
    const R back = c(0.5) * (c(1) - (p.e0 * p.e0 + p.e.dot(p.e)));
    const Vec<R> s = sine * half;
    return {(cosine + back) * p.e0 - s.dot(p.e), (cosine + back) * p.e + p.e0 * s + s.cross(p.e)};
}

}  // namespace hilda::granular
