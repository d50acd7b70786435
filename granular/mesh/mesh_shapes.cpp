// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/mesh/mesh_shapes.hpp"

#include "io/error.hpp"
#include "io/json.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <unordered_map>
#include <utility>

namespace hilda::granular {

namespace {

using Triangle = std::array<std::uint32_t, 3>;
using Point = std::array<double, 2>;

void check_finite(const std::string& where, const std::string& what, double x)
{
    if (!std::isfinite(x)) io::reject(where, what + " must be finite", x);
}

void check_positive(const std::string& where, const std::string& what, double x)
{
    if (!(x > 0 && std::isfinite(x))) io::reject(where, what + " must be positive and finite", x);
}

void check_count(const std::string& where, double triangles)
{
    constexpr std::size_t most = TriangleMesh::most_triangles;
    if (!(triangles <= static_cast<double>(most)))
        io::reject(where, "a mesh must have at most " + std::to_string(most) + " triangles", triangles);
}

/// Number of equal cells of at most that edge along a length, as double because it may be very large. A
/// length of n edges gives n cells, although its quotient may be rounded up.
double cells(double length, double edge)
{
    constexpr double rounding = 1e-12;
    return edge > 0 ? std::max(1., std::ceil(length / edge * (1 - rounding))) : 1;
}

/// The point k of n + 1 on the way from low to high, exactly low and high at its ends
double between(double low, double high, std::size_t k, std::size_t n)
{
    return k == n ? high : low + (high - low) * (static_cast<double>(k) / static_cast<double>(n));
}

}  // namespace

TriangleMesh box_mesh(const Vec3& low, const Vec3& high, const std::array<bool, 6>& open, bool inside,
                      double edge)
{
    const std::string where = "granular::box_mesh";
    const std::array from = {low.x, low.y, low.z}, to = {high.x, high.y, high.z};
    for (std::size_t k = 0; k < 3; ++k) {
        check_finite(where, "low", from[k]);
        check_finite(where, "high", to[k]);
        if (const double size = to[k] - from[k]; !(size > 0 && std::isfinite(size)))
            io::reject(where, "high - low must be positive and finite", size);
    }
    check_finite(where, "edge", edge);
    if (std::find(open.begin(), open.end(), false) == open.end())
        io::reject(where, "a side must be closed", "6 open sides");

    std::array<double, 3> count{};
    for (std::size_t k = 0; k < 3; ++k) count[k] = cells(to[k] - from[k], edge);
    double triangles = 0;
    for (std::size_t side = 0; side < 6; ++side) {
        const std::size_t k = side / 2;
        if (!open[side]) triangles += 2 * count[(k + 1) % 3] * count[(k + 2) % 3];
    }
    check_count(where, triangles);
    // The axis across the only closed side may have many cells, which no side uses.
    constexpr auto most = static_cast<double>(TriangleMesh::most_triangles);
    std::array<std::size_t, 3> n{};
    for (std::size_t k = 0; k < 3; ++k) n[k] = static_cast<std::size_t>(std::min(count[k], most));

    TriangleMesh mesh;
    mesh.triangle.reserve(static_cast<std::size_t>(triangles));
    std::unordered_map<std::size_t, std::uint32_t> known;  // vertices by their number in the lattice
    const auto vertex = [&](const std::array<std::size_t, 3>& at) {
        const std::size_t number = (at[2] * (n[1] + 1) + at[1]) * (n[0] + 1) + at[0];
        const auto [found, is_new] =
            known.try_emplace(number, static_cast<std::uint32_t>(mesh.vertex.size()));
        if (is_new)
            mesh.vertex.push_back({between(from[0], to[0], at[0], n[0]), between(from[1], to[1], at[1], n[1]),
                                   between(from[2], to[2], at[2], n[2])});
        return found->second;
    };
    for (std::size_t side = 0; side < 6; ++side) {
        if (open[side]) continue;
        const std::size_t k = side / 2, u = (k + 1) % 3, v = (k + 2) % 3;  // e_u × e_v = e_k
        const bool along = (side % 2 == 1) != inside;                      // whether the normal is +e_k
        for (std::size_t j = 0; j < n[v]; ++j)
            for (std::size_t i = 0; i < n[u]; ++i) {
                std::array<std::size_t, 3> at{};
                at[k] = side % 2 == 1 ? n[k] : 0;
                const auto corner = [&](std::size_t du, std::size_t dv) {
                    at[u] = i + du, at[v] = j + dv;
                    return vertex(at);
                };
                const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
                mesh.triangle.push_back(along ? Triangle{a, b, c} : Triangle{a, c, b});
                mesh.triangle.push_back(along ? Triangle{a, c, d} : Triangle{a, d, c});
            }
    }
    return mesh;
}

TriangleMesh lathe_mesh(const std::vector<Point>& profile, int segments)
{
    const std::string where = "granular::lathe_mesh";
    if (segments < 3) io::reject(where, "segments must be at least 3", segments);
    if (profile.size() < 2) io::reject(where, "the profile must have at least 2 points", profile.size());
    for (std::size_t k = 0; k < profile.size(); ++k) {
        const std::string point = "point " + std::to_string(k) + " of the profile";
        const auto [radius, z] = profile[k];
        if (!(radius >= 0 && std::isfinite(radius)))
            io::reject(where, "the radius of " + point + " must be finite and not negative", radius);
        check_finite(where, "z of " + point, z);
        if (k > 0 && profile[k] == profile[k - 1])
            io::reject(where, point + " must differ from the one before it",
                       '(' + io::shortest(radius) + ", " + io::shortest(z) + ") twice");
    }
    const bool closed = profile.front() == profile.back();
    if (closed && profile.size() < 4)
        io::reject(where, "a closed profile must have at least 4 points", profile.size());
    const auto n = static_cast<std::size_t>(segments);
    check_count(where, 2. * segments * static_cast<double>(profile.size() - 1));

    TriangleMesh mesh;
    std::vector<std::uint32_t> first;  // vertex of each point of the profile
    for (std::size_t k = 0; k + closed < profile.size(); ++k) {
        first.push_back(static_cast<std::uint32_t>(mesh.vertex.size()));
        const auto [radius, z] = profile[k];
        if (radius == 0) {
            mesh.vertex.push_back({0, 0, z});
            continue;
        }
        for (std::size_t j = 0; j < n; ++j) {
            const double angle = 2 * std::numbers::pi * static_cast<double>(j) / segments;
            mesh.vertex.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
        }
    }
    if (closed) first.push_back(first.front());
    const auto vertex = [&](std::size_t k, std::size_t j) {
        return profile[k][0] == 0 ? first[k] : static_cast<std::uint32_t>(first[k] + j % n);
    };
    for (std::size_t k = 0; k + 1 < profile.size(); ++k)
        for (std::size_t j = 0; j < n; ++j) {
            const std::uint32_t a = vertex(k, j), b = vertex(k, j + 1);
            const std::uint32_t c = vertex(k + 1, j + 1), d = vertex(k + 1, j);
            if (c != d) mesh.triangle.push_back({a, d, c});
            if (a != b) mesh.triangle.push_back({a, c, b});
        }
    if (mesh.triangle.empty()) io::reject(where, "a radius of the profile must be positive", 0);
    return mesh;
}

namespace {

/// Twice the signed area of a triangle, positive if it is counterclockwise
double orientation(const Point& a, const Point& b, const Point& c)
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

double squared_distance(const Point& a, const Point& b)
{
    const double x = b[0] - a[0], y = b[1] - a[1];
    return x * x + y * y;
}

bool is_in_box(const Point& p, const Point& a, const Point& b)
{
    return std::min(a[0], b[0]) <= p[0] && p[0] <= std::max(a[0], b[0]) && std::min(a[1], b[1]) <= p[1] &&
           p[1] <= std::max(a[1], b[1]);
}

/// Whether two line segments have a common point
bool meet(const Point& a, const Point& b, const Point& c, const Point& d)
{
    const double abc = orientation(a, b, c), abd = orientation(a, b, d);
    const double cda = orientation(c, d, a), cdb = orientation(c, d, b);
    if (((abc > 0 && abd < 0) || (abc < 0 && abd > 0)) && ((cda > 0 && cdb < 0) || (cda < 0 && cdb > 0)))
        return true;
    return (abc == 0 && is_in_box(c, a, b)) || (abd == 0 && is_in_box(d, a, b)) ||
           (cda == 0 && is_in_box(a, c, d)) || (cdb == 0 && is_in_box(b, c, d));
}

void check_outline(const std::string& where, const std::vector<Point>& p)
{
    constexpr std::size_t most_points = 10000;
    const std::size_t n = p.size();
    if (n < 3) io::reject(where, "the outline must have at least 3 points", n);
    if (n > most_points)
        io::reject(where, "the outline must have at most " + std::to_string(most_points) + " points", n);
    for (std::size_t k = 0; k < n; ++k)
        for (const double x : p[k]) check_finite(where, "point " + std::to_string(k) + " of the outline", x);
    const auto sides = [](std::size_t a, std::size_t b) {
        return std::to_string(a) + " and " + std::to_string(b);
    };
    for (std::size_t k = 0; k < n; ++k) {
        const Point &a = p[k], &b = p[(k + 1) % n], &c = p[(k + 2) % n];
        if (a == b)
            io::reject(where, "neighbours of the outline must differ",
                       "equal points " + sides(k, (k + 1) % n));
        const double cosine = (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]);
        if (orientation(a, b, c) == 0 && !(cosine >= 0))
            io::reject(where, "neighbouring sides of the outline must not overlap",
                       "sides " + sides(k, (k + 1) % n));
    }
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t k = i + 2; k < n - (i == 0); ++k)
            if (meet(p[i], p[i + 1], p[k], p[(k + 1) % n]))
                io::reject(where, "the outline must not meet itself",
                           "common points of sides " + sides(i, k));
    double area = 0;
    for (std::size_t k = 1; k + 1 < n; ++k) area += orientation(p[0], p[k], p[k + 1]) / 2;
    if (!(area > 0 && std::isfinite(area)))
        io::reject(where, "the outline must be counterclockwise with a finite area", area);
}

/// Triangulation of a simple polygon in counterclockwise order.
///
/// A corner is an ear if its triangle contains no other point of the remaining polygon, not even on its
/// sides. A clipped ear changes only those at its two neighbours. The ear with the largest relative area is
/// clipped first. For random stars with points on straight sides the least relative area is then 14 times
/// that of the first ear found, and the geometric mean 5 times.
class EarClipping {
public:
    explicit EarClipping(const std::vector<Point>& p)
        : p(p), before(p.size()), after(p.size()), quality(p.size())
    {
        for (std::size_t k = 0; k < p.size(); ++k)
            before[k] = (k + p.size() - 1) % p.size(), after[k] = (k + 1) % p.size();
        for (std::size_t k = 0; k < p.size(); ++k) quality[k] = quality_of(k);
    }

    /// The n - 2 triangles. The result has fewer if the polygon has no ear within rounding.
    std::vector<std::array<std::size_t, 3>> triangles()
    {
        std::vector<std::array<std::size_t, 3>> all;
        std::size_t start = 0;
        for (std::size_t left = p.size(); left >= 3; --left) {
            std::size_t best = start;
            for (std::size_t k = after[start]; k != start; k = after[k])
                if (quality[k] > quality[best]) best = k;
            if (quality[best] == 0) break;
            const std::size_t u = before[best], w = after[best];
            all.push_back({u, best, w});
            after[u] = w, before[w] = u, start = u;
            quality[u] = quality_of(u), quality[w] = quality_of(w);
        }
        return all;
    }

private:
    /// Twice the area of the ear at point k over the square of its longest side; 0 if it is no ear
    double quality_of(std::size_t k) const
    {
        constexpr double rounding = 1e-11;  // above the relative area that check_mesh() refuses
        const Point &a = p[before[k]], &b = p[k], &c = p[after[k]];
        const double longest =
            std::max({squared_distance(a, b), squared_distance(b, c), squared_distance(c, a)});
        const double area = orientation(a, b, c);
        if (!(area > rounding * longest)) return 0;
        for (std::size_t q = after[after[k]]; q != before[k]; q = after[q])
            if (orientation(a, b, p[q]) >= 0 && orientation(b, c, p[q]) >= 0 &&
                orientation(c, a, p[q]) >= -rounding * longest)
                return 0;
        return area / longest;
    }

    const std::vector<Point>& p;
    std::vector<std::size_t> before, after;  ///< neighbours in the remaining polygon
    std::vector<double> quality;
};

}  // namespace

TriangleMesh extrude_mesh(const std::vector<Point>& outline, double length)
{
    const std::string where = "granular::extrude_mesh";
    check_positive(where, "length", length);
    check_outline(where, outline);
    const std::size_t n = outline.size();
    const auto caps = EarClipping(outline).triangles();
    if (caps.size() != n - 2)
        io::reject(where,
                   "the outline must be a simple polygon beyond rounding, with " + std::to_string(n - 2) +
                       " triangles",
                   caps.size());

    TriangleMesh mesh;
    for (const double z : {0., length})
        for (const auto& [x, y] : outline) mesh.vertex.push_back({x, y, z});
    const auto vertex = [&](std::size_t k, bool top) {
        return static_cast<std::uint32_t>(k % n + (top ? n : 0));
    };
    for (std::size_t k = 0; k < n; ++k) {
        mesh.triangle.push_back({vertex(k, false), vertex(k + 1, false), vertex(k + 1, true)});
        mesh.triangle.push_back({vertex(k, false), vertex(k + 1, true), vertex(k, true)});
    }
    for (const auto& [a, b, c] : caps) {
        mesh.triangle.push_back({vertex(a, false), vertex(c, false), vertex(b, false)});
        mesh.triangle.push_back({vertex(a, true), vertex(b, true), vertex(c, true)});
    }
    return mesh;
}

TriangleMesh plate_mesh(double width_x, double width_y, double edge)
{
    const std::string where = "granular::plate_mesh";
    check_positive(where, "width_x", width_x);
    check_positive(where, "width_y", width_y);
    check_finite(where, "edge", edge);
    const double cells_x = cells(width_x, edge), cells_y = cells(width_y, edge);
    check_count(where, 2 * cells_x * cells_y);
    const auto n_x = static_cast<std::size_t>(cells_x), n_y = static_cast<std::size_t>(cells_y);

    TriangleMesh mesh;
    for (std::size_t j = 0; j <= n_y; ++j)
        for (std::size_t i = 0; i <= n_x; ++i)
            mesh.vertex.push_back(
                {between(-width_x / 2, width_x / 2, i, n_x), between(-width_y / 2, width_y / 2, j, n_y), 0});
    const auto vertex = [&](std::size_t i, std::size_t j) {
        return static_cast<std::uint32_t>(j * (n_x + 1) + i);
    };
    for (std::size_t j = 0; j < n_y; ++j)
        for (std::size_t i = 0; i < n_x; ++i) {
            mesh.triangle.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
            mesh.triangle.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
        }
    return mesh;
}

TriangleMesh sphere_mesh(double radius, int divisions)
{
    const std::string where = "granular::sphere_mesh";
    constexpr int most_divisions = 8;  // 20 · 4⁸ = 1310720 triangles; one more exceeds most_triangles
    static_assert((std::size_t{20} << (2 * most_divisions)) <= TriangleMesh::most_triangles);
    check_positive(where, "radius", radius);
    if (divisions < 0 || divisions > most_divisions)
        io::reject(where, "divisions must be from 0 to " + std::to_string(most_divisions), divisions);

    // of the unit sphere, scaled at the end
    constexpr double g = std::numbers::phi;
    TriangleMesh mesh;
    std::vector<Vec3>& x = mesh.vertex;
    x = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
         {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    for (Vec3& v : x) v = (1 / v.norm()) * v;
    mesh.triangle = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                     {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                     {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    for (int k = 0; k < divisions; ++k) {
        std::unordered_map<std::uint64_t, std::uint32_t> middles;  // of the edges
        middles.reserve(mesh.triangle.size() * 3 / 2);
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const std::uint64_t edge = std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
            const auto [at, is_new] = middles.try_emplace(edge, static_cast<std::uint32_t>(x.size()));
            if (is_new) {
                const Vec3 sum = x[a] + x[b];
                x.push_back((1 / sum.norm()) * sum);
            }
            return at->second;
        };
        std::vector<Triangle> finer;
        finer.reserve(4 * mesh.triangle.size());
        for (const auto& [a, b, c] : mesh.triangle) {
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        mesh.triangle = std::move(finer);
    }
    for (Vec3& v : x) v = radius * v;
    return mesh;
}

}  // namespace hilda::granular
