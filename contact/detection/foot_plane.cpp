// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/detectors.hpp"
#include "contact/surfaces/foot.hpp"
#include "contact/surfaces/plane.hpp"

namespace hilda::contact {

namespace {

/// The contact point of body i is the origin of the foot, at any orientation. The normal is that of the
/// plane.
class FootPlane final : public Detector {
public:
    FootPlane(const Shape& i, const Shape& j)
        : o_bar_i(i.position), o_bar_j(j.position), n_bar_j(j.orientation.col(2))
    {}

    ContactPoint detect(const Motion& bi, const Motion& bj, const PreviousPoints*) const override
    {
        const Vec3 C_i = bi.r + bi.A * o_bar_i, n = bj.A * n_bar_j;
        const double gap = n.dot(C_i - bj.r - bj.A * o_bar_j);
        return {
            .C_i = C_i, .C_j = C_i - gap * n, .n = n, .gap = gap, .K_i = Mat3::Zero(), .K_j = Mat3::Zero()};
    }

private:
    const Vec3 o_bar_i, o_bar_j, n_bar_j;
};

}  // namespace

std::unique_ptr<Detector> foot_plane(const Shape& i, const Shape& j)
{
    if (surface_as<Foot>(i) == nullptr || surface_as<Plane>(j) == nullptr) return nullptr;
    return std::make_unique<FootPlane>(i, j);
}

}  // namespace hilda::contact
