// SPDX-License-Identifier: GPL-3.0-or-later
/// How bodies lie: Euler parameters, which are kept where a world is asked for them. Spheres do not feel them.

#pragma once

#include "granular/backend/real.hpp"

namespace hilda::granular {

/// p = (e0, e) with e0 = cos(chi/2), e = sin(chi/2) a, of the turn by chi about a that takes the frame of the body to the
/// global one                                                                                 Fang (2022), Sec. 2.1
template <class R>
struct EulerParameters {
    R e0;
    Vec<R> e;
};

/// What is to be added to p for p <- exp(angle/2) ⊗ p, where the angle is a rotation vector in the global frame [rad]: the
/// solution of p' = 1/2 omega ⊗ p with the mean omega of a step. For any angle in single precision; for double, series are
/// cut off at (|angle|/2)^14/14!. What comes out is longer by (1 - p·p)/2, Newton's step to the length of one.
template <class R>
HILDA_HD inline EulerParameters<R> turn_by(const Vec<R>& angle, const EulerParameters<R>& p)
{
    const auto c = [](double constant) { return R(static_cast<Number<R>>(constant)); };
    constexpr double whole = 2 * 3.14159265358979323846;
    // whole turns change nothing but the sign of p
    const R chi = angle.norm(), kept = chi - c(whole) * rint(chi * c(1 / whole));
    const Vec<R> half = (c(0.5) * select(chi > c(whole / 2), kept / chi, c(1))) * angle;
    const R q = half.dot(half);
    R sine = c(0), cosine = c(0);  // 1 - sin(|half|)/|half|, and (1 - cos(|half|))/q
    for (int k = 12; k >= 2; k -= 2) {
        sine = c(1. / (k * (k + 1))) * q * (c(1) - sine);
        cosine = k == 2 ? c(0.5) * (c(1) - cosine) : c(1. / (k * (k - 1))) * q * (c(1) - cosine);
    }
    const R longer = c(0.5) * (c(1) - (p.e0 * p.e0 + p.e.dot(p.e)));
    const Vec<R> s = ((c(1) + longer) * (c(1) - sine)) * half;
    const R along = longer - (c(1) + longer) * (q * cosine);
    return {along * p.e0 - s.dot(p.e), along * p.e + p.e0 * s + s.cross(p.e)};
}

}  // namespace hilda::granular
