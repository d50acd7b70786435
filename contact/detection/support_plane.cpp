// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/detectors.hpp"
#include "contact/surfaces/plane.hpp"

namespace hilda::contact {

namespace {

/// The contact point of surface i is its support point along -n, the inward normal of the plane. It may jump
/// from one end of a long body to the other. If the support point is not unique, as for a torus parallel to
/// the plane, and the bodies do not touch, the support point of a slightly tilted direction is used; the gap
/// is the same to round-off.
class SupportPlane final : public Detector {
public:
    SupportPlane(const Shape& i, const Shape& j) : i(i), o_bar_j(j.position), n_bar_j(j.orientation.col(2)) {}

    ContactPoint detect(const Motion& bi, const Motion& bj, const PreviousPoints*) const override
    {
        const PlacedShape at(i, bi);
        const Vec3 n = bj.A * n_bar_j;
        const Vec3 down = -(at.axes.transpose() * n).normalized();
        try {
            return at_support(at, bj, n, *i.surface->support(down));
        } catch (const lie::NumericalFailure& e) {
            const Vec3 tilted = (down + tilt * down.unitOrthogonal()).normalized();
            ContactPoint contact_point = at_support(at, bj, n, *i.surface->support(tilted));
            if (contact_point.gap > 0) return contact_point;
            throw NoUniqueContactPoint(e.what());
        }
    }

private:
    ContactPoint at_support(const PlacedShape& at, const Motion& bj, const Vec3& n, const Vec3& a) const
    {
        const Vec3 C_i = at.origin + at.axes * a;
        const double gap = n.dot(C_i - bj.r - bj.A * o_bar_j);
        return {.C_i = C_i,
                .C_j = C_i - gap * n,
                .n = n,
                .gap = gap,
                .K_i = at.axes * i.surface->shape_operator(a) * at.axes.transpose(),
                .K_j = Mat3::Zero()};
    }

    static constexpr double tilt = 1e-9;

    const Shape i;
    const Vec3 o_bar_j, n_bar_j;
};

}  // namespace

std::unique_ptr<Detector> support_plane(const Shape& i, const Shape& j)
{
    if (surface_as<Plane>(j) == nullptr || !i.surface->support(Vec3(0.48, 0.6, 0.64))) return nullptr;
    return std::make_unique<SupportPlane>(i, j);
}

}  // namespace hilda::contact
