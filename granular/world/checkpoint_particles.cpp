// SPDX-License-Identifier: GPL-3.0-or-later
// The particles of a checkpoint and their contacts, in pieces: no process of a run needs the memory of all.
#include "granular/world/value_text.hpp"
#include "granular/world/world_impl.hpp"
#include "io/archive.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace hilda::granular {

using namespace detail;

namespace {

using detail::shown;  // with the overload of this file

bool valid_compensation(const Compensation& c)
{
    return finite(to_double(load_bfloat16(c.v))) && finite(to_double(load_bfloat16(c.omega)));
}
std::string shown(const Compensation& c)
{
    return shown(to_double(load_bfloat16(c.v))) + ", " + shown(to_double(load_bfloat16(c.omega)));
}

/// Most particles of a block of a checkpoint
constexpr std::size_t block_size = 4096;

/// Contacts: i is the number of a particle, j an id, or a surface with PairView::boundary_bit.
struct SavedPairs {
    std::vector<std::uint32_t> i, j;
    std::vector<Float4> history, rotation, internal;
    std::vector<std::uint8_t> image;

    /// Adds the contact n of the particle `number` of a block.
    void add(std::uint32_t number, const Pairs<par::Cpu>& pairs, std::uint32_t n, const std::uint32_t* id)
    {
        const std::uint32_t of = pairs.j.data()[n];
        i.push_back(number), j.push_back((of & PairView::boundary_bit) != 0 ? of : id[of]);
        history.push_back(pairs.history.data()[n]);
        if (pairs.rotation_history.size() > 0) rotation.push_back(pairs.rotation_history.data()[n]);
        if (pairs.internal.size() > 0) internal.push_back(pairs.internal.data()[n]);
        if (pairs.image.size() > 0) image.push_back(pairs.image.data()[n]);
    }
    void write(io::Archive& a)
    {
        a.list(i), a.list(j), a.list(history), a.list(rotation), a.list(internal), a.list(image);
    }
    void clear() { i.clear(), j.clear(), history.clear(), rotation.clear(), internal.clear(), image.clear(); }

    /// Reads the contacts of the `particles` that are the last ones of `before` + particles.
    void add(io::Archive& a, std::size_t before, std::size_t particles)
    {
        SavedPairs block;
        const std::size_t n = a.list(block.i);
        a.check_each(
            block.i, "unknown particle of a pair", [&](std::uint32_t k) { return k < particles; },
            [](std::uint32_t k) { return std::to_string(k); });
        for (std::uint32_t& k : block.i) k += static_cast<std::uint32_t>(before);
        const auto list = [&](auto& values, bool optional) {
            const std::size_t got = a.list(values);
            a.check(got == n || (optional && got == 0), "wrong number of pairs, got " + std::to_string(got));
        };
        list(block.j, false), list(block.history, false);
        check_vectors(a, block.history, "a history");
        list(block.rotation, true);
        check_vectors(a, block.rotation, "a history");
        list(block.internal, true);
        check_vectors(a, block.internal, "a history");
        list(block.image, true);
        a.check_each(
            block.image, "invalid image of a pair", [](std::uint8_t image) { return image < 27; },
            [](std::uint8_t image) { return std::to_string(image); });
        const auto append = [&](auto& to, const auto& from) {
            to.insert(to.end(), from.begin(), from.end());
        };
        append(i, block.i), append(j, block.j), append(history, block.history);
        append(rotation, block.rotation), append(internal, block.internal), append(image, block.image);
    }
    /// As the pairs of a list before a neighbour search
    void put(Pairs<par::Cpu>& to) const
    {
        const auto list = [](auto& values, const auto& from) {
            values.resize(from.size());
            std::copy(from.begin(), from.end(), values.data());
        };
        list(to.i, i), list(to.j, j), list(to.history, history), list(to.rotation_history, rotation);
        list(to.internal, internal), list(to.image, image);
        to.count = static_cast<std::uint32_t>(i.size());
        to.in_contact.resize(i.size());
        par::fill(par::Cpu(), to.in_contact.data(), i.size(), std::uint8_t{1});
    }
};

/// The contacts of each particle i: the numbers from start[i] to start[i + 1] - 1 of `contact`
struct ContactsOf {
    std::vector<std::uint32_t> start, contact;

    ContactsOf(const Pairs<par::Cpu>& pairs, std::uint32_t particles) : start(particles + std::size_t{2})
    {
        const auto each = [&](const auto& f) {
            for (std::uint32_t n = 0; n < pairs.count; ++n)
                if (pairs.in_contact.data()[n] != 0) f(pairs.i.data()[n], n);
        };
        each([&](std::uint32_t i, std::uint32_t) { ++start[i + std::size_t{2}]; });
        for (std::size_t k = 2; k < start.size(); ++k) start[k] += start[k - 1];
        contact.resize(start.back());
        each([&](std::uint32_t i, std::uint32_t n) { contact[start[i + std::size_t{1}]++] = n; });
    }
};

/// Calls f(array of `to`, array of `from`) for each array of a particle's state.
template <class F>
void each_array(Particles<par::Cpu>& to, const Particles<par::Cpu>& from, const F& f)
{
    f(to.position, from.position), f(to.velocity, from.velocity), f(to.omega, from.omega);
    f(to.compensation, from.compensation), f(to.species, from.species), f(to.id, from.id);
    f(to.acc, from.acc), f(to.alpha, from.alpha), f(to.orientation, from.orientation);
    f(to.orientation_compensation, from.orientation_compensation);
}

/// Appends the n particles of a block to `to`, which has the length for them, from `first` on.
void append(Particles<par::Cpu>& to, std::size_t first, const Particles<par::Cpu>& block)
{
    each_array(to, block, [&](auto& all, const auto& values) {
        std::copy(values.data(), values.data() + values.size(), all.data() + first);
    });
}

}  // namespace

/// Position of a particle when the neighbour list was built, see Position. Its owner cell is still the same.
struct World::PlaceAtBuild {
    std::int32_t x, y, z;
};

/// The first n particles of the arrays as a block, without their contacts
void World::transfer_block(io::Archive& a, Particles<par::Cpu>& p, std::size_t n)
{
    const auto list = [&](auto& values) {
        const std::size_t got = a.list(values, n);
        a.check(got == n, "wrong number of particles, got " + std::to_string(got));
    };
    /// An array that only some schemes use
    const auto list_if = [&](bool used, auto& values, const char* what) {
        const std::size_t got = a.list(values, used ? n : 0);
        a.check(got == (used ? n : 0),
                "an array of another integrator, got " + std::to_string(got) + " elements");
        check_vectors(a, values, what);
    };
    list(p.position);
    a.check_each(
        p.position, "invalid position of a particle",
        [&](const Position& at) { return is_near_domain(domain.grid, at); },
        [&](const Position& at) {
            return "cell " + std::to_string(at.cell) + ", " +
                   shown(Vec3{double(at.x), double(at.y), double(at.z)});
        });
    list(p.velocity);
    check_vectors(a, p.velocity, "a velocity");
    a.check_each(
        p.velocity, "a radius must be positive and that of the domain",
        [&](const Float4& v) {
            return v.w > 0 && v.w <= domain.largest && (domain.radius == 0 || v.w == domain.radius);
        },
        [](const Float4& v) { return shown(v.w); });
    list(p.omega);
    check_vectors(a, p.omega, "an angular velocity");
    a.check_each(
        p.omega, "an inverse mass must not be negative", [](const Float4& w) { return w.w >= 0; },
        [](const Float4& w) { return shown(w.w); });
    list(p.compensation);
    a.check_each(p.compensation, "a rounding error of a velocity must be finite", valid_compensation,
                 [](const Compensation& c) { return shown(c); });
    list(p.species);
    a.check_each(
        p.species, "invalid material or replica of a particle",
        [&](const Species& s) { return s.material < materials.size() && s.replica < domain.replicas; },
        [](const Species& s) { return std::to_string(s.material) + ", " + std::to_string(s.replica); });
    list(p.id);
    const bool previous = detail::uses_previous_acceleration(options.scheme);
    list_if(previous, p.acc, "an acceleration"), list_if(previous, p.alpha, "an angular acceleration");
    const std::size_t oriented = a.list(p.orientation, options.orientation ? n : 0);
    const auto is_unit = [](const Float4& e) { return std::abs(length({e.x, e.y, e.z, e.w}) - 1) < 1e-3; };
    const auto is_error = [](const Float4& e) { return length({e.x, e.y, e.z, e.w}) < 1e-3; };
    const auto shown_four = [](const Float4& e) { return shown(e); };
    a.check_each(p.orientation, "Euler parameters must have the length 1", is_unit, shown_four);
    const std::size_t compensated = a.list(p.orientation_compensation, options.orientation ? n : 0);
    a.check_each(p.orientation_compensation, "invalid rounding error of Euler parameters", is_error,
                 shown_four);
    if (compensated != oriented || oriented != (options.orientation ? n : 0))
        throw io::IoError(a.name() + ": the checkpoint " + (options.orientation ? "has no" : "has") +
                          " orientations, but /orientation of this case is " +
                          (options.orientation ? "true" : "false"));
}

void World::transfer_particles(io::Archive& a)
{
    constexpr std::size_t smallest = 64;  // bytes of a particle
    const bool has_list = std::isfinite(particle_displacement);
    std::size_t n = inserted_count;
    a.count(n, smallest);
    const std::size_t with_acc = uses_previous_acceleration(options.scheme) ? 1 : 0,
                      oriented = options.orientation ? 1 : 0;
    const auto resize_all = [&](Particles<par::Cpu>& to, std::size_t length) {
        to.resize(static_cast<std::uint32_t>(length));
        to.acc.resize(with_acc * length), to.alpha.resize(with_acc * length);
        to.orientation.resize(oriented * length), to.orientation_compensation.resize(oriented * length);
    };
    if (!a.reads()) {
        // The blocks do not depend on the pieces in which several processes send the particles.
        Particles<par::Cpu> block;
        resize_all(block, std::min(block_size, n));
        std::vector<PlaceAtBuild> places;
        SavedPairs contacts;
        std::size_t filled = 0;
        const auto write_block = [&] {
            a.count(filled, smallest);
            transfer_block(a, block, filled);
            for (PlaceAtBuild& place : places) a.value(place);
            contacts.write(a);
            filled = 0, places.clear(), contacts.clear();
        };
        engine->each_piece(true, [&](const Piece& piece) {
            const Particles<par::Cpu>& p = piece.arrays.particle;
            const ContactsOf rows(piece.arrays.pairs, p.count);
            for (std::uint32_t k = 0; k < piece.particles; ++k) {
                each_array(block, p, [&](auto& to, const auto& from) {
                    if (to.size() > 0) to.data()[filled] = from.data()[k];
                });
                if (has_list) {
                    const Position& at = p.position_at_build.data()[k];
                    places.push_back({at.x, at.y, at.z});
                }
                for (std::uint32_t n_of = rows.start[k]; n_of < rows.start[k + 1]; ++n_of)
                    contacts.add(static_cast<std::uint32_t>(filled), piece.arrays.pairs, rows.contact[n_of],
                                 p.id.data());
                if (++filled == block_size) write_block();
            }
        });
        if (filled > 0) write_block();
        return transfer_clumps(a);
    }

    Arrays<par::Cpu>& all = engine->arrays();
    Particles<par::Cpu>& p = all.particle;
    resize_all(p, n);
    std::vector<PlaceAtBuild> at_build;
    SavedPairs pairs;
    for (std::size_t before = 0, of_block = 0; before < n; before += of_block) {
        a.count(of_block, smallest);
        a.check(of_block > 0 && of_block <= n - before,
                "invalid number of particles, got " + std::to_string(of_block));
        Particles<par::Cpu> block;
        transfer_block(a, block, of_block);
        append(p, before, block);
        for (std::size_t k = 0; has_list && k < of_block; ++k) {
            PlaceAtBuild& place = at_build.emplace_back();
            a.value(place);
            if (!is_near_domain(domain.grid, {block.position.data()[k].cell, place.x, place.y, place.z}))
                a.check(false, "invalid position of " + name_of(block.id.data()[k]) + ", got " +
                                   shown(Vec3{double(place.x), double(place.y), double(place.z)}));
        }
        pairs.add(a, before, of_block);
    }
    for (const std::size_t size : {pairs.rotation.size(), pairs.internal.size(), pairs.image.size()})
        a.check(size == 0 || size == pairs.i.size(), "wrong number of pairs, got " + std::to_string(size));
    p.count = static_cast<std::uint32_t>(n);
    inserted_count = n;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> index;  // of the particles, by id
    for (std::uint32_t k = 0; k < n; ++k) index.emplace_back(p.id.data()[k], k);
    std::sort(index.begin(), index.end());
    const auto same = [](const auto& x, const auto& y) { return x.first == y.first; };
    a.check(next_id >= n && next_id - n == static_cast<std::uint64_t>(total_outflow.count) &&
                (n == 0 || index.back().first < next_id) &&
                std::adjacent_find(index.begin(), index.end(), same) == index.end(),
            "the ids of the particles must be below the next one, " + std::to_string(next_id) +
                ", and differ, got " + std::to_string(n) + " particles, the largest id " +
                std::to_string(n > 0 ? index.back().first : 0));
    const auto is_surface = [&](std::uint32_t k) {
        return Surfaces::is_triangle(k) ? k - Surfaces::first_triangle < meshes->triangle.size()
                                        : k < boundaries.size();
    };
    for (std::size_t k = 0; k < pairs.j.size(); ++k) {
        std::uint32_t& j = pairs.j[k];
        const bool has_surface = (j & PairView::boundary_bit) != 0;
        const auto at = std::lower_bound(index.begin(), index.end(), std::pair(j, std::uint32_t{0}));
        if (has_surface ? !is_surface(j & ~PairView::boundary_bit) : at == index.end() || at->first != j)
            a.check(false, "unknown particle or boundary of a pair, got " + name_of(p.id.data()[pairs.i[k]]) +
                               " and " + std::to_string(j));
        if (!has_surface) j = at->second;
    }
    pairs.put(all.pairs);
    transfer_clumps(a);
    if (has_list)
        restore_neighbours(a.name(), std::move(at_build));
    else
        engine->arrays_modified();
}

/// Builds the neighbour list of the saved world, with the positions for which it was built. Throws
/// io::IoError.
void World::restore_neighbours(const std::string& file, std::vector<PlaceAtBuild> at_build)
{
    const std::vector<Boundary> now = boundaries;
    for (std::size_t k = 0; k < boundaries.size(); ++k)
        boundaries[k].r = boundaries_at_build[k].r, boundaries[k].axis = boundaries_at_build[k].axis,
        boundaries[k].p = boundaries_at_build[k].p;
    const auto exchange = [&] {
        Position* const position = engine->arrays().particle.position.data();
        for (std::size_t k = 0; k < at_build.size(); ++k) {
            Position& p = position[k];
            const PlaceAtBuild place = std::exchange(at_build[k], {p.x, p.y, p.z});
            p.x = place.x, p.y = place.y, p.z = place.z;
        }
        engine->arrays_modified();
    };
    // The search must not change the order of the particles.
    const auto order = [&] {
        const Particles<par::Cpu>& p = engine->arrays().particle;
        std::uint64_t sum = 0;
        for (std::size_t k = 0; k < at_build.size(); ++k) {
            const std::uint32_t words[] = {p.id.data()[k], p.position.data()[k].cell};
            sum = io::checksum(sum, reinterpret_cast<const char*>(words), sizeof words);
        }
        return sum;
    };
    const std::uint64_t saved = order();
    const auto displacements = std::pair(particle_displacement, boundary_displacement);
    const long rebuilds = rebuild_count;
    // The search would assign the clumps to the cells of their present places.
    par::Array<par::Cpu, ClumpBody>& clumps_now = engine->arrays().clump;
    const std::vector<ClumpBody> clumps_saved(clumps_now.data(), clumps_now.data() + clumps_now.size());
    clumps_now.resize(0);
    exchange();
    try {
        find_neighbours();
    } catch (const LeftDomain& lost) {
        throw io::IoError(file + ": the checkpoint is damaged: " + name_of(lost.id) +
                          " was outside the domain when the neighbour list was built");
    } catch (const io::InvalidInput& e) {
        throw io::IoError(file + ": the checkpoint is damaged: " + e.what());
    }
    const std::uint64_t found = order();
    if (found != saved)
        throw io::IoError(file +
                          ": the checkpoint is damaged: the checksum of the order of the particles must be " +
                          std::to_string(found) + ", got " + std::to_string(saved));
    clumps_now.resize(clumps_saved.size());
    std::copy(clumps_saved.begin(), clumps_saved.end(), clumps_now.data());
    exchange();
    boundaries = now;
    std::tie(particle_displacement, boundary_displacement) = displacements;
    rebuild_count = rebuilds;
}

}  // namespace hilda::granular
