// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/detectors.hpp"
#include "contact/surfaces/disk.hpp"
#include "contact/surfaces/plane.hpp"
#include "lie/check.hpp"

namespace hilda::contact {

namespace {

/// The lowest point of the rim. With e the direction from the centre to it and θ between e and -n,
///
///     n - (n·z) z = -cos θ e,   t = z × e,   K_i = (1/R) cos θ (I - n nᵀ)
///
/// Flat above the plane all points of the rim are equally low, and it is any of them.
class DiskPlane final : public Detector {
public:
    DiskPlane(const Shape& i, double R, const Shape& j)
        : c_bar_i(i.position), z_bar_i(i.orientation.col(2)), R(R), o_bar_j(j.position),
          n_bar_j(j.orientation.col(2))
    {}

    ContactPoint detect(const Motion& bi, const Motion& bj, const Points*) const override
    {
        const Vec3 c = bi.r + bi.A * c_bar_i, z = bi.A * z_bar_i, n = bj.A * n_bar_j;
        const Vec3 t_cosine = n.cross(z);  // as long as cos θ, and free of cancellation when the disk is flat
        const double cosine = t_cosine.norm();
        const bool leans = cosine > flat;
        const Vec3 t = leans ? Vec3(t_cosine / cosine) : z.unitOrthogonal();
        const Vec3 C_i = c + R * t.cross(z);
        const double gap = n.dot(C_i - bj.r - bj.A * o_bar_j);
        if (!leans && !(gap > 0))
            throw NoUniqueContactPoint("a disk lies flat on a plane: it touches with all of its rim");
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
    const auto* disk = dynamic_cast<const Disk*>(i.surface.get());
    if (disk == nullptr || dynamic_cast<const Plane*>(j.surface.get()) == nullptr) return nullptr;
    return std::make_unique<DiskPlane>(i, disk->R, j);
}

}  // namespace hilda::contact
