// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/validations/bed_geometry.hpp"

#include <cmath>
#include <numbers>

namespace hilda::granular {

std::vector<BedSphere> equal_spheres(const std::vector<Vec3>& centres, double radius)
{
    std::vector<BedSphere> all;
    for (const Vec3& r : centres) all.push_back({r, radius});
    return all;
}

std::vector<BedSphere> equal_spheres(const World& world, double radius)
{
    std::vector<BedSphere> all;
    for (const Particle& p : world.particles()) all.push_back({p.r, radius});
    return all;
}

double height_of_98_percent(const std::vector<BedSphere>& bed)
{
    std::vector<double> z;
    for (const BedSphere& s : bed) z.push_back(s.r.z);
    std::sort(z.begin(), z.end());
    return z[z.size() * 98 / 100];
}

double bulk_density(const std::vector<BedSphere>& bed, double height, double area, double density)
{
    const double low = 0.2 * height, high = 0.8 * height;
    double volume = 0;
    for (const BedSphere& s : bed) {
        const auto below = [&](double z) {  // volume of the sphere below the height z
            const double x = std::clamp(z - (s.r.z - s.radius), 0., 2 * s.radius);
            return std::numbers::pi * x * x * (s.radius - x / 3);
        };
        volume += below(high) - below(low);
    }
    return density * volume / (area * (high - low));
}

double first_contact(const std::vector<BedSphere>& bed, double radius,
                     const std::function<double(const Vec3&)>& distance)
{
    double z = radius;
    for (const BedSphere& s : bed)
        if (const double across = distance(s.r), reach = radius + s.radius; across < reach)
            z = std::max(z, s.r.z + std::sqrt(reach * reach - across * across));
    return z;
}

}  // namespace hilda::granular
