// SPDX-License-Identifier: GPL-3.0-or-later
// Insertion of particles into a world: choice of the cell grid, conversion of positions, checks of laws and
// overlaps.
#include "granular/world/world_impl.hpp"
#include "io/error.hpp"
#include "io/message.hpp"

#include <algorithm>
#include <bit>
#include <tuple>
#include <utility>

namespace hilda::granular {

using namespace detail;

namespace {

/// The separations of the pairs [m]; zero for those with boundaries and without contact
std::vector<Vec3> separations(const CellGrid& g, const Arrays<par::Cpu>& a)
{
    std::vector<Vec3> all(a.pairs.count);
    for (std::uint32_t n = 0; n < a.pairs.count; ++n)
        if (a.pairs.in_contact.data()[n] != 0 && (a.pairs.j.data()[n] & PairView::boundary_bit) == 0)
            all[n] = separation(g, a, n);
    return all;
}

/// Sets the images of the pairs to those with these separations, in a new domain.
void set_images(const Domain& domain, Arrays<par::Cpu>& a, const std::vector<Vec3>& apart)
{
    const CellGrid& g = domain.grid;
    a.pairs.image.resize(a.pairs.count);
    for (std::uint32_t n = 0; n < a.pairs.count; ++n) {
        a.pairs.image.data()[n] = Image::none;
        if (a.pairs.in_contact.data()[n] == 0 || (a.pairs.j.data()[n] & PairView::boundary_bit) != 0)
            continue;
        const Vec3 d = separation(g, a, n) - apart[n];
        const Position* const position = a.particle.position.data();
        const std::uint32_t i = position[a.pairs.i.data()[n]].cell, j = position[a.pairs.j.data()[n]].cell;
        const auto periods = [&](double x, std::int32_t cell_i, std::int32_t cell_j, int axis) {
            if (!domain.is_short(axis)) return nearest_period(cell_i, cell_j, g, axis);
            const long whole = std::lround(x / (g.unit * g.width[axis] * g.cells[axis]));
            return static_cast<std::int32_t>(std::clamp(whole, -1L, 1L));
        };
        a.pairs.image.data()[n] =
            Image::pack(periods(d.x, g.x_of(i), g.x_of(j), 0), periods(d.y, g.y_of(i), g.y_of(j), 1),
                        periods(d.z, g.z_of(i), g.z_of(j), 2));
    }
}

}  // namespace

/// The particle with its mass, and fixed if it is attached. Throws io::InvalidInput if it is not valid.
Particle World::checked(const Particle& p, const std::string& where) const
{
    // Radius, velocities, mass and its inverse are stored in single precision.
    constexpr double least = std::numeric_limits<float>::min(), most = std::numeric_limits<float>::max();
    if (!(p.radius > 0) || !std::isfinite(p.radius)) refuse(where, "the radius must be positive", p.radius);
    if (p.radius < least || p.radius > most)
        refuse(where, "the radius must be in the range of single precision, 1.2e-38 to 3.4e38 m", p.radius);
    if (!finite(p.r) || !finite(p.v) || !finite(p.omega))
        refuse(where, "position and velocities must be finite", not_finite({p.r, p.v, p.omega}));
    for (const double x : {p.v.x, p.v.y, p.v.z, p.omega.x, p.omega.y, p.omega.z})
        if (std::abs(x) > most)
            refuse(where, "velocities must be in the range of single precision, up to 3.4e38", x);
    if (p.material < 0 || p.material >= static_cast<int>(materials.size()))
        refuse(where, "no material has this number", p.material);
    if (!(std::abs(length(p.e) - 1) < 1e-3))
        refuse(where, "Euler parameters must have the length 1 within 1e-3", length(p.e));
    if (!options.orientation && p.e != Particle().e)
        refuse(where, "an orientation requires a world that integrates orientations; e0", p.e[0]);
    if (!(p.mass >= 0) || !std::isfinite(p.mass)) refuse(where, "the mass must not be negative", p.mass);
    const double density = materials[static_cast<std::size_t>(p.material)].density,
                 mass = p.mass > 0 ? p.mass : sphere_mass(p.radius, density);
    if (!p.fixed && !(mass >= least && mass <= 1 / least))
        refuse(where, "the mass must be in the range of single precision, 1.2e-38 to 8.5e37 kg", mass);
    if (p.attached_to >= static_cast<int>(boundaries.size()) || p.attached_to < -1)
        refuse(where, "no boundary has this number", p.attached_to);
    if (p.attached_to >= 0 && boundaries[static_cast<std::size_t>(p.attached_to)].mass > 0)
        refuse(where, "must not be attached to a boundary with a mass; boundary", p.attached_to);
    Particle valid = p;
    valid.mass = mass;
    if (p.attached_to >= 0) valid.fixed = true;
    return valid;
}

std::uint32_t World::add(std::span<const Particle> particles)
{
    const auto first = static_cast<std::uint32_t>(next_id + pending.size());
    const std::size_t before = pending.size();
    try {
        for (const Particle& p : particles) {
            const auto id = static_cast<std::uint32_t>(next_id + pending.size());
            pending.push_back(checked(p, name_of(id)));
            pending.back().id = id;
        }
    } catch (...) {
        pending.resize(before);
        throw;
    }
    return first;
}

void World::expect(const std::vector<Particle>& samples, std::size_t particles)
{
    Expected of{{}, particles};
    for (const Particle& p : samples) of.samples.push_back(checked(p, "expected particle"));
    if (!of.samples.empty()) expected.push_back(of);
}

/// Whether the cells are made for particles that include these
bool World::fits(const std::vector<Particle>& all) const
{
    if (!pending_clumps.empty())
        for (const std::int32_t width : domain.grid.width)
            if (!(reach_of_clumps() + domain.skin <= width * domain.grid.unit)) return false;
    return std::all_of(all.begin(), all.end(), [&](const Particle& p) {
        const auto radius = static_cast<float>(p.radius);
        return radius <= domain.largest && p.replica < domain.replicas &&
               (domain.radius == 0 || radius == domain.radius);
    });
}

namespace {

/// Diameter of the largest particle for which the cells are made. `sorted`: all diameters in ascending order.
///
/// The number of distances that a neighbour search computes is estimated for candidates D, with cells of the
/// width w = D + skin, a constant density of particles, and large particles of the diameters D_i > D:
///
///     27/2 w³ for each small particle,    (D_i + D_max + 6 w)³ for each large one
///
/// Cells of less than half the width for the largest particle are used if they need fewer distances.
double cell_diameter(const std::vector<double>& sorted, double skin)
{
    const double most = sorted.back();
    const auto cube = [](double x) { return x * x * x; };
    double least = 13.5 * static_cast<double>(sorted.size()) * cube(most + skin), best = most;
    // The candidates leave half, a quarter, ... of the particles as large ones.
    for (std::size_t large = sorted.size() / 2; large > 0; large /= 2) {
        const double D = sorted[sorted.size() - 1 - large], w = D + skin;
        if (w > 0.5 * (most + skin)) break;
        double cost = 13.5 * static_cast<double>(sorted.size()) * cube(w);
        for (auto it = std::upper_bound(sorted.begin(), sorted.end(), D); it != sorted.end(); ++it)
            cost += cube(*it + most + 6 * w);
        if (cost < least) least = cost, best = D;
    }
    return best;
}

}  // namespace

/// Cell grid for these particles and the expected ones. Throws io::InvalidInput.
Domain World::domain_of(const std::vector<Particle>& all) const
{
    Domain in;
    CellGrid& grid = in.grid;
    in.radius = static_cast<float>(all.empty() ? expected[0].samples[0].radius : all[0].radius);
    std::vector<double> diameters;
    const auto include = [&](const Particle& p, std::size_t times) {
        diameters.insert(diameters.end(), times, 2 * p.radius);
        if (static_cast<float>(p.radius) != in.radius) in.radius = 0;
        in.replicas = std::max(in.replicas, std::uint32_t{p.replica} + 1);
    };
    for (const Particle& p : all) include(p, 1);
    // The expected particles have the weight of those that are there, whatever their number, which may depend
    // on the end of the run.
    std::size_t samples = 0;
    for (const Expected& e : expected) samples += e.samples.size();
    for (const Expected& e : expected)
        for (const Particle& p : e.samples) include(p, std::max<std::size_t>(1, all.size() / samples));
    if (in.radius == 0) std::sort(diameters.begin(), diameters.end());
    const double largest = diameters.back();
    // The median and not the largest diameter: with the latter, a single large particle multiplies the number
    // of pairs of all others. A pair is listed up to the distance R_i + R_j + skin of the centres.
    in.skin = std::max(static_cast<float>(options.skin * diameters[diameters.size() / 2]),
                       std::numeric_limits<float>::min());
    double cell = cell_diameter(diameters, in.skin);
    if (!set_cells(grid, cell + in.skin, in.replicas)) cell = largest;
    // The particles of a clump can be outside the domain, by less than a cell.
    double reach = reach_of_clumps();
    for (const Expected& e : expected) reach = std::max(reach, e.reach);
    const double least = std::max(largest, reach) + in.skin;
    double edge = std::max(cell, reach) + in.skin;
    // Cells that are wider than necessary make the length unit coarser.
    constexpr double largest_factor = 8;
    while (!set_cells(grid, edge, in.replicas)) {
        edge *= 1.05;
        if (edge > largest_factor * (largest + in.skin)) refuse_domain(edge, in.replicas);
    }
    in.small = static_cast<float>(cell / 2), in.largest = static_cast<float>(largest / 2);
    const double low[] = {options.low.x, options.low.y, options.low.z},
                 high[] = {options.high.x, options.high.y, options.high.z};
    double widest = std::max(edge, largest + in.skin);
    for (int k = 0; k < 3; ++k) {
        grid.low[k] = low[k];
        grid.periodic[k] = options.periodic[k];
        const double length = high[k] - low[k];
        // A particle must not be close to its own image. The members of a clump are not searched over images.
        const double shortest = reach > 0 ? 3 * least : least;
        if (options.periodic[k] && !(length >= 1.00001 * shortest))
            refuse("domain",
                   io::formatted("must be at least %.5g m wide along %c, a periodic axis: %s and the skin",
                                 1.0001 * shortest, 'x' + k,
                                 reach > largest ? "three times the distance of a sphere from the centre of "
                                                   "mass of its clump"
                                 : reach > 0     ? "three times the largest diameter, with clumps"
                                                 : "the largest diameter"),
                   length);
        if (options.periodic[k]) widest = std::max(widest, length / grid.cells[k]);
    }
    grid.unit = widest / CellGrid::widest;
    for (int k = 0; k < 3; ++k) {
        const double length = high[k] - low[k];
        grid.width[k] = static_cast<std::int32_t>(
            std::lround((options.periodic[k] ? length / grid.cells[k] : edge) / grid.unit));
        // The rounding of the width, multiplied by the number of cells, can exceed the limits of the last
        // cell. The period is a whole number of cells.
        const long last = std::lround(length / grid.unit - double(grid.width[k]) * (grid.cells[k] - 1)),
                   width = grid.width[k];
        grid.last[k] = static_cast<std::int32_t>(options.periodic[k] ? width : std::clamp(last, 0L, width));
    }
    return in;
}

/// Divides the domain into cells that are at least as wide as `edge`. False if they are too many: a cell is
/// stored in CellGrid::cell_bits, and its number with the replica in 31 bits.
bool World::set_cells(CellGrid& grid, double edge, std::uint32_t replicas) const
{
    const Vec3 size = options.high - options.low;
    const double length[] = {size.x, size.y, size.z};
    double all = replicas;
    int bits[3];
    for (int k = 0; k < 3; ++k) {
        const double cells =
            std::max(options.periodic[k] ? std::floor(length[k] / edge) : std::ceil(length[k] / edge), 1.);
        all *= cells;
        if (all > max_cells) return false;
        grid.cells[k] = static_cast<std::int32_t>(cells);
        bits[k] =
            std::max(static_cast<int>(std::bit_width(static_cast<std::uint32_t>(grid.cells[k] - 1))), 1);
    }
    grid.shift_y = bits[0], grid.shift_z = bits[0] + bits[1];
    return bits[0] + bits[1] + bits[2] <= CellGrid::cell_bits;
}

[[noreturn]] void World::refuse_domain(double edge, std::uint32_t replicas) const
{
    refuse("domain",
           io::formatted("must not have more than 2^31 cells in all replicas; cells that are %.3g m wide, "
                         "eight times the largest diameter and the skin, are the widest; cells",
                         edge),
           replicas * std::ceil((options.high.x - options.low.x) / edge) *
               std::ceil((options.high.y - options.low.y) / edge) *
               std::ceil((options.high.z - options.low.z) / edge));
}

/// Cell and position within the cell of each particle. Throws io::InvalidInput if a particle of the list from
/// number `first_new` on is outside the domain, and ParticleLost if one before it is.
std::vector<World::CellPosition> World::cell_positions(const Domain& in, const std::vector<Particle>& all,
                                                       std::size_t first_new) const
{
    const CellGrid& grid = in.grid;
    std::vector<CellPosition> located(all.size());
    for (std::uint32_t k = 0; k < all.size(); ++k) {
        std::int32_t cell[3], at[3];
        float remainder[3];
        const double r[] = {all[k].r.x, all[k].r.y, all[k].r.z};
        for (int c = 0; c < 3; ++c) {
            double units = (r[c] - grid.low[c]) / grid.unit;
            const double length = double(grid.width[c]) * (grid.cells[c] - 1) + grid.last[c];
            if (grid.periodic[c] != 0) {
                units -= length * std::floor(units / length);
            } else if (!(units >= 0 && units <= length)) {
                if (k >= first_new)
                    refuse(name_of(all[k].id), std::string("is outside the domain along ") + "xyz"[c], r[c]);
                if (all[k].clump < 0) throw_left(all[k].id);
            }
            const double cell_index =
                std::clamp(std::floor(units / grid.width[c]), 0., double(grid.cells[c] - 1));
            cell[c] = static_cast<std::int32_t>(cell_index);
            const double in_cell = units - cell_index * grid.width[c];
            at[c] = static_cast<std::int32_t>(std::lround(in_cell));
            remainder[c] = static_cast<float>(in_cell - at[c]);
        }
        for (int c = 0; c < 3; ++c) at[c] = wrapped_sum(at[c], wrapped_product(cell[c], grid.width[c]));
        located[k] = {{grid.pack(cell[0], cell[1], cell[2]), at[0], at[1], at[2]},
                      {remainder[0], remainder[1], remainder[2]}};
    }
    return located;
}

/// Inserts the pending particles into the arrays, which are then in the order of the ids. An exception that
/// is thrown before the arrays are changed leaves the world unchanged. After a failed overlap check the world
/// cannot be used.
void World::insert_pending()
{
    if (!insertion_error.empty()) throw io::InvalidInput(insertion_error);
    const bool expects = !expected.empty() && !has_domain;
    if ((expects || !pending.empty()) && laws.empty())
        refuse("world", "at least one law must be set", "none");
    if (expects) {
        std::vector<Particle> all = pending;
        reserved = pending.size();
        for (const Expected& e : expected)
            all.insert(all.end(), e.samples.begin(), e.samples.end()), reserved += e.particles;
        check_laws(all);
        if (pending.empty()) domain = domain_of({}), has_domain = true;
    }
    if (pending.empty()) return;
    if (removes()) remove_outside();
    const std::uint32_t first = next_id;
    if (!expected.empty() && has_domain && fits(pending)) {
        append_pending();
    } else if (inserted_count > 0) {
        insert(particles());
    } else {  // without a copy
        std::vector<Particle> all = std::exchange(pending, {});
        try {
            insert(all);
        } catch (...) {
            if (inserted_count == 0) pending = std::move(all);
            throw;
        }
    }
    rebuild_neighbours();
    try {
        check_overlaps(first);
    } catch (const io::InvalidInput& e) {
        insertion_error = e.what();
        throw;
    }
}

/// Writes a new particle to place k of the arrays, whose length includes it.
void World::write_particle(std::uint32_t k, const Particle& particle, const CellPosition& at)
{
    Particles<par::Cpu>& p = engine->arrays().particle;
    const SplitDisplacement<float> split = split_displacement(at.remainder, 0);
    p.position.data()[k] = {at.position.cell, wrapped_sum(at.position.x, split.x),
                            wrapped_sum(at.position.y, split.y), wrapped_sum(at.position.z, split.z)};
    p.velocity.data()[k] = to_float4(particle.v, particle.radius);
    p.omega.data()[k] = to_float4(particle.omega, particle.fixed ? 0 : 1 / particle.mass);
    p.species.data()[k] = {.material = static_cast<std::uint16_t>(particle.material),
                           .replica = particle.replica};
    Compensation& compensation = p.compensation.data()[k] = {.displacement = split.remainder};
    store_bfloat16(compensation.v, rounding_error(particle.v), dither_to_nearest);
    store_bfloat16(compensation.omega, rounding_error(particle.omega), dither_to_nearest);
    p.id.data()[k] = particle.id;
    if (options.orientation) {
        const auto [e0, e1, e2, e3] = unit(particle.e);
        p.orientation.data()[k] = to_float4({e0, e1, e2}, e3);
        p.orientation_compensation.data()[k] = {rounding_error(e0), rounding_error(e1), rounding_error(e2),
                                                rounding_error(e3)};
    }
}

/// Writes these particles to the arrays, ordered by id.
void World::insert(const std::vector<Particle>& all)
{
    const std::vector<Particle> clumps_before = clump_places();
    const Domain next = domain_of(all);
    std::vector<CellPosition> located = cell_positions(next, all, inserted_count);
    check_laws(all);
    Arrays<par::Cpu>& a = engine->arrays();
    const std::vector<Vec3> apart = next.has_images() ? separations(domain.grid, a) : std::vector<Vec3>();
    domain = next, has_domain = true;

    // contacts and accelerations of the particles that are in the arrays already are preserved
    Particles<par::Cpu>& p = a.particle;
    const auto index = [&](std::uint32_t k) {
        return static_cast<std::uint32_t>(index_of(p.id.data()[k], all));
    };
    for (std::uint32_t n = 0; n < a.pairs.count; ++n) {
        std::uint32_t &i = a.pairs.i.data()[n], &j = a.pairs.j.data()[n];
        i = index(i);
        if ((j & PairView::boundary_bit) == 0) j = index(j);
    }
    std::vector<Float4> acc_of(all.size(), to_float4(options.gravity, 0)), alpha_of(all.size());
    for (std::uint32_t k = 0; k < p.acc.size(); ++k)
        acc_of[index(k)] = p.acc.data()[k], alpha_of[index(k)] = p.alpha.data()[k];

    p.resize(static_cast<std::uint32_t>(std::max(reserved, all.size())));
    p.resize(static_cast<std::uint32_t>(all.size()));
    if (options.orientation) p.orientation.resize(p.count), p.orientation_compensation.resize(p.count);
    for (std::uint32_t k = 0; k < p.count; ++k) write_particle(k, all[k], located[k]);
    if (next.has_images()) set_images(next, a, apart);
    if (uses_previous_acceleration(options.scheme)) {
        p.acc.resize(p.count), p.alpha.resize(p.count);
        std::copy(acc_of.begin(), acc_of.end(), p.acc.data());
        std::copy(alpha_of.begin(), alpha_of.end(), p.alpha.data());
    }
    insert_clumps(clumps_before);
    end_insertion(all);
}

namespace {

/// Changes the length of an array and keeps its content; the new elements have the given value.
template <class T>
void lengthen(par::Array<par::Cpu, T>& array, std::size_t n, const T& value = {})
{
    const std::vector<T> before(array.data(), array.data() + array.size());
    array.resize(n);
    std::copy(before.begin(), before.end(), array.data());
    std::fill(array.data() + before.size(), array.data() + n, value);
}

}  // namespace

/// Writes the pending particles behind those in the arrays, whose bytes and contacts do not change.
void World::append_pending()
{
    const std::vector<CellPosition> located = cell_positions(domain, pending, 0);
    check_laws(pending);
    Particles<par::Cpu>& p = engine->arrays().particle;
    const std::uint32_t before = p.count;
    const auto n = static_cast<std::uint32_t>(before + pending.size());
    lengthen(p.position, n), lengthen(p.velocity, n), lengthen(p.omega, n), lengthen(p.compensation, n);
    lengthen(p.species, n), lengthen(p.id, n);
    if (uses_previous_acceleration(options.scheme))
        lengthen(p.acc, n, to_float4(options.gravity, 0)), lengthen(p.alpha, n);
    if (options.orientation) lengthen(p.orientation, n), lengthen(p.orientation_compensation, n);
    p.count = n;
    for (std::uint32_t k = 0; k < pending.size(); ++k) write_particle(before + k, pending[k], located[k]);
    insert_clumps({});
    end_insertion(std::exchange(pending, {}));
}

/// What follows when these particles, the new ones at the end, have been written to the arrays
void World::end_insertion(const std::vector<Particle>& all)
{
    const std::uint32_t first = next_id;
    for (const Particle& particle : all)
        if (particle.id >= first && particle.attached_to >= 0) attach(particle);
    std::vector<Particle>().swap(pending);
    start_balance();
    inserted_count = engine->arrays().particle.count;
    next_id = all.back().id + 1;
    update_clump_tables();
    if (!forces.empty()) forces.resize(next_id), forces_changed = true;
    engine->arrays_modified();
}

/// Checks that each pair of materials that can be in contact has a law, with these particles and those in the
/// arrays. Throws io::InvalidInput.
void World::check_laws(const std::vector<Particle>& added) const
{
    const std::size_t n = materials.size();
    std::vector<char> of_particles(n, 0), all(n, 0);
    std::uint16_t replica = 0;
    struct Sphere {
        double radius, mass;
    } smallest{1e300, 0}, largest{0, 0};
    const auto include = [&](int material, std::uint16_t of, const Sphere& sphere) {
        of_particles[static_cast<std::size_t>(material)] = 1, replica = std::max(replica, of);
        if (!(sphere.mass > 0)) return;  // fixed
        if (sphere.radius < smallest.radius) smallest = sphere;
        if (sphere.radius > largest.radius) largest = sphere;
    };
    const Particles<par::Cpu>& p = engine->arrays().particle;
    for (std::uint32_t k = 0; k < p.count; ++k)
        include(p.species.data()[k].material, p.species.data()[k].replica,
                {p.velocity.data()[k].w, p.omega.data()[k].w > 0 ? 1 / double{p.omega.data()[k].w} : 0});
    for (const Particle& one : added)
        include(one.material, one.replica, {one.radius, one.fixed ? 0 : one.mass});
    all = of_particles;
    for (const Boundary& b : boundaries) {
        if (b.shape != Boundary::Shape::none) all[static_cast<std::size_t>(b.material)] = 1;
        if (b.mass > 0 && replica > 0)
            refuse("boundary",
                   "a boundary with a mass requires that all particles are in replica 0; largest replica",
                   replica);
    }
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
            if (of_particles[i] != 0 && all[j] != 0 && law_of[i * n + j] == no_law)
                refuse("laws", "no law is set between two materials that can be in contact",
                       "'" + materials[i].name + "' and '" + materials[j].name + "'");
    if (!(largest.radius > 0)) return;
    for (std::size_t l = 0; l < laws.size(); ++l)
        for (const Sphere& sphere : {smallest, largest})
            if (!has_single_forces(laws[l], sphere.radius, sphere.mass, options.h))
                refuse(
                    "laws",
                    "the forces of law " + std::to_string(l) +
                        " are outside the range of single precision for particles of this radius [m]; choose "
                        "other units",
                    sphere.radius);
}

/// Checks that the particles with ids from `first` on overlap other particles and boundaries by at most
/// WorldOptions::start_overlap of the smaller radius. Throws io::InvalidInput.
void World::check_overlaps(std::uint32_t first) const
{
    const double max_overlap = options.start_overlap;
    update_for_query();
    struct Fault {
        bool boundary = true;
        std::uint32_t i = ~std::uint32_t{0}, j = i;
        double R = 0, delta = 0;
    } found;  // the one with the lowest ids
    engine->each_piece(true, [&](const Piece& piece) {
        const Particles<par::Cpu>& p = piece.arrays.particle;
        const Pairs<par::Cpu>& pairs = piece.arrays.pairs;
        for (std::uint32_t n = 0; n < pairs.count; ++n) {
            const std::uint32_t i = pairs.i.data()[n], j = pairs.j.data()[n];
            const double R_i = p.velocity.data()[i].w;
            Fault f{.boundary = (j & PairView::boundary_bit) != 0, .i = p.id.data()[i]};
            if (f.boundary) {
                const std::uint32_t surface = j & ~PairView::boundary_bit;
                f.j = surfaces().boundary_of(surface), f.R = R_i;
                f.delta = R_i - surfaces()
                                    .nearest(surface, global_position(domain.grid, p.position.data()[i]), R_i)
                                    .distance;
            } else {
                const double R_j = p.velocity.data()[j].w;
                f.j = p.id.data()[j], f.R = std::min(R_i, R_j);
                f.delta = R_i + R_j - separation(domain.grid, piece.arrays, n).norm();
                if (f.j < f.i) std::swap(f.i, f.j);
            }
            if (f.i < first && (f.boundary || f.j < first)) continue;
            const bool too_large = f.boundary && f.delta > 0 && is_larger_than(boundaries[f.j], f.R);
            if (!too_large && !(f.delta > max_overlap * f.R)) continue;
            if (std::tie(f.boundary, f.i, f.j) < std::tie(found.boundary, found.i, found.j)) found = f;
        }
    });
    if (found.R == 0) return;
    if (found.boundary && is_larger_than(boundaries[found.j], found.R))
        refuse(name_of(found.i),
               "must be smaller than boundary " + std::to_string(found.j) +
                   ", which contains it; its radius [m]",
               found.R);
    refuse(name_of(found.i) + " and " +
               (found.boundary ? "boundary " + std::to_string(found.j) : name_of(found.j)),
           "must not overlap by more than " + io::shortest(100 * max_overlap) + " % of a radius at the start",
           found.delta);
}

}  // namespace hilda::granular
