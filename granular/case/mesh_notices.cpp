// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/mesh_notices.hpp"

#include "io/message.hpp"

#include <algorithm>
#include <tuple>

namespace hilda::granular {

void MeshNotices::add(const std::string& place, const NamedBoundary& b, const World& world, Notices& to)
{
    BoundingBox box;
    for (const Vec3& v : b.mesh->vertex) box.add(b.boundary.r + rotated(b.boundary.p, v));
    // The volume has no meaning for an open mesh.
    all.push_back(
        {place, box, !b.two_sided && mass_properties(*b.mesh).volume < 0 && open_edges(*b.mesh) == 0});
    const Vec3 low = world.low(), high = world.high();
    for (const auto& [axis, from, until, least, most] : {std::tuple{0u, box.low.x, box.high.x, low.x, high.x},
                                                         {1u, box.low.y, box.high.y, low.y, high.y},
                                                         {2u, box.low.z, box.high.z, low.z, high.z}}) {
        const std::string mesh = place + ": the mesh ";
        if (until < least || from > most)
            to.push_back(mesh + "is outside of the domain along " + "xyz"[axis]);
        else if (world.periodic()[axis] && (from <= least || until >= most))
            to.push_back(mesh + "reaches a periodic side along " + "xyz"[axis] +
                         ", across which it has no images: it acts as a periodic one only if its shape does "
                         "not change along this axis and it extends beyond both sides by the radius of a "
                         "particle");
    }
}

void MeshNotices::check_sizes(const World& world, double diameter, Notices& to) const
{
    const double domain = (world.high() - world.low()).norm();
    for (const Mesh& m : all)
        if (const double size = (m.box.high - m.box.low).norm(); size > 100 * domain || size < 0.1 * diameter)
            to.push_back(m.place +
                         io::formatted(": the mesh is %.3g m long, the %s %.3g m: its coordinates must be in "
                                       "m, or have the key scale",
                                       size, size > domain ? "domain" : "diameter of a particle",
                                       size > domain ? domain : diameter));
}

void MeshNotices::check_sides(const World& world, Notices& to) const
{
    for (const Mesh& m : all) {
        if (!m.faces_inwards) continue;
        std::size_t count = 0, outside = 0;
        world.each_particle([&](const Particle& p) {
            const Vec3 a = p.r - m.box.low, b = m.box.high - p.r;
            ++count, outside += std::min({a.x, a.y, a.z, b.x, b.y, b.z}) < 0 ? 1 : 0;
        });
        if (outside > 0)
            to.push_back(m.place + ": the mesh is closed and its normals point inwards, but " +
                         std::to_string(outside) + " of " + std::to_string(count) +
                         " particles are outside of it, where they do not touch it: for particles outside a "
                         "box needs inside false, and other meshes the reverse order of vertices");
    }
}

}  // namespace hilda::granular
