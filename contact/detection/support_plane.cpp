// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/detectors.hpp"
#include "contact/surfaces/plane.hpp"

namespace hilda::contact {

namespace {

/// The point of surface i that is furthest against the normal of the plane, which may change at once from one
/// end of a long body to the other. Where the furthest points are many, as of a ring that hovers flat, it is the
/// one of a direction that leans by so little that the gap is the same to round-off.
class SupportPlane final : public Detector {
public:
    SupportPlane(const Shape& i, const Shape& j) : i(i), o_bar_j(j.position), n_bar_j(j.orientation.col(2)) {}

    ContactPoint detect(const Motion& bi, const Motion& bj, const Points*) const override
    {
        const Placed at(i, bi);
        const Vec3 n = bj.A * n_bar_j;
        const Vec3 down = -(at.axes.transpose() * n).normalized();
        try {
            return contact_point(at, bj, n, *i.surface->support(down));
        } catch (const lie::NumericalFailure& many) {
            const Vec3 leaning = (down + lean * down.unitOrthogonal()).normalized();
            const ContactPoint one = contact_point(at, bj, n, *i.surface->support(leaning));
            if (one.gap > 0) return one;
            throw NoUniqueContactPoint(many.what());
        }
    }

private:
    ContactPoint contact_point(const Placed& at, const Motion& bj, const Vec3& n, const Vec3& a) const
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

    static constexpr double lean = 1e-9;

    const Shape i;
    const Vec3 o_bar_j, n_bar_j;
};

}  // namespace

std::unique_ptr<Detector> support_plane(const Shape& i, const Shape& j)
{
    if (dynamic_cast<const Plane*>(j.surface.get()) == nullptr || !i.surface->support(Vec3(0.48, 0.6, 0.64)))
        return nullptr;
    return std::make_unique<SupportPlane>(i, j);
}

}  // namespace hilda::contact
