// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/clumps/clump_template.hpp"

#include "granular/core/rigid_body.hpp"
#include "io/error.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

double ClumpTemplate::bounding_radius() const
{
    double radius = 0;
    for (const Sphere& s : spheres) radius = std::max(radius, (s.r - centre).norm() + s.radius);
    return radius;
}

std::vector<Sphere> ClumpTemplate::placed(const Vec3& r, const std::array<double, 4>& e, double scale) const
{
    const EulerParameters<double> p{e[0], {e[1], e[2], e[3]}};
    std::vector<Sphere> all;
    all.reserve(spheres.size());
    for (const Sphere& s : spheres) all.push_back({r + rotated(p, scale * (s.r - centre)), scale * s.radius});
    return all;
}

void check_spheres(const std::vector<Sphere>& spheres, const std::string& where)
{
    if (spheres.empty()) io::reject(where, "must have at least one sphere", 0);
    if (spheres.size() > ClumpTemplate::most_spheres)
        io::reject(where, "must not have more than 256 spheres", spheres.size());
    for (std::size_t k = 0; k < spheres.size(); ++k) {
        const auto& [r, radius] = spheres[k];
        const std::string of_sphere = where + ", sphere " + std::to_string(k);
        if (!(radius > 0) || !std::isfinite(radius))
            io::reject(of_sphere, "the radius must be positive", radius);
        for (const double x : {r.x, r.y, r.z})
            if (!std::isfinite(x)) io::reject(of_sphere, "the centre must be finite", x);
    }
}

void ClumpTemplate::check() const
{
    const std::string where = "clump '" + name + "'";
    check_spheres(spheres, where);
    if (!(mass > 0) || !std::isfinite(mass)) io::reject(where, "the mass must be positive", mass);
    for (const double x : {centre.x, centre.y, centre.z})
        if (!std::isfinite(x)) io::reject(where, "the centre must be finite", x);
    if (!is_inertia(inertia))
        io::reject(
            where,
            "the principal moments of inertia must be positive, and none larger than the sum of the others",
            inertia.xx);
}

ClumpTemplate solid_clump(const std::string& name, const std::vector<Sphere>& spheres, double density,
                          int material)
{
    check_spheres(spheres, "clump '" + name + "'");
    const MassProperties of_union = sphere_union(spheres);
    ClumpTemplate t{.name = name, .spheres = spheres, .material = material};
    t.volume = of_union.volume, t.mass = of_union.volume * density, t.centre = of_union.centre;
    std::array<double, 6> J = of_union.J;
    for (double& part : J) part *= density;
    t.inertia = Inertia(J);
    t.check();
    return t;
}

PrincipalInertia principal_inertia(const Inertia& J)
{
    // Jacobi's method: rotations that make the products of inertia zero one after the other
    double M[3][3] = {{J.xx, J.xy, J.zx}, {J.xy, J.yy, J.yz}, {J.zx, J.yz, J.zz}};
    EulerParameters<double> axes{1, {0, 0, 0}};
    const double small = 1e-13 * (J.xx + J.yy + J.zz);
    for (int turn = 0; turn < 100; ++turn) {
        int a = 0, b = 1;
        for (const auto& [i, j] : {std::pair{0, 1}, {1, 2}, {0, 2}})
            if (std::abs(M[i][j]) > std::abs(M[a][b])) a = i, b = j;
        if (std::abs(M[a][b]) <= small) break;
        const double angle = 0.5 * std::atan2(2 * M[a][b], M[a][a] - M[b][b]), c = std::cos(angle),
                     s = std::sin(angle);
        double R[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, MR[3][3] = {}, next[3][3] = {};
        R[a][a] = R[b][b] = c, R[a][b] = -s, R[b][a] = s;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                for (int k = 0; k < 3; ++k) MR[i][j] += M[i][k] * R[k][j];
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                for (int k = 0; k < 3; ++k) next[i][j] += R[k][i] * MR[k][j];
        std::copy(&next[0][0], &next[0][0] + 9, &M[0][0]);
        // A rotation in the own frame: about z if a, b are x and y, about x if y and z, about -y if x and z
        const double half = 0.5 * angle;
        const Vec3 e = std::sin(half) * (a == 1 ? Vec3{1, 0, 0} : b == 1 ? Vec3{0, 0, 1} : Vec3{0, -1, 0});
        const double e0 = std::cos(half);
        axes = {axes.e0 * e0 - axes.e.dot(e), axes.e0 * e + e0 * axes.e + axes.e.cross(e)};
    }
    return {{M[0][0], M[1][1], M[2][2]}, axes};
}

}  // namespace hilda::granular
