// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/detectors.hpp"
#include "contact/surfaces/disk.hpp"
#include "contact/surfaces/plane.hpp"
#include "lie/check.hpp"

namespace hilda::contact {

namespace {

/// The contact point is the point of the rim farthest along -n. With e the unit vector from the centre to it
/// and θ the angle between e and -n,
///
///     n - (n·z) z = -cos θ e,   t = z × e,   K_i = (1/R) cos θ (I - n nᵀ)
///
/// If the disk is parallel to the plane and above it, any point of the rim is returned.
class DiskPlane final : public Detector {
public:
    DiskPlane(const Shape& i, double R, const Shape& j)
        : c_bar_i(i.position), z_bar_i(i.orientation.col(2)), R(R), o_bar_j(j.position),
          n_bar_j(j.orientation.col(2))
    {}

    ContactPoint detect(const Motion& bi, const Motion& bj, const PreviousPoints*) const override
    {
        const Vec3 c = bi.r + bi.A * c_bar_i, z = bi.A * z_bar_i, n = bj.A * n_bar_j;
        const Vec3 t_cosine = n.cross(z);  // its length is cos θ, without cancellation at θ = π/2
        const double cosine = t_cosine.norm();
        const bool is_tilted = cosine > flat;
        const Vec3 t = is_tilted ? Vec3(t_cosine / cosine) : z.unitOrthogonal();
        const Vec3 C_i = c + R * t.cross(z);
        const double gap = n.dot(C_i - bj.r - bj.A * o_bar_j);
        if (!is_tilted && !(gap > 0))
            throw NoUniqueContactPoint("a disk lies flat on a plane: the contact is the whole rim");
        return {.C_i = C_i,
                .C_j = C_i - gap * n,
                .n = n,
                .gap = gap,
                .K_i = cosine / R * (Mat3::Identity() - n * n.transpose()),
                .K_j = Mat3::Zero(),
                .edge_i = t};
    }

private:
    static constexpr double flat = 1e-12;

    const Vec3 c_bar_i, z_bar_i;
    const double R;
    const Vec3 o_bar_j, n_bar_j;
};

}  // namespace

std::unique_ptr<Detector> disk_plane(const Shape& i, const Shape& j)
{
    const auto* disk = surface_as<Disk>(i);
    if (disk == nullptr || surface_as<Plane>(j) == nullptr) return nullptr;
    return std::make_unique<DiskPlane>(i, disk->R, j);
}

}  // namespace hilda::contact
