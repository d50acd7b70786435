// SPDX-License-Identifier: GPL-3.0-or-later
// The watch over a run: balances, overlaps, displacements. Nothing here changes the state of the particles.
#include "granular/world/world_impl.hpp"
#include "io/message.hpp"

#include <algorithm>
#include <numbers>
#include <tuple>
#include <utility>

namespace hilda::granular {

using namespace detail;

void WatchRecord::include(const WatchRecord& other)
{
    if ((warnings & left) == 0)
        left_tool = other.left_tool, left_time = other.left_time, left_place = other.left_place;
    samples += other.samples, warnings |= other.warnings;
    largest_overlap = std::max(largest_overlap, other.largest_overlap);
    largest_displacement = std::max(largest_displacement, other.largest_displacement);
}

namespace {

/// Text about a tool that has left the domain at this place
std::string left_text(std::size_t number, const Vec3& r, const std::vector<std::string>& names)
{
    const std::string name =
        "boundary " + (number < names.size() ? '\'' + names[number] + '\'' : std::to_string(number));
    return name + io::formatted(" has left the domain at (%.6g, %.6g, %.6g) m", r.x, r.y, r.z) +
           ": boundaries do not touch each other, and only particles can hold it";
}

}  // namespace

std::string watch_warning(const WatchRecord& w, WatchRecord::Warning which,
                          const std::vector<std::string>& boundaries)
{
    if (which == WatchRecord::left)
        return left_text(static_cast<std::size_t>(w.left_tool), w.left_place, boundaries) +
               io::formatted(", at t = %.9g s", w.left_time);
    if (which == WatchRecord::deep)
        return io::formatted(
            "an overlap of %.3g of the smaller radius is above %g: the contact laws hold for small overlaps; "
            "stiffer contacts or slower grains reduce it",
            w.largest_overlap, watch_limit::overlap);
    return io::formatted(
        "a grain moves by %.3g of its radius in one step, more than %g: contacts may be missed; a smaller "
        "step is needed",
        w.largest_displacement, watch_limit::displacement);
}

void World::set_watch(bool on, long interval)
{
    if (on != watched) {
        start_balance();
        engine->set_watched(on);
    }
    watched = on, node_interval = interval;
}

/// Whether a boundary moves by its velocities. Sets next_move, and marks the run as driven if a boundary
/// moves, may be moved by its loads, or was moved from outside.
bool World::boundaries_move()
{
    if (boundaries_rest && !boundaries_changed) return false;
    bool moves = false, free = false, placed = false;
    if (moved.size() != boundaries.size()) {
        moved.clear(), moved_to.clear();
        for (const Boundary& b : boundaries) moved.push_back({b.v, b.omega}), moved_to.emplace_back(b);
    }
    for (std::size_t k = 0; k < boundaries.size(); ++k) {
        const Boundary& b = boundaries[k];
        const Vec3 zero{0, 0, 0};
        moves = moves || b.v != zero || b.omega != zero || moved[k].v != zero || moved[k].omega != zero;
        free = free || b.mass > 0;
        placed = placed || !(BoundaryPlace(b) == moved_to[k]);
    }
    if (moves || free || placed) record.is_driven = 1;
    if (!moves) return false;
    if (options.scheme == Scheme::velocity_verlet)
        next_move = moved;
    else
        set_velocities_of_move(next_move);
    return true;
}

/// Whether the present step is a sample of the watch.
bool World::is_sample() const
{
    return record.is_balanced == 0 || step_count % watch_limit::interval == 0 ||
           (node_interval > 0 && (step_count + 1) % node_interval == 0);
}

/// Loads of the present step at t_n, before the particles are advanced: impulses and work of the boundaries
/// and, in a sample, momentum and potential energy.
///
/// A boundary that moves with u before and u' after t_n does the work h/2 F·(u + u'). W at t_n has the first
/// half of it.
void World::watch_loads()
{
    if (!watched) return;
    WatchRecord& w = record;
    sampling = is_sample();
    static const std::vector<BoundaryVelocity> none;
    const bool move = boundaries_move();
    const double h = static_cast<float>(options.h);
    ExternalSums loads = engine->external_sums(domain, move ? moved : none, move ? next_move : none);
    ParticleSums all;
    if (sampling || !forces.empty()) all = engine->particle_sums(domain, !sampling);
    loads.F += all.force;
    w.work += 0.5 * h * loads.before + h * all.force_power;
    if (!forces.empty() || rotation_locked || loads.before != 0 ||
        (w.is_balanced == 0 && !laws_have_energy()))
        w.is_driven = 1;

    const Vec3 g{static_cast<float>(options.gravity.x), static_cast<float>(options.gravity.y),
                 static_cast<float>(options.gravity.z)};
    const auto component = [](bool used, double x) { return used ? x : 0; };
    const Vec3 g_periodic{component(options.periodic[0], g.x), component(options.periodic[1], g.y),
                          component(options.periodic[2], g.z)};
    if (sampling) {
        w.mass = all.mass, w.momentum = all.momentum;
        w.potential = -(g - g_periodic).dot(all.moment);
        w.largest_momentum = std::max(w.largest_momentum, all.momentum_size);
        w.largest_displacement = std::max(w.largest_displacement, h * all.rate);
        if (w.is_balanced == 0) w.momentum_offset = w.momentum - w.impulse;
        w.largest_momentum_residual =
            std::max(w.largest_momentum_residual, (w.momentum - w.impulse - w.momentum_offset).norm());
    }
    if (step_count == 0) w.last_force = loads.F;
    const Vec3 F = options.scheme == Scheme::chung ? 1.5 * loads.F - 0.5 * w.last_force : loads.F;
    w.last_force = loads.F;
    w.impulse += h * (F + w.mass * g);
    next_work = 0.5 * h * loads.after + h * g_periodic.dot(w.momentum_offset + w.impulse);
}

/// After the particles are advanced: completes a sample by the elastic and kinetic energies at t_n.
void World::watch_advance()
{
    if (!watched) return;
    WatchRecord& w = record;
    if (domain.radius > 0)
        w.largest_displacement =
            std::max(w.largest_displacement, options.h * max_speed / static_cast<double>(domain.radius));
    w.largest_speed = std::max(w.largest_speed, static_cast<double>(max_speed));
    if (sampling) {
        const double s = options.scheme == Scheme::symplectic_euler  ? 1
                         : options.scheme == Scheme::velocity_verlet ? 2
                                                                     : 0;
        const ContactSums contacts = engine->contact_sums(domain, static_cast<float>(options.h));
        w.normal = contacts.normal, w.tangential = contacts.tangential;
        w.deep_fraction = contacts.contacts > 0 ? contacts.deep / contacts.contacts : 0;
        w.largest_deep_fraction = std::max(w.largest_deep_fraction, w.deep_fraction);
        const KineticSums T = engine->kinetic_sums(s);
        w.kinetic = T.translation + T.rotation;
        const double E = w.kinetic + w.potential + w.normal + w.tangential;
        if (w.is_balanced == 0) w.energy_offset = w.dissipated + E - w.work;
        w.is_balanced = 1;
        w.dissipated = w.work - E + w.energy_offset;
        w.largest_kinetic = std::max(w.largest_kinetic, w.kinetic);
        w.largest_normal = std::max(w.largest_normal, std::abs(w.normal));
        w.largest_tangential = std::max(w.largest_tangential, w.tangential);
        w.most_dissipated = std::max(w.most_dissipated, w.dissipated);
        w.largest_gain = std::max(w.largest_gain, w.most_dissipated - w.dissipated);
        ++w.samples;
    }
    w.work += next_work;
    if (sampling || options.device.kind == Device::cpu)
        w.largest_overlap =
            std::max(w.largest_overlap, static_cast<double>(larger(std::exchange(unsampled_overlap, 0.f),
                                                                   engine->take_largest_overlap())));
}

/// Gain of energy that the errors of integrator and laws explain [J].
///
/// At the beginning and at the end of a contact with stiffness k the force has a kink, where one step of a
/// symplectic scheme changes the energy by up to k (v h)²/8, a quarter of (ω h)² of the kinetic energy. The
/// change has both signs; four collisions are allowed in one direction, and a tenth of the kinetic energy at
/// most: coarser steps do not resolve a collision. The springs of friction, rolling and spin have a
/// stiffness that depends on the overlap, and the laws do not account for the work of that change: their
/// energy is allowed as well. The last terms are of rounding errors.
double World::gain_tolerance() const
{
    const double angle =
        std::numbers::pi * options.h / step_limits(std::max(0.1, record.largest_speed)).collision;
    constexpr double most = 0.1;
    return (watch_limit::energy + std::min(angle * angle, most)) * record.largest_kinetic +
           record.largest_tangential + 1e-5 * record.largest_normal +
           record.mass * options.gravity.norm() * domain.grid.unit;
}

/// Throws OverlapTooLarge for the largest overlap at t.
void World::throw_overlap() const
{
    const std::vector<Particle> all = particles();
    ContactRecord deepest;
    double largest = 0;
    for (const ContactRecord& c : contacts()) {
        const double R_i = all[index_of(c.i, all)].radius,
                     R = c.boundary ? R_i : std::min(R_i, all[index_of(c.j, all)].radius);
        if (c.delta / R > largest) largest = c.delta / R, deepest = c;
    }
    std::string what =
        io::formatted("the largest overlap of two bodies is %.3g of the smaller radius, more than %g",
                      record.largest_overlap, options.largest_overlap);
    if (largest > 0)
        what += io::formatted(
            ": %s and %s overlap by %.3g at t = %.9g s", name_of(deepest.i).c_str(),
            deepest.boundary ? ("boundary " + std::to_string(deepest.j)).c_str() : name_of(deepest.j).c_str(),
            largest, time);
    else
        what += io::formatted(", before t = %.9g s", time);
    what += "; stiffer contacts, slower grains or a smaller step are needed";
    if (deepest.boundary && boundaries[deepest.j].shape == Boundary::Shape::mesh)
        what += ", or a mesh whose normals point to the particles";
    throw OverlapTooLarge(what);
}

namespace {

/// Whether the surface of a tool changes with a displacement along the axis k: a plane or a cylinder may
/// slide in itself.
bool is_placed_along(const Boundary& b, std::size_t k)
{
    const double along = std::abs(k == 0 ? b.axis.x : k == 1 ? b.axis.y : b.axis.z);
    if (b.shape == Boundary::Shape::plane) return along > 1e-9;
    return b.shape != Boundary::Shape::cylinder || along < 1 - 1e-9;
}

}  // namespace

/// Finds tools whose centre has left the domain in the last step, along an axis that is free and not
/// periodic. Throws ToolLeft if gravity pulls the tool farther away; otherwise there is a warning.
void World::check_tools()
{
    for (std::size_t k = 0; k < boundaries.size(); ++k) {
        const Boundary& b = boundaries[k];
        if (!(b.mass > 0) || b.body >= 0) continue;
        const Vec3 before = b.r - options.h * moved[k].v, &low = options.low, &high = options.high;
        for (const auto& [axis, was, is, from, to, g] :
             {std::tuple{0u, before.x, b.r.x, low.x, high.x, options.gravity.x},
              {1u, before.y, b.r.y, low.y, high.y, options.gravity.y},
              {2u, before.z, b.r.z, low.z, high.z, options.gravity.z}}) {
            if (options.periodic[axis] || !b.free[axis] || !is_placed_along(b, axis)) continue;
            if (!(was >= from && was <= to) || (is >= from && is <= to)) continue;
            if (is > to ? g > 0 : g < 0)
                throw ToolLeft(left_text(k, b.r, boundary_names) + io::formatted(", at t = %.9g s", time));
            if ((record.warnings & WatchRecord::left) == 0)
                record.left_tool = static_cast<double>(k), record.left_time = time, record.left_place = b.r;
            record.warnings |= WatchRecord::left;
        }
    }
}

/// Sets the warnings. Throws OverlapTooLarge, EnergyCreated and ToolLeft.
void World::check_watch()
{
    WatchRecord& w = record;
    if (!tool_loads.empty()) check_tools();
    if (w.largest_overlap > watch_limit::overlap) w.warnings |= WatchRecord::deep;
    if (w.largest_displacement > watch_limit::displacement) w.warnings |= WatchRecord::fast;
    if (!(w.largest_overlap <= options.largest_overlap)) throw_overlap();
    // The two schemes gain energy in every collision.
    const bool gains = options.scheme == Scheme::forward_euler || options.scheme == Scheme::extended_taylor;
    const double gain = w.most_dissipated - w.dissipated;
    if (!sampling || gains || w.is_driven != 0 || gain <= watch_limit::energy * w.largest_kinetic ||
        gain <= w.gain_tolerance)
        return;
    w.gain_tolerance = gain_tolerance();
    if (gain <= w.gain_tolerance) return;
    throw EnergyCreated(io::formatted(
        "the grains have gained %.3g J until t = %.9g s, %.3g of their largest kinetic energy, although "
        "nothing drives them; the error of the integrator explains %.3g J at most; a smaller step is needed",
        gain, time, gain / w.largest_kinetic, w.gain_tolerance));
}

}  // namespace hilda::granular
