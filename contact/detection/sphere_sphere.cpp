// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surfaces/sphere.hpp"
#include "contact/detection/detectors.hpp"
#include "io/json.hpp"

namespace hilda::contact {

namespace {

/// Two spheres with signed radii, negative for a concave sphere: C_i = c_i - R_i n, C_j = c_j + R_j n. The
/// normal lies on the line of the centres. It points from c_j to c_i for two convex spheres, and from c_i to
/// c_j if one is concave.
class SphereSphere final : public Detector {
public:
    SphereSphere(const Shape& i, double R_i, const Shape& j, double R_j)
        : c_bar_i(i.position), R_i(R_i), c_bar_j(j.position), R_j(R_j), sign(R_i > 0 && R_j > 0 ? 1 : -1)
    {}

    ContactPoint detect(const Motion& bi, const Motion& bj, const PreviousPoints*) const override
    {
        const Vec3 c_i = bi.r + bi.A * c_bar_i, c_j = bj.r + bj.A * c_bar_j;
        const double distance = (c_i - c_j).norm();
        if (!(distance > 0))
            throw NoUniqueContactPoint(
                "the centres of two spheres coincide: the contact normal is undefined");
        const Vec3 n = (c_i - c_j) / (sign * distance);
        const Mat3 P = Mat3::Identity() - n * n.transpose();
        return {.C_i = c_i - R_i * n,
                .C_j = c_j + R_j * n,
                .n = n,
                .gap = sign * distance - (R_i + R_j),
                .K_i = 1 / R_i * P,
                .K_j = 1 / R_j * P};
    }
    bool is_cheap() const override { return true; }

private:
    const Vec3 c_bar_i;
    const double R_i;
    const Vec3 c_bar_j;
    const double R_j;
    const double sign;
};

}  // namespace

std::unique_ptr<Detector> sphere_sphere(const Shape& i, const Shape& j)
{
    const auto* a = surface_as<Sphere>(i);
    const auto* b = surface_as<Sphere>(j);
    if (a == nullptr || b == nullptr) return nullptr;
    const double R_i = a->sigma() * a->R, R_j = b->sigma() * b->R;
    if (!(1 / R_i + 1 / R_j > 0))
        lie::reject("contact::make_detector",
                    "the radius of a sphere must be less than that of the concave sphere around it",
                    io::shortest(a->concave ? b->R : a->R) + " m in " +
                        io::shortest(a->concave ? a->R : b->R) + " m");
    return std::make_unique<SphereSphere>(i, R_i, j, R_j);
}

}  // namespace hilda::contact
