// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/boundary_list.hpp"

#include "granular/case/falling_tools.hpp"

#include <algorithm>

namespace hilda::granular {

void BoundaryList::read(ObjectReader& o, const EntryKeys& keys)
{
    const auto& type = io::read_type<BoundaryType>(o, {"Boundary", "type", "Type of the boundary."});
    const std::string name =
        o.name("name",
               {.text = "Name of the boundary in the columns of run.csv. It must be unique, without commas, "
                        "quotes and line ends. By default 'boundary' and its number, counted from 0.",
                .example = R"("floor")",
                .rest = R"("pattern": "^[^,\"]*$")",
                .computed = true},
               "boundary " + std::to_string(bounds.size()));
    if (name.find_first_of(",\"") != std::string::npos)
        o.fail("name", "name must not contain commas and quotes, because it is part of column names, got " +
                           io::described(name));
    const int material = keys.material(o);
    for (NamedBoundary& n : read_boundary(o, type, name)) {
        if (find(n.name) != nullptr)
            o.fail("name", "two boundaries have the same name, got " + io::described(n.name));
        n.boundary.material = material;
        bounds.emplace_back(std::move(n), o);
        out.entry_of_boundary.push_back(entry);
    }
    o.finish();
    ++entry;
}

void BoundaryList::add(EntryKeys& keys)
{
    sum_parts();
    for (auto& [n, o] : bounds) add(n, o, keys);
    set_parts();
}

void BoundaryList::check_tools(const Vec3& gravity)
{
    for (const FallingTool& tool : falling_tools(*out.world, out.boundaries, gravity))
        out.notices.push_back(bounds[static_cast<std::size_t>(tool.boundary)].second.place() + ": " +
                              tool.text);
}

/// The boundary with this name, or nullptr
const NamedBoundary* BoundaryList::find(const std::string& name) const
{
    const auto at =
        std::find_if(bounds.begin(), bounds.end(), [&](const auto& b) { return b.first.name == name; });
    return at == bounds.end() ? nullptr : &at->first;
}

/// Checks the keys part_of, and sets the mass properties of the bodies that take them from their parts.
void BoundaryList::sum_parts()
{
    for (const auto& [n, o] : bounds) {
        if (n.part_of.empty()) continue;
        const NamedBoundary* const body = find(n.part_of);
        if (body == nullptr)
            o.fail("part_of", "part_of must name a boundary, got " + io::described(n.part_of));
        if (!body->part_of.empty())
            o.fail("part_of", "part_of must name a boundary that is not a part itself, got " +
                                  io::described(n.part_of) + ", which is a part of " +
                                  io::described(body->part_of));
        if (body->sums_parts && !n.solid)
            o.fail("", "a part of " + io::described(n.part_of) +
                           ", which has from_parts, needs a density of its solid, got none");
        if (!body->sums_parts && n.solid)
            o.fail("density", "density of a part needs a body with from_parts true, got " +
                                  io::described(n.part_of) + " without it");
    }
    for (auto& [n, o] : bounds) {
        if (!n.sums_parts) continue;
        std::vector<PlacedSolid> solids;
        for (const auto& other : bounds)
            if (other.first.part_of == n.name)
                solids.push_back({*other.first.solid, other.first.boundary.r, other.first.boundary.p});
        if (solids.empty()) o.fail("from_parts", "from_parts needs parts with part_of, got none");
        const SolidBody body = sum(solids);
        n.boundary.mass = body.mass, n.boundary.inertia = body.inertia, n.boundary.r = body.centre;
    }
}

void BoundaryList::add(NamedBoundary& n, ObjectReader& o, EntryKeys& keys)
{
    n.motion.boundary = o.located([&] {
        return n.mesh ? out.world->add(n.boundary, *n.mesh, n.two_sided) : out.world->add(n.boundary);
    });
    if (!n.notice.empty()) out.notices.push_back(o.place("file") + ": " + n.notice);
    surfaces.add(o.place(), n, *out.world, out.notices);
    n.mesh.reset();  // the world has its triangles
    if (n.motion.is_prescribed()) motions.emplace_back(n.motion, o);
    if (n.part_of.empty() ? n.moves() : find(n.part_of)->moves()) out.moving.push_back(n.motion.boundary);
    if (n.boundary.mass > 0 && keys.free.empty()) keys.free = o.pointer();
    out.boundaries.push_back(n.name);
}

/// Attaches the parts to their bodies.
void BoundaryList::set_parts() const
{
    for (const auto& [n, o] : bounds)
        if (!n.part_of.empty())
            o.located([&, &part = n] {
                out.world->set_part(part.motion.boundary, find(part.part_of)->motion.boundary);
            });
    out.world->set_boundary_names(out.boundaries);
}

void BoundaryList::start_motions() const
{
    for (const auto& [motion, o] : motions) {
        out.motions->push_back(motion);
        try {
            apply_motions(*out.world, {motion}, out.h);
        } catch (const NotFinite& e) {
            o.fail(e.what());
        }
    }
    out.world->before_each_step([all = out.motions, h = out.h](World& w) { apply_motions(w, *all, h); });
}

}  // namespace hilda::granular
