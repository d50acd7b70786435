// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/clumps/sphere_union.hpp"

#include "granular/core/material.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hilda::granular {

namespace {

using std::numbers::pi;

/// Nodes and weights of Gauss-Legendre quadrature on [-1, 1], by Newton's method from Tricomi's estimates
template <int n>
struct Gauss {
    std::array<double, n> x{}, weight{};

    Gauss()
    {
        for (int k = 0; k < n; ++k) {
            double at = std::cos(pi * (k + 0.75) / (n + 0.5)), slope = 1;
            for (int turn = 0; turn < 10; ++turn) {
                double P = 1, before = 0;
                for (int j = 1; j <= n; ++j) {
                    const double next = ((2 * j - 1) * at * P - (j - 1) * before) / j;
                    before = P, P = next;
                }
                slope = n * (at * P - before) / (at * at - 1);
                at -= P / slope;
            }
            x[static_cast<std::size_t>(k)] = at;
            weight[static_cast<std::size_t>(k)] = 2 / ((1 - at * at) * slope * slope);
        }
    }
    /// ∫ f from a to b
    template <class F>
    void operator()(double a, double b, const F& f) const
    {
        for (std::size_t k = 0; k < n; ++k)
            f(0.5 * (a + b) + 0.5 * (b - a) * x[k], 0.5 * (b - a) * weight[k]);
    }
};

struct Disc {
    double x, y, radius;
};

/// Moments of a plane region
struct Slice {
    double area = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;  ///< ∫ dA, ∫ x dA, ...
};

/// Adds the integrals along the arc of a disc from the angle a to b.
void add_arc(const Disc& d, double a, double b, Slice& sum)
{
    static const Gauss<16> gauss;
    const int parts = static_cast<int>((b - a) / (0.5 * pi)) + 1;
    for (int part = 0; part < parts; ++part)
        gauss(a + (b - a) * part / parts, a + (b - a) * (part + 1) / parts, [&](double angle, double weight) {
            const double c = std::cos(angle), s = std::sin(angle), x = d.x + d.radius * c,
                         y = d.y + d.radius * s, dx = -d.radius * s * weight, dy = d.radius * c * weight;
            sum.area += 0.5 * (x * dy - y * dx);
            sum.x += 0.5 * x * x * dy, sum.y -= 0.5 * y * y * dx;
            sum.xx += x * x * x / 3 * dy, sum.yy -= y * y * y / 3 * dx, sum.xy += 0.5 * x * x * y * dy;
        });
}

/// Adds the part of the border of disc i that is in no other disc.
void add_border(const std::vector<Disc>& discs, std::size_t i, Slice& sum)
{
    const Disc& d = discs[i];
    std::vector<std::pair<double, double>> hidden;  // intervals of the angle within [0, 2π]
    for (std::size_t j = 0; j < discs.size(); ++j) {
        if (j == i) continue;
        const Disc& o = discs[j];
        const double x = o.x - d.x, y = o.y - d.y, apart = std::hypot(x, y);
        const bool is_same = apart == 0 && o.radius == d.radius;
        if (is_same ? j < i : apart + d.radius <= o.radius) return;
        if (is_same || apart >= d.radius + o.radius || apart + o.radius <= d.radius) continue;
        const double cosine =
            (apart * apart + d.radius * d.radius - o.radius * o.radius) / (2 * apart * d.radius);
        const double half = std::acos(std::clamp(cosine, -1.0, 1.0));
        double from = std::atan2(y, x) - half;
        if (from < 0) from += 2 * pi;
        const double to = from + 2 * half;
        hidden.emplace_back(from, std::min(to, 2 * pi));
        if (to > 2 * pi) hidden.emplace_back(0, to - 2 * pi);
    }
    std::sort(hidden.begin(), hidden.end());
    double at = 0;
    for (const auto& [from, to] : hidden) {
        if (from > at) add_arc(d, at, from, sum);
        at = std::max(at, to);
    }
    if (at < 2 * pi) add_arc(d, at, 2 * pi, sum);
}

Slice slice(const std::vector<Sphere>& spheres, double z)
{
    std::vector<Disc> discs;
    for (const Sphere& s : spheres) {
        const double h = z - s.r.z, square = (s.radius - h) * (s.radius + h);
        if (square > 0) discs.push_back({s.r.x, s.r.y, std::sqrt(square)});
    }
    Slice sum;
    for (std::size_t i = 0; i < discs.size(); ++i) add_border(discs, i, sum);
    return sum;
}

/// The spheres intersect in a circle.
bool intersect(const Sphere& a, const Sphere& b)
{
    const double d = (b.r - a.r).norm();
    return d < a.radius + b.radius && d > std::abs(a.radius - b.radius);
}

/// Adds the heights of the two points that are on three spheres, if there are any.
void add_common_points(const Sphere& a, const Sphere& b, const Sphere& c, std::vector<double>& heights)
{
    const double d = (b.r - a.r).norm();
    const Vec3 e_x = (1 / d) * (b.r - a.r), to_c = c.r - a.r;
    const double i = e_x.dot(to_c);
    const Vec3 across = to_c - i * e_x;
    const double j = across.norm();
    if (!(j > 1e-12 * d)) return;
    const Vec3 e_y = (1 / j) * across, e_z = e_x.cross(e_y);
    const double R2 = a.radius * a.radius, x = (R2 - b.radius * b.radius + d * d) / (2 * d),
                 y = (R2 - c.radius * c.radius + i * i + j * j - 2 * i * x) / (2 * j),
                 z2 = R2 - x * x - y * y;
    if (!(z2 >= 0)) return;
    const double height = a.r.z + x * e_x.z + y * e_y.z, up = std::sqrt(z2) * e_z.z;
    heights.push_back(height - up), heights.push_back(height + up);
}

/// Heights at which the border of the slices changes its form
std::vector<double> changes(const std::vector<Sphere>& s)
{
    std::vector<double> heights;
    for (std::size_t i = 0; i < s.size(); ++i) {
        heights.push_back(s[i].r.z - s[i].radius), heights.push_back(s[i].r.z + s[i].radius);
        for (std::size_t j = 0; j < i; ++j) {
            if (!intersect(s[i], s[j])) continue;
            const Vec3 apart = s[j].r - s[i].r;
            const double d = apart.norm(), R = s[i].radius,
                         along = (d * d + R * R - s[j].radius * s[j].radius) / (2 * d),
                         radius = std::sqrt(std::max(0., R * R - along * along)), up = apart.z / d,
                         reach = radius * std::sqrt(std::max(0., 1 - up * up));
            heights.push_back(s[i].r.z + along * up - reach),
                heights.push_back(s[i].r.z + along * up + reach);
            for (std::size_t k = 0; k < j; ++k)
                if (intersect(s[i], s[k]) && intersect(s[j], s[k]))
                    add_common_points(s[i], s[j], s[k], heights);
        }
    }
    std::sort(heights.begin(), heights.end());
    return heights;
}

/// Volume and moments about the origin: ∫ dV, ∫ r dV, ∫ x² dV, ...
struct Moments {
    double volume = 0;
    Vec3 first{0, 0, 0};
    double xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;
};

Moments without_overlaps(const std::vector<Sphere>& spheres)
{
    Moments m;
    for (const auto& [r, R] : spheres) {
        const double V = sphere_volume(R), own = 0.2 * R * R;  // ∫ (x - x_c)² dV/V
        m.volume += V, m.first += V * r;
        m.xx += V * (r.x * r.x + own), m.yy += V * (r.y * r.y + own), m.zz += V * (r.z * r.z + own);
        m.xy += V * r.x * r.y, m.yz += V * r.y * r.z, m.zx += V * r.z * r.x;
    }
    return m;
}

Moments with_overlaps(const std::vector<Sphere>& spheres)
{
    static const Gauss<24> gauss;
    const std::vector<double> heights = changes(spheres);
    const double least = 1e-13 * (heights.back() - heights.front());
    Moments m;
    for (std::size_t k = 0; k + 1 < heights.size(); ++k) {
        const double a = heights[k], b = heights[k + 1];
        if (!(b - a > least)) continue;
        // The borders change with the root of the distance from a and b: z = (a + b)/2 - (b - a)/2 cos u.
        gauss(0, pi, [&](double u, double weight) {
            const double z = a + (b - a) * std::sin(0.5 * u) * std::sin(0.5 * u);
            const double dz = 0.5 * (b - a) * std::sin(u) * weight;
            const Slice s = slice(spheres, z);
            m.volume += dz * s.area;
            m.first += dz * Vec3{s.x, s.y, z * s.area};
            m.xx += dz * s.xx, m.yy += dz * s.yy, m.zz += dz * z * z * s.area;
            m.xy += dz * s.xy, m.yz += dz * z * s.y, m.zx += dz * z * s.x;
        });
    }
    return m;
}

}  // namespace

MassProperties sphere_union(const std::vector<Sphere>& spheres)
{
    // coordinates relative to the middle
    Vec3 middle = spheres[0].r;
    for (std::size_t k = 1; k < spheres.size(); ++k)
        middle += (1 / static_cast<double>(k + 1)) * (spheres[k].r - middle);
    std::vector<Sphere> moved = spheres;
    for (Sphere& s : moved) s.r -= middle;
    bool overlap = false;
    for (std::size_t i = 0; i < moved.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            overlap = overlap || (moved[i].r - moved[j].r).norm() < moved[i].radius + moved[j].radius;
    const Moments m = overlap ? with_overlaps(moved) : without_overlaps(moved);
    const double V = m.volume;
    const Vec3 c = (1 / V) * m.first;
    const double xx = m.xx - V * c.x * c.x, yy = m.yy - V * c.y * c.y, zz = m.zz - V * c.z * c.z;
    return {V,
            middle + c,
            {yy + zz, zz + xx, xx + yy, -(m.xy - V * c.x * c.y), -(m.yz - V * c.y * c.z),
             -(m.zx - V * c.z * c.x)}};
}

}  // namespace hilda::granular
