// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/shapes/solid_moments.hpp"

#include <cmath>

namespace hilda::dae {

using lie::Mat3;
using lie::Vec3;

Mat3 SolidMoments::inertia(double mass) const
{
    constexpr double rounding = 1e-14;  // products of inertia of a symmetric body, relative to the trace
    const Mat3 J = second.trace() * Mat3::Identity() - second;
    return mass / volume *
           J.unaryExpr([&](double x) { return std::abs(x) <= rounding * J.trace() ? 0. : x; });
}

SolidMoments moments(const std::vector<Vec3>& points, const std::vector<std::vector<int>>& faces)
{
    Vec3 c = Vec3::Zero();
    for (const Vec3& x : points) c += x;
    c /= static_cast<double>(points.size());
    const auto from_c = [&](int k) { return Vec3(points[static_cast<std::size_t>(k)] - c); };
    SolidMoments all;
    Vec3 first = Vec3::Zero();
    for (const std::vector<int>& face : faces)
        for (std::size_t k = 1; k + 1 < face.size(); ++k) {
            const Vec3 p = from_c(face[0]), q = from_c(face[k]), s = from_c(face[k + 1]), e = p + q + s;
            const double V = p.dot(q.cross(s)) / 6;
            all.volume += V;
            first += V / 4 * e;
            all.second +=
                V / 20 * (e * e.transpose() + p * p.transpose() + q * q.transpose() + s * s.transpose());
        }
    const Vec3 d = first / all.volume;
    all.second -= all.volume * d * d.transpose();
    all.centroid = c + d;
    return all;
}

}  // namespace hilda::dae
