// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surfaces/area_shares.hpp"

#include <algorithm>

namespace hilda::contact {

using lie::Vec3;

void area_shares(std::span<const Vec3> corner, std::vector<double>& share)
{
    constexpr double no_area = 1e-12;  // twice the area, relative to the square of the extent
    const std::size_t count = corner.size();
    share.assign(count, 1. / static_cast<double>(std::max<std::size_t>(count, 1)));
    if (count < 3) return;
    const Vec3& o = corner[0];
    Vec3 twice_area = Vec3::Zero();
    double extent = 0;
    for (std::size_t k = 1; k < count; ++k) {
        if (k + 1 < count) twice_area += (corner[k] - o).cross(corner[k + 1] - o);
        extent = std::max(extent, (corner[k] - o).squaredNorm());
    }
    const double twice = twice_area.norm();
    if (!(twice > no_area * extent)) return;
    const Vec3 n = twice_area / twice;
    Vec3 moment = Vec3::Zero();
    for (std::size_t k = 1; k + 1 < count; ++k) {
        const Vec3 p = corner[k] - o, q = corner[k + 1] - o;
        moment += n.dot(p.cross(q)) / 3 * (p + q);
    }
    const Vec3 c = o + moment / twice;
    std::fill(share.begin(), share.end(), 0.);
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t next = (k + 1) % count;
        const double part = n.dot((corner[k] - c).cross(corner[next] - c)) / twice;
        share[k] += 0.5 * part;
        share[next] += 0.5 * part;
    }
}

}  // namespace hilda::contact
