// SPDX-License-Identifier: GPL-3.0-or-later
/// Hand-over of the history of a contact from one triangle of a mesh to another.

#pragma once

#include "granular/core/contact_loop.hpp"

namespace hilda::granular {

/// Whether a pair has a triangle
struct HasTriangle {
    const std::uint32_t* j;
    HILDA_HD bool operator()(std::uint32_t n) const
    {
        return (j[n] & PairView::boundary_bit) != 0 && Surfaces::is_triangle(j[n] & ~PairView::boundary_bit);
    }
};

/// When the closest point of a particle passes from one triangle of a mesh to another one, the contact of
/// the first ends and that of the second begins. The second then continues the history of the first, if
/// their normals differ by at most 60 degrees: the force laws project the displacements on the new tangent
/// plane. Before find_loads(), one call per listed pair; that of the first triangle of a particle does the
/// work for all of its triangles, which are the last pairs of its row.
struct HandOver {
    static constexpr double least_cosine = 0.5;  ///< of the angle between the normals
    /// Largest distance of the two closest points, in radii. A contact that begins elsewhere is a new one.
    static constexpr double most_apart = 0.5;

    ParticleView particles;
    PairView pairs;
    Surfaces surfaces;
    const std::uint32_t* which;  ///< numbers of the pairs with triangles
    const std::uint32_t* start;  ///< of the rows

    HILDA_HD std::uint32_t surface(std::uint32_t n) const { return pairs.j[n] & ~PairView::boundary_bit; }

    HILDA_HD void operator()(std::uint32_t k) const
    {
        const std::uint32_t begin = which[k];
        if (begin == start[pairs.i[begin]] || !HasTriangle{pairs.j}(begin - 1)) within_row(begin);
    }
    /// Hands over among the triangles of a particle; `begin` is its first pair with a triangle.
    HILDA_HD void within_row(std::uint32_t begin) const
    {
        const std::uint32_t i = pairs.i[begin], end = start[i + 1];
        std::uint32_t contacts = 0;
        for (std::uint32_t n = begin; n < end; ++n) contacts += pairs.in_contact[n] != 0 ? 1 : 0;
        if (contacts == 0 || contacts == end - begin) return;
        const Vec3 r = global_position(particles.grid, particles.position[i]);
        const double R = particles.velocity[i].w;
        for (std::uint32_t n = begin; n < end; ++n)
            if (pairs.in_contact[n] != 0 && !(surfaces.nearest(surface(n), r, R).distance < R))
                pass_on(n, begin, end, r, R);
    }

    /// Passes the history of the pair n, whose contact has ended, to a pair whose contact begins.
    HILDA_HD void pass_on(std::uint32_t n, std::uint32_t begin, std::uint32_t end, const Vec3& r,
                          double R) const
    {
        const Vec3 from = surfaces.closest_point(surface(n), r), d = r - from;
        double least = most_apart * R;
        std::uint32_t to = n;
        for (std::uint32_t m = begin; m < end; ++m) {
            if (pairs.in_contact[m] != 0 ||
                surfaces.boundary_of(surface(m)) != surfaces.boundary_of(surface(n)))
                continue;
            const Nearest near = surfaces.nearest(surface(m), r, R);
            if (!(near.distance < R) || near.n.dot(d) < least_cosine * d.norm()) continue;
            const double apart = (r - near.distance * near.n - from).norm();
            if (apart < least) least = apart, to = m;
        }
        if (to == n) return;
        pairs.in_contact[to] = 1, pairs.in_contact[n] = 0;
        move(pairs.history, n, to), move(pairs.rotation_history, n, to), move(pairs.internal, n, to);
        if (pairs.load == nullptr) return;
        pairs.load_of(n) = {};
        if (pairs.rotation_history != nullptr) pairs.torque_of(n) = {};
    }
    HILDA_HD static void move(Float4* values, std::uint32_t from, std::uint32_t to)
    {
        if (values != nullptr) values[to] = values[from], values[from] = {};
    }
};

}  // namespace hilda::granular
