// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/friction/tracker.hpp"

#include "lie/check.hpp"

namespace hilda::contact {

namespace {

constexpr double length_rounding =
    1e-15;  // of positions: a displacement below this fraction of them has no direction

/// p_b: from the present position of the old contact point c_bar to the new contact point C, in the tangent
/// plane, with the length of the path along the surface
Vec3 surface_displacement(const Vec3& c_bar, const Vec3& C, const Vec3& n, const Motion& b,
                          const Surface& surface)
{
    const Vec3 s = b.A * c_bar, d = C - (b.r + s);
    const Vec3 t = d - n * n.dot(d);
    const double length = t.norm();
    if (length <= length_rounding * (b.r.norm() + s.norm())) return Vec3::Zero();
    return surface.arc(d.norm()) / length * t;
}

/// u_0 ⊥ n_0 after the smallest rotation that maps n_0 to n (parallel transport)                    Sec. A.6
Vec3 transported(const Vec3& u_0, const Vec3& n_0, const Vec3& n)
{
    const double cosine = n.dot(n_0);
    if (!(cosine > -0.99))
        throw lie::NumericalFailure(
            "contact_not_converged",
            "the normal of a contact rotates by more than 172 deg in a step; reduce the step");
    Vec3 u = u_0 - n.dot(u_0) / (1 + cosine) * (n_0 + n);
    u -= n * n.dot(u);
    return u / u.norm();
}

}  // namespace

ContactFrame contact_frame(const ContactPoint& contact_point, const Vec3& u, const Motion& bi,
                           const Motion& bj)
{
    return {.c_i = bi.A.transpose() * (contact_point.C_i - bi.r),
            .c_j = bj.A.transpose() * (contact_point.C_j - bj.r),
            .n_i = bi.A.transpose() * contact_point.n,
            .n_j = bj.A.transpose() * contact_point.n,
            .u_i = bi.A.transpose() * u,
            .u_j = bj.A.transpose() * u};
}

SlidingDisplacement zero_displacement(const ContactPoint& contact_point, const Vec3& u)
{
    const Vec3 zero = Vec3::Zero();
    return {.n = contact_point.n,
            .u = u,
            .u_i = u,
            .u_j = u,
            .psi = 0,
            .p_i = zero,
            .p_j = zero,
            .q_i = zero,
            .q_j = zero,
            .ds = zero};
}

SlidingDisplacement track_contact_point(const ContactFrame& from, const ContactPoint& to, const Shape& i,
                                        const Shape& j, const Motion& bi, const Motion& bj,
                                        const Tracking& how)
{
    SlidingDisplacement s;
    s.n = to.n;
    s.u_i = transported(bi.A * from.u_i, bi.A * from.n_i, s.n);
    s.u_j = transported(bj.A * from.u_j, bj.A * from.n_j, s.n);
    s.psi = std::atan2(s.n.dot(s.u_j.cross(s.u_i)), s.u_j.dot(s.u_i));
    s.p_i = surface_displacement(from.c_i, to.C_i, s.n, bi, *i.surface);
    s.p_j = surface_displacement(from.c_j, to.C_j, s.n, bj, *j.surface);
    if (how.carrier == Carrier::mid) {
        const double angle = how.beta * s.psi / 2, cosine = std::cos(angle), sine = std::sin(angle);
        s.u = (s.u_i + s.u_j).normalized();  // bisector, without another sine and cosine
        s.q_i = rotated(s.p_i, s.n, cosine, -sine);
        s.q_j = rotated(s.p_j, s.n, cosine, sine);
    } else {
        s.u = s.u_i;
        s.q_i = s.p_i;
        s.q_j = rotated(s.p_j, s.n, std::cos(how.beta * s.psi), std::sin(how.beta * s.psi));
    }
    s.ds = s.q_i - s.q_j;
    return s;
}

}  // namespace hilda::contact
