// SPDX-License-Identifier: GPL-3.0-or-later
/// Orientation of particles in Euler parameters. Orientations are optional output; the contact forces of
/// spheres do not depend on them.

#pragma once

#include "granular/backend/real.hpp"

namespace hilda::granular {

/// Euler parameters p = (e0, e), e0 = cos(chi/2), e = sin(chi/2) a, of the rotation by chi about the unit
/// vector a. The rotation maps body-frame components to global components: A(p) of Fang (2022), Eq. 2.1a.
template <class R>
struct EulerParameters {
    R e0;
    Vec<R> e;
};

/// A(p) X for Euler parameters of length 1                                              Fang (2022), Eq. 2.1a
HILDA_HD inline Vec<double> rotated(const EulerParameters<double>& p, const Vec<double>& X)
{
    const Vec<double> t = 2 * p.e.cross(X);
    return X + p.e0 * t + p.e.cross(t);
}
/// A(p)ᵀ x
HILDA_HD inline Vec<double> rotated_back(const EulerParameters<double>& p, const Vec<double>& x)
{
    return rotated({p.e0, -p.e}, x);
}

/// p ⊗ q: the rotation q followed by the rotation p
inline EulerParameters<double> product(const EulerParameters<double>& p, const EulerParameters<double>& q)
{
    return {p.e0 * q.e0 - p.e.dot(q.e), p.e0 * q.e + q.e0 * p.e + p.e.cross(q.e)};
}

/// exp(angle/2) ⊗ p, normalised: the rotation p followed by the rotation vector `angle` in the global frame
inline EulerParameters<double> turned(const EulerParameters<double>& p, const Vec<double>& angle)
{
    const double half = 0.5 * angle.norm();
    const double cosine = std::cos(half);
    const Vec<double> s = (half > 0 ? std::sin(half) / (2 * half) : 0.5) * angle;
    const EulerParameters<double> q{cosine * p.e0 - s.dot(p.e), cosine * p.e + p.e0 * s + s.cross(p.e)};
    const double length = std::sqrt(q.e0 * q.e0 + q.e.dot(q.e));
    return {q.e0 / length, (1 / length) * q.e};
}

/// Increment d of the Euler parameters for a rotation by `angle`, a rotation vector in the global frame
/// [rad].
///
///     p + d = (1 + (1 - p·p)/2) exp(angle/2) ⊗ p
///
/// exp(angle/2) ⊗ p solves p' = 1/2 omega ⊗ p for constant omega = angle/h. The factor is one Newton step of
/// the normalisation p·p = 1. The angle may have any magnitude. Sine and cosine are computed from series with
/// a truncation error of (|angle|/2)^14/14!, after whole turns are subtracted; that is below the rounding
/// error of single precision.
template <class R>
HILDA_HD inline EulerParameters<R> rotation_increment(const Vec<R>& angle, const EulerParameters<R>& p)
{
    const auto c = [](double constant) { return R(static_cast<Number<R>>(constant)); };
    constexpr double turn = 2 * 3.14159265358979323846;
    // Whole turns change at most the sign of p.
    const R chi = angle.norm(), reduced = chi - c(turn) * rint(chi * c(1 / turn));
    const Vec<R> half = (c(0.5) * select(chi > c(turn / 2), reduced / chi, c(1))) * angle;
    const R q = half.dot(half);
    R sine = c(0), cosine = c(0);  // 1 - sin|half|/|half| and (1 - cos|half|)/q
    for (int k = 12; k >= 2; k -= 2) {
        sine = c(1. / (k * (k + 1))) * q * (c(1) - sine);
        cosine = k == 2 ? c(0.5) * (c(1) - cosine) : c(1. / (k * (k - 1))) * q * (c(1) - cosine);
    }
    const R correction = c(0.5) * (c(1) - (p.e0 * p.e0 + p.e.dot(p.e)));
    const Vec<R> s = ((c(1) + correction) * (c(1) - sine)) * half;
    const R along = correction - (c(1) + correction) * (q * cosine);
    return {along * p.e0 - s.dot(p.e), along * p.e + p.e0 * s + s.cross(p.e)};
}

}  // namespace hilda::granular
