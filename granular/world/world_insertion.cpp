// SPDX-License-Identifier: GPL-3.0-or-later
// How particles come into a world: into cells that are wide enough, with laws for all that may meet.
#include "granular/world/world_impl.hpp"

#include <algorithm>

namespace hilda::granular {

using namespace detail;

std::uint32_t World::add(const Particle& p)
{
    const auto id = static_cast<std::uint32_t>(count());
    const std::string where = "particle " + std::to_string(id);
    if (!(p.radius > 0) || !std::isfinite(p.radius)) refuse(where, "the radius must be positive", p.radius);
    if (!finite(p.r) || !finite(p.v) || !finite(p.omega))
        refuse(where, "place and velocities must be finite", p.r.x);
    if (p.material < 0 || p.material >= static_cast<int>(materials.size()))
        refuse(where, "no material has this number", p.material);
    if (!(std::abs(length(p.e) - 1) < 1e-3))
        refuse(where, "Euler parameters must have the length 1, to a thousandth", length(p.e));
    if (!options.orientation && p.e != Particle().e)
        refuse(where, "has an orientation, and this world keeps none; e0", p.e[0]);
    if (!(p.mass >= 0) || !std::isfinite(p.mass)) refuse(where, "the mass must not be negative", p.mass);
    pending.push_back(p);
    if (!(p.mass > 0))
        pending.back().mass = sphere_mass(p.radius, materials[static_cast<std::size_t>(p.material)].density);
    return id;
}

/// Cells for particles as large as the largest of these
Scene World::scene_of(const std::vector<Particle>& all) const
{
    Scene in;
    CellGrid& grid = in.grid;
    double largest = 0;
    in.radius = static_cast<float>(all[0].radius);
    for (const Particle& p : all) {
        largest = std::max(largest, 2 * p.radius);
        if (static_cast<float>(p.radius) != in.radius) in.radius = 0;
        in.replicas = std::max(in.replicas, std::uint32_t{p.replica} + 1);
    }
    in.skin = static_cast<float>(options.skin * largest);
    const double edge = largest + in.skin;
    const double low[] = {options.low.x, options.low.y, options.low.z},
                 high[] = {options.high.x, options.high.y, options.high.z};
    double widest = edge;
    for (int k = 0; k < 3; ++k) {
        grid.low[k] = low[k];
        grid.periodic[k] = options.periodic[k];
        const double length = high[k] - low[k];
        const double cells = options.periodic[k] ? std::floor(length / edge) : std::ceil(length / edge);
        const int most = k == 2 ? 1 << CellGrid::bits_z : 1 << CellGrid::bits_y;
        if (cells > most)
            refuse("domain",
                   "is more cells wide than " + std::to_string(most) + "; a cell is a diameter and the skin",
                   cells);
        if (options.periodic[k] && cells < 3)
            refuse("domain", "must be three largest diameters wide, with the skin, where it is periodic",
                   length);
        grid.cells[k] = static_cast<std::int32_t>(cells);
        if (options.periodic[k]) widest = std::max(widest, length / cells);
    }
    const double cells = double(in.replicas) * grid.cells[0] * grid.cells[1] * grid.cells[2];
    if (cells > 0x7fffffff) refuse("domain", "has more than 2^31 cells, with all of its replicas", cells);
    grid.unit = widest / CellGrid::widest;
    for (int k = 0; k < 3; ++k) {
        const double length = high[k] - low[k];
        grid.width[k] = static_cast<std::int32_t>(
            std::lround((options.periodic[k] ? length / grid.cells[k] : edge) / grid.unit));
        grid.last[k] = static_cast<std::int32_t>(
            std::lround(length / grid.unit - double(grid.width[k]) * (grid.cells[k] - 1)));
    }
    return in;
}

/// Cells and places in them. ParticleLost for one that had left the domain; InvalidCase for one that was never in it.
std::vector<World::Placed> World::places(const Scene& in, const std::vector<Particle>& all) const
{
    const CellGrid& grid = in.grid;
    std::vector<Placed> placed(all.size());
    for (std::uint32_t k = 0; k < all.size(); ++k) {
        std::int32_t cell[3], at[3];
        float left[3];
        const double r[] = {all[k].r.x, all[k].r.y, all[k].r.z};
        for (int c = 0; c < 3; ++c) {
            double units = (r[c] - grid.low[c]) / grid.unit;
            const double length = double(grid.width[c]) * (grid.cells[c] - 1) + grid.last[c];
            if (grid.periodic[c] != 0) {
                units -= length * std::floor(units / length);
            } else if (!(units >= 0 && units <= length)) {
                if (k >= particles_in)
                    refuse(name_of(k), std::string("is outside the domain along ") + "xyz"[c], r[c]);
                const std::uint32_t* id = engine->arrays().particle.id.data();
                lose(static_cast<std::uint32_t>(std::find(id, id + particles_in, k) - id),
                     "has left the domain");
            }
            const double whole = std::min(std::floor(units / grid.width[c]), double(grid.cells[c] - 1));
            cell[c] = static_cast<std::int32_t>(whole);
            const double in_cell = units - whole * grid.width[c];
            at[c] = static_cast<std::int32_t>(std::lround(in_cell));
            left[c] = static_cast<float>(in_cell - at[c]);
        }
        placed[k] = {{CellGrid::pack(cell[0], cell[1], cell[2]), at[0], at[1], at[2]},
                     {left[0], left[1], left[2]}};
    }
    return placed;
}

/// Those that were added since the last step become part of the arrays, which are then in the order of the ids. What is
/// refused before that leaves the world as it was.
void World::insert_pending()
{
    if (!refused.empty()) throw InvalidCase(refused);
    if (pending.empty()) return;
    if (laws.empty()) refuse("world", "no law is set for its materials", "none");
    const std::vector<Particle> all = particles();
    const Scene next = scene_of(all);
    const std::vector<Placed> placed = places(next, all);
    check_laws(all);
    Arrays<par::Cpu>& a = engine->arrays();
    const auto first = static_cast<std::uint32_t>(particles_in);
    scene = next;

    // contacts and accelerations of those that are there go on
    Particles<par::Cpu>& p = a.particle;
    const auto id = [&](std::uint32_t k) { return p.id.data()[k]; };
    for (std::uint32_t n = 0; n < a.pairs.count; ++n) {
        std::uint32_t &i = a.pairs.i.data()[n], &j = a.pairs.j.data()[n];
        i = id(i);
        if ((j & PairView::boundary) == 0) j = id(j);
    }
    std::vector<Four> acc_of(all.size(), to_four(options.gravity, 0)), turn_of(all.size());
    for (std::uint32_t k = 0; k < p.acc.size(); ++k)
        acc_of[id(k)] = p.acc.data()[k], turn_of[id(k)] = p.turn.data()[k];

    p.resize(static_cast<std::uint32_t>(all.size()));
    for (std::uint32_t k = 0; k < p.count; ++k) {
        const Particle& one = all[k];
        const Carried<float> left = carried(placed[k].left, 0);
        const Position at = placed[k].position;
        p.position.data()[k] = {at.cell, at.x + left.x, at.y + left.y, at.z + left.z};
        p.velocity.data()[k] = to_four(one.v, one.radius);
        p.omega.data()[k] = to_four(one.omega, one.fixed ? 0 : 1 / one.mass);
        p.kind.data()[k] = {.material = static_cast<std::uint16_t>(one.material), .replica = one.replica};
        Compensation& rest = p.rest.data()[k] = {.way = left.word};
        put_halves(rest.v, left_of(one.v), to_nearest);
        put_halves(rest.omega, left_of(one.omega), to_nearest);
        p.id.data()[k] = k;
    }
    if (keeps_accelerations(options.scheme)) {
        p.acc.resize(p.count), p.turn.resize(p.count);
        std::copy(acc_of.begin(), acc_of.end(), p.acc.data());
        std::copy(turn_of.begin(), turn_of.end(), p.turn.data());
    }
    if (options.orientation) {
        p.orientation.resize(p.count), p.orientation_rest.resize(p.count);
        for (std::uint32_t k = 0; k < p.count; ++k) {
            const auto [e0, e1, e2, e3] = unit(all[k].e);
            p.orientation.data()[k] = to_four({e0, e1, e2}, e3);
            p.orientation_rest.data()[k] = {left_of(e0), left_of(e1), left_of(e2), left_of(e3)};
        }
    }
    pending.clear();
    particles_in = all.size();
    if (!forces.empty()) forces.resize(all.size()), forces_changed = true;
    engine->written();
    look_for_neighbours();
    try {
        check_overlaps(first);
    } catch (const InvalidCase& e) {
        refused = e.what();
        throw;
    }
}

/// All materials that may meet have a law.
void World::check_laws(const std::vector<Particle>& particles) const
{
    const std::size_t n = materials.size();
    std::vector<char> of_particles(n, 0), all(n, 0);
    std::uint16_t replica = 0;
    for (const Particle& p : particles)
        of_particles[static_cast<std::size_t>(p.material)] = 1, replica = std::max(replica, p.replica);
    all = of_particles;
    for (const Boundary& b : boundaries) {
        all[static_cast<std::size_t>(b.material)] = 1;
        if (b.mass > 0 && replica > 0)
            refuse("boundary", "one that is free cannot be in all replicas, of which the last is", replica);
    }
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
            if (of_particles[i] != 0 && all[j] != 0 && law_of[i * n + j] == no_law)
                refuse("laws", "there is none between two materials that may meet",
                       "'" + materials[i].name + "' and '" + materials[j].name + "'");
}

/// Where particles begin, they are not pressed into each other or into a boundary: those from the first new one on.
void World::check_overlaps(std::uint32_t first) const
{
    constexpr double deepest = 0.05;  // of the smaller radius
    const std::vector<Particle> all = particles();
    for (const ContactRecord& c : contacts()) {
        if (c.i < first && (c.boundary || c.j < first)) continue;
        const double R = c.boundary ? all[c.i].radius : std::min(all[c.i].radius, all[c.j].radius);
        if (c.delta > deepest * R)
            refuse(name_of(c.i) + " and " + (c.boundary ? "boundary " + std::to_string(c.j) : name_of(c.j)),
                   "must not overlap by more than 5 % of a radius at the start", c.delta);
    }
}

}  // namespace hilda::granular
