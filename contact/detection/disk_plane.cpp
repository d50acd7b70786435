// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/detectors.hpp"
#include "contact/surfaces/disk.hpp"
#include "contact/surfaces/plane.hpp"
#include "lie/check.hpp"

#include <cmath>
#include <numbers>

namespace hilda::contact {

namespace {

/// The point of the rim at the angle ψ from the lowest one. With z the axis, e the unit vector from the
/// centre to the lowest point, θ the angle between e and -n, and t = z × e,
///
///     n - (n·z) z = -cos θ e,   C_i = c + R (cos ψ e + sin ψ t),   K_i = (1/R) cos θ (I - n nᵀ)
///
/// The contact points are those at ψ = k 2π/m, k = 0 ... m - 1, with the feature k. If the disk is parallel
/// to the plane to rounding, e is a fixed vector of the body: a disk at rest keeps its contact points.
class DiskPlane final : public Detector {
public:
    DiskPlane(const Shape& i, double R, const Shape& j)
        : c_bar_i(i.position), x_bar_i(i.orientation.col(0)), z_bar_i(i.orientation.col(2)), R(R),
          o_bar_j(j.position), n_bar_j(j.orientation.col(2))
    {}

    /// The lowest point. If the disk is parallel to the plane and above it, any point of the rim is returned.
    ContactPoint detect(const Motion& bi, const Motion& bj, const PreviousPoints*) const override
    {
        const Rim rim(*this, bi, bj);
        ContactPoint lowest = rim.contact_point(1, 0);
        if (!rim.is_tilted && !(lowest.gap > 0))
            throw NoUniqueContactPoint("a disk lies flat on a plane: the contact is the whole rim");
        return lowest;
    }

    void detect_all(const Motion& bi, const Motion& bj, double reach, Manifold& out) const override
    {
        out.clear();
        const Rim rim(*this, bi, bj);
        for (std::uint32_t k = 0; k < points; ++k) {
            const double psi = 2 * std::numbers::pi * k / points;
            const ContactPoint at = rim.contact_point(std::cos(psi), std::sin(psi));
            if (at.gap < reach) out.push_back({.at = at, .feature = k});
        }
    }

private:
    static constexpr double flat = 1e-12;
    static constexpr std::uint32_t points = Manifold::most;

    struct Rim {
        Vec3 n, c, o, e, t;  ///< o: the origin of the plane
        double R, cosine;
        bool is_tilted;

        Rim(const DiskPlane& of, const Motion& bi, const Motion& bj)
            : n(bj.A * of.n_bar_j), c(bi.r + bi.A * of.c_bar_i), o(bj.r + bj.A * of.o_bar_j), R(of.R)
        {
            const Vec3 z = bi.A * of.z_bar_i;
            const Vec3 t_cosine = n.cross(z);  // its length is cos θ, without cancellation at θ = π/2
            cosine = t_cosine.norm();
            is_tilted = cosine > flat;
            t = is_tilted ? Vec3(t_cosine / cosine) : Vec3(z.cross(bi.A * of.x_bar_i));
            e = t.cross(z);
        }
        ContactPoint contact_point(double cos_psi, double sin_psi) const
        {
            const Vec3 C_i = c + R * (cos_psi * e + sin_psi * t);
            const double gap = n.dot(C_i - o);
            return {.C_i = C_i,
                    .C_j = C_i - gap * n,
                    .n = n,
                    .gap = gap,
                    .K_i = cosine / R * (Mat3::Identity() - n * n.transpose()),
                    .K_j = Mat3::Zero(),
                    .edge_i = cos_psi * t - sin_psi * e};
        }
    };

    const Vec3 c_bar_i, x_bar_i, z_bar_i;
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
