// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/other_points.hpp"

#include "contact/surfaces/cylinder.hpp"
#include "contact/surfaces/sphere.hpp"
#include "contact/surfaces/torus.hpp"
#include "lie/check.hpp"

#include <cmath>
#include <sstream>

namespace hilda::contact {

namespace {

constexpr double largest_motion = 0.02;  // between two searches, relative to the smaller size
constexpr double rounding = 1e-6;        // overlap that is counted as zero, relative to the smaller size
// A negative sum of curvatures that an overlap of the same order makes positive, relative to the curvatures
constexpr double flat = 0.05;

bool is_sphere(const Shape& s) { return surface_as<Sphere>(s) != nullptr; }

/// Whether `body` may touch the inside of `outer` at several points
bool may_touch_twice(const Shape& outer, const Shape& body)
{
    if (!(outer.surface->sigma() < 0) || !outer.surface->is_smooth()) return false;
    return !(is_sphere(body) && (is_sphere(outer) || surface_as<Cylinder>(outer) != nullptr));
}

}  // namespace

OtherPoints::OtherPoints(const Shape& i, const Shape& j)
    : i(i), j(j), common_normal(i, j), size(smaller_size(i, j)), spheres_i(is_sphere(i)),
      spheres_j(is_sphere(j))
{}

bool OtherPoints::possible(const Shape& i, const Shape& j)
{
    const bool torus = surface_as<Torus>(i) != nullptr || surface_as<Torus>(j) != nullptr;
    const bool both_curved = i.surface->size() > 0 && j.surface->size() > 0;
    return (torus && both_curved) || may_touch_twice(i, j) || may_touch_twice(j, i);
}

std::unique_ptr<const OtherPoints> OtherPoints::of(const Shape& i, const Shape& j)
{
    return possible(i, j) ? std::make_unique<const OtherPoints>(i, j) : nullptr;
}

void OtherPoints::check(const std::string& contact, const Motion& bi, const Motion& bj,
                        const ContactPoint& followed, Pose& last) const
{
    const auto fail = [&](const auto&... parts) {
        std::ostringstream what;
        what.precision(3);
        what << "contact '" << contact << "': ";
        (what << ... << parts);
        throw lie::NumericalFailure("contact_not_unique", what.str());
    };
    if (followed.gap < -rounding * size) {
        const double of_i = principal_curvatures(followed.K_i, followed.n).least,
                     of_j = principal_curvatures(followed.K_j, followed.n).least,
                     least = least_curvature(followed);
        if (!(least > -flat * (std::abs(of_i) + std::abs(of_j))))
            fail(
                "the surfaces overlap where one does not fit into the other, and touch at other points too: "
                "the sum of their curvatures must be positive, got ",
                least, " 1/m (least curvatures ", of_i, " and ", of_j, " 1/m)");
    }
    const PlacedShape at_i(i, bi), at_j(j, bj);
    // A sphere does not change if it turns.
    const PlacedShape &of = spheres_j ? at_j : at_i, &in = spheres_j ? at_i : at_j;
    const Pose now{in.axes.transpose() * (of.origin - in.origin), in.axes.transpose() * of.axes};
    const double turn = spheres_i || spheres_j ? 0 : (now.A - last.A).norm();
    if (!last.A.isZero(0) && (now.r - last.r).norm() + size * turn < largest_motion * size) return;
    last = now;
    const auto other = common_normal.find_overlap_besides(followed, bi, bj, rounding * size);
    if (!other) return;
    fail("the surfaces overlap by ", -other->gap, " m at another point, ", (other->C() - followed.C()).norm(),
         " m from the one that the contact follows (gap ", followed.gap,
         " m); a contact has one contact point");
}

}  // namespace hilda::contact
