// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surfaces/cylinder.hpp"
#include "contact/detection/detectors.hpp"
#include "lie/check.hpp"

namespace hilda::contact {

namespace {

/// The contact points lie on the common perpendicular of the axes. With the unit axes z_i, z_j and d = o_i -
/// o_j, the feet of the perpendicular on the axes are
///
///     f_i = o_i - z_i ((d × z_j)·m) / |m|²,   f_j = o_j - z_j ((d × z_i)·m) / |m|²,   m = z_i × z_j
///
/// For parallel axes the perpendicular is not unique, and the one through o_i is used if the cylinders do not
/// touch.
class CylinderCylinder final : public Detector {
public:
    CylinderCylinder(const Shape& i, double R_i, const Shape& j, double R_j) : i(i), j(j), R_i(R_i), R_j(R_j)
    {}

    ContactPoint detect(const Motion& bi, const Motion& bj, const PreviousPoints*) const override
    {
        const Vec3 o_i = bi.r + bi.A * i.position, o_j = bj.r + bj.A * j.position, d = o_i - o_j;
        const Vec3 z_i = bi.A * i.orientation.col(2), z_j = bj.A * j.orientation.col(2), m = z_i.cross(z_j);
        const double sine = m.norm();
        if (!(sine > parallel)) {
            const Vec3 f_j = o_j + z_j.dot(d) * z_j, across = o_i - f_j;
            const double distance = across.norm();
            if (!(distance > R_i + R_j))
                throw NoUniqueContactPoint("the axes of two cylinders are parallel: the contact is a line");
            return between(o_i, z_i, f_j, z_j, across / distance, distance);
        }
        const double distance = d.dot(m) / sine;
        const Vec3 n = m / (distance < 0 ? -sine : sine);
        const Vec3 f_i = o_i - d.cross(z_j).dot(m) / (sine * sine) * z_i;
        const Vec3 f_j = o_j - d.cross(z_i).dot(m) / (sine * sine) * z_j;
        return between(f_i, z_i, f_j, z_j, n, std::abs(distance));
    }

private:
    ContactPoint between(const Vec3& f_i, const Vec3& z_i, const Vec3& f_j, const Vec3& z_j, const Vec3& n,
                         double distance) const
    {
        const Vec3 t_i = n.cross(z_i), t_j = n.cross(z_j);
        return {.C_i = f_i - R_i * n,
                .C_j = f_j + R_j * n,
                .n = n,
                .gap = distance - (R_i + R_j),
                .K_i = 1 / R_i * t_i * t_i.transpose(),
                .K_j = 1 / R_j * t_j * t_j.transpose()};
    }

    static constexpr double parallel = 1e-9;  // sine of the angle between the axes

    const Shape i, j;
    const double R_i, R_j;
};

}  // namespace

std::unique_ptr<Detector> cylinder_cylinder(const Shape& i, const Shape& j)
{
    const auto* a = surface_as<Cylinder>(i);
    const auto* b = surface_as<Cylinder>(j);
    if (a == nullptr || b == nullptr) return nullptr;
    if (a->concave || b->concave)
        lie::reject("contact::make_detector", "a pair of surfaces must have a single contact point",
                    "a cylinder and a concave cylinder");
    return std::make_unique<CylinderCylinder>(i, a->R, j, b->R);
}

}  // namespace hilda::contact
