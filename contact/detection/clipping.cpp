// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/clipping.hpp"

#include "contact/detection/manifold.hpp"
#include "contact/surfaces/area_shares.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace hilda::contact {

namespace {

constexpr double direction_of_first = 0.1;  // [rad], so that regular polygons have no ties

}  // namespace

void ClippedFace::set(const PlacedCore& reference, int f, const Vec3& n, const PlacedCore& incident,
                      double length)
{
    const Polytope& body = incident.core;
    const Polytope::Face& face = reference.core.face[static_cast<std::size_t>(f)];
    corner.clear();
    if (body.face.empty()) {
        for (std::size_t k = 0; k < body.vertex.size(); ++k)
            corner.push_back({incident.vertex[k], 0, static_cast<int>(k), 0, 0});
    } else {
        std::size_t opposite = 0;
        double least = 2;
        for (std::size_t k = 0; k < body.face.size(); ++k)
            if (const double cosine = incident.normal(static_cast<int>(k)).dot(n); cosine < least)
                least = cosine, opposite = k;
        const Polytope::Face& of = body.face[opposite];
        const std::size_t m = of.vertex.size();
        for (std::size_t k = 0; k < m; ++k)
            corner.push_back(
                {incident.at(of.vertex[k]), of.edge[k], of.vertex[k], of.edge[(k + m - 1) % m], 0});
    }
    for (std::size_t s = 0; s < face.vertex.size() && !corner.empty(); ++s) {
        const Vec3 &p = reference.at(face.vertex[s]),
                   &q = reference.at(face.vertex[(s + 1) % face.vertex.size()]);
        const Vec3 outward = (q - p).cross(n).normalized();
        clip(outward, outward.dot(p), first_side + static_cast<int>(s), length);
    }
    outline.clear();
    for (const Corner& c : corner) outline.push_back(c.x);
    area_shares(outline, share);
    for (std::size_t k = 0; k < corner.size(); ++k) corner[k].share = share[k];
}

/// Removes what is outside of a side. Corners near the side are kept as they are, without a second point at
/// the same place.
void ClippedFace::clip(const Vec3& outward, double limit, int side, double length)
{
    other.clear();
    const std::size_t m = corner.size();
    const bool is_polygon = m > 2;
    for (std::size_t k = 0; k < m; ++k) {
        const Corner &c = corner[k], &next = corner[(k + 1) % m];
        const double h = outward.dot(c.x) - limit, h_next = outward.dot(next.x) - limit;
        if (h <= length) other.push_back(c);
        if (m == 1 || (!is_polygon && k == 1)) continue;
        const bool leaves = h < -length && h_next > length, enters = h > length && h_next < -length;
        if (!leaves && !enters) continue;
        const Vec3 x = c.x + h / (h - h_next) * (next.x - c.x);
        if (!is_polygon || enters)
            other.push_back({x, c.side, -1, side, 0});
        else
            other.push_back({x, side, -1, c.side, 0});
    }
    corner.swap(other);
}

/// Moves the corner with the largest measure to `other`.
template <class Measure>
void ContactCorners::take_largest(const Measure& measure)
{
    std::size_t best = 0;
    for (std::size_t k = 1; k < corner.size(); ++k)
        if (measure(corner[k].x) > measure(corner[best].x)) best = k;
    other.push_back(corner[best]);
    corner.erase(corner.begin() + static_cast<std::ptrdiff_t>(best));
}

/// Moves the corners that are farthest in directions across n to `other`, until it has `most`.
void ContactCorners::take_farthest(const Vec3& n, int most)
{
    const Vec3 u = n.unitOrthogonal(), w = n.cross(u);
    while (other.size() < static_cast<std::size_t>(most)) {
        const double angle =
            direction_of_first + 2 * std::numbers::pi * static_cast<double>(other.size()) / most;
        take_largest([&](const Vec3& x) { return std::cos(angle) * u.dot(x) + std::sin(angle) * w.dot(x); });
    }
}

void ContactCorners::keep(const Vec3& n, const Vec3& p, double reach, int most)
{
    std::erase_if(corner, [&](const Corner& c) { return !(n.dot(c.x - p) < reach); });
    if (corner.size() <= static_cast<std::size_t>(most)) return;
    other.clear();
    take_largest([&](const Vec3& x) { return -n.dot(x); });
    take_farthest(n, most);
    corner.swap(other);
}

bool ContactCorners::merge(const Vec3& n, const Vec3& p, double overlaps_below, int most)
{
    const auto overlap = [&](const Corner& c) { return overlaps_below - n.dot(c.x - p); };
    if (corner.size() <= static_cast<std::size_t>(most)) return false;
    std::erase_if(corner, [&](const Corner& c) { return !(overlap(c) > 0); });
    if (corner.size() <= static_cast<std::size_t>(most)) return false;
    other.clear();
    take_farthest(n, most);
    std::array<MergedPoint, Manifold::most> merged;
    for (std::size_t k = 0; k < other.size(); ++k)
        merged[k].add(other[k].share, overlap(other[k]), other[k].x);
    for (const Corner& left : corner) {
        std::size_t nearest = 0;
        for (std::size_t k = 1; k < other.size(); ++k)
            if ((other[k].x - left.x).squaredNorm() < (other[nearest].x - left.x).squaredNorm()) nearest = k;
        merged[nearest].add(left.share, overlap(left), left.x);
    }
    for (std::size_t k = 0; k < other.size(); ++k)
        other[k].x = merged[k].place(other[k].x), other[k].share = merged[k].share();
    corner.swap(other);
    return true;
}

TouchingParts ClippedFace::parts(const Corner& c, const Polytope::Face& reference) const
{
    if (c.vertex >= 0) return {TouchingParts::any, static_cast<std::uint32_t>(c.vertex)};
    const auto number = [](int side) { return static_cast<std::size_t>(side - first_side); };
    if (std::min(c.side, c.side_before) >= first_side) {  // a vertex of the reference face
        const std::size_t m = reference.vertex.size(), s = number(c.side), t = number(c.side_before);
        return {static_cast<std::uint32_t>(reference.vertex[(t + 1) % m == s ? s : t]), TouchingParts::any};
    }
    const int side = std::max(c.side, c.side_before), edge = std::min(c.side, c.side_before);
    return TouchingParts::edges(reference.edge[number(side)], edge);
}

}  // namespace hilda::contact
