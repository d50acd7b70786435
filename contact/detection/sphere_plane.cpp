// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/detectors.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"

namespace hilda::contact {

namespace {

/// C_i = c - R n, where c is the centre of the sphere; C_j is the projection of c onto the plane.
class SpherePlane final : public Detector {
public:
    SpherePlane(const Shape& i, double R, const Shape& j)
        : c_bar_i(i.position), R(R), o_bar_j(j.position), n_bar_j(j.orientation.col(2))
    {}

    ContactPoint detect(const Motion& bi, const Motion& bj, const PreviousPoints*) const override
    {
        const Vec3 c = bi.r + bi.A * c_bar_i, n = bj.A * n_bar_j;
        const double height = n.dot(c - bj.r - bj.A * o_bar_j);
        return {.C_i = c - R * n,
                .C_j = c - height * n,
                .n = n,
                .gap = height - R,
                .K_i = 1 / R * (Mat3::Identity() - n * n.transpose()),
                .K_j = Mat3::Zero()};
    }
    bool is_cheap() const override { return true; }

private:
    const Vec3 c_bar_i;
    const double R;
    const Vec3 o_bar_j, n_bar_j;
};

}  // namespace

std::unique_ptr<Detector> sphere_plane(const Shape& i, const Shape& j)
{
    const auto* sphere = surface_as<Sphere>(i);
    if (sphere == nullptr || surface_as<Plane>(j) == nullptr) return nullptr;
    return std::make_unique<SpherePlane>(i, sphere->R, j);
}

}  // namespace hilda::contact
