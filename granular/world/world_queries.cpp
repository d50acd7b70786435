// SPDX-License-Identifier: GPL-3.0-or-later
// Queries of a world: particles, energy, momentum, step limits, memory.
#include "granular/backend/fixed_sum.hpp"
#include "granular/core/pair_law.hpp"
#include "granular/world/world_impl.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace hilda::granular {

using namespace detail;

/// State of the particle with index k in these arrays
Particle World::particle_at(const Particles<par::Cpu>& in, std::uint32_t k) const
{
    const Float4 v = in.velocity.data()[k], w = in.omega.data()[k];
    const Compensation& compensation = in.compensation.data()[k];
    const Species species = in.species.data()[k];
    Particle p;
    p.id = in.id.data()[k];
    p.r = global_position(domain.grid, in.position.data()[k]) +
          domain.grid.unit * to_double(unpack_remainder<float>(compensation.displacement));
    p.v = to_double(v) + to_double(load_bfloat16(compensation.v));
    p.omega = to_double(w) + to_double(load_bfloat16(compensation.omega));
    if (in.orientation.size() > 0) {
        const Float4 e = in.orientation.data()[k], remainder = in.orientation_compensation.data()[k];
        p.e = unit({double(e.x) + remainder.x, double(e.y) + remainder.y, double(e.z) + remainder.z,
                    double(e.w) + remainder.w});
    }
    p.radius = v.w;
    p.material = species.material;
    p.replica = species.replica;
    p.fixed = w.w == 0;
    p.mass =
        p.fixed ? sphere_mass(p.radius, materials[species.material].density) : 1 / static_cast<double>(w.w);
    if (const std::uint32_t c = clump_of(p.id); c != no_clump) {
        p.mass *= fraction_of(p.id, c);
        p.clump = engine->arrays().clump.data()[c].first_id;
    }
    return p;
}

void World::each_particle(const std::function<void(const Particle&)>& f) const
{
    std::vector<std::uint32_t> order;
    engine->each_piece_by_id(next_id, [&](const Particles<par::Cpu>& in) {
        const std::uint32_t* const id = in.id.data();
        order.resize(in.count);
        if (next_id == order.size()) {  // all that there ever were
            for (std::uint32_t k = 0; k < order.size(); ++k) order[id[k]] = k;
        } else {
            std::iota(order.begin(), order.end(), 0);
            std::sort(order.begin(), order.end(),
                      [&](std::uint32_t a, std::uint32_t b) { return id[a] < id[b]; });
        }
        for (const std::uint32_t k : order) f(particle_at(in, k));
    });
    for (const Particle& p : pending) {
        if (p.clump < 0) {
            f(p);
            continue;
        }
        const auto of = std::lower_bound(pending_clumps.begin(), pending_clumps.end(), p.clump,
                                         [](const Clump& c, std::int64_t first) { return c.id < first; });
        const ClumpShape& shape = clump_tables.shape[static_cast<std::size_t>(of->shape)];
        Particle part = p;
        part.mass *= clump_tables.sphere[shape.first + static_cast<std::uint32_t>(p.id - p.clump)].fraction;
        f(part);
    }
}

std::vector<Particle> World::particles() const
{
    std::vector<Particle> all;
    all.reserve(count());
    each_particle([&](const Particle& p) { all.push_back(p); });
    return all;
}

double World::volume() const
{
    const Vec3 size = options.high - options.low;
    return size.x * size.y * size.z;
}

void World::Sums::add(const Particle& p, const Vec3& w, const Vec3& gravity)
{
    kinetic_energy += 0.5 * p.mass * (p.v.dot(p.v) + 0.4 * p.radius * p.radius * p.omega.dot(w));
    rotational_energy += 0.2 * p.mass * p.radius * p.radius * p.omega.dot(w);
    if (!p.fixed) potential_energy -= p.mass * gravity.dot(p.r);
    momentum += p.mass * p.v;
}

namespace {

/// A sum whose terms can be added in any order; beyond the range of FixedSum one of doubles
struct AnySum {
    FixedSum exact;
    double near = 0;

    AnySum& operator+=(double x)
    {
        exact += x, near += x;
        return *this;
    }
    void add(const double* x, std::size_t n)
    {
        add_all(exact, x, n);
        near = std::accumulate(x, x + n, near);
    }
    AnySum& operator+=(const AnySum& o)
    {
        exact += o.exact, near += o.near;
        return *this;
    }
    double value() const
    {
        const double x = exact.value();
        return std::isnan(x) ? near : x;
    }
};

/// World::Sums of any parts
struct PartialSums {
    AnySum kinetic_energy, rotational_energy, potential_energy, momentum[3];

    PartialSums& operator+=(const World::Sums& p)
    {
        kinetic_energy += p.kinetic_energy, rotational_energy += p.rotational_energy;
        potential_energy += p.potential_energy;
        momentum[0] += p.momentum.x, momentum[1] += p.momentum.y, momentum[2] += p.momentum.z;
        return *this;
    }
    PartialSums& operator+=(const PartialSums& p)
    {
        kinetic_energy += p.kinetic_energy, rotational_energy += p.rotational_energy;
        potential_energy += p.potential_energy;
        for (int k = 0; k < 3; ++k) momentum[k] += p.momentum[k];
        return *this;
    }
};

/// The terms of up to `most` particles, by components
template <std::size_t most>
struct SumTerms {
    double kinetic_energy[most], rotational_energy[most], potential_energy[most], momentum[3][most];
    std::size_t count = 0;

    void add(const World::Sums& p)
    {
        kinetic_energy[count] = p.kinetic_energy, rotational_energy[count] = p.rotational_energy;
        potential_energy[count] = p.potential_energy;
        momentum[0][count] = p.momentum.x, momentum[1][count] = p.momentum.y,
        momentum[2][count] = p.momentum.z;
        ++count;
    }
    void finish(PartialSums& to) const
    {
        to.kinetic_energy.add(kinetic_energy, count), to.rotational_energy.add(rotational_energy, count);
        to.potential_energy.add(potential_energy, count);
        for (int k = 0; k < 3; ++k) to.momentum[k].add(momentum[k], count);
    }
};

}  // namespace

World::Sums World::sums() const
{
    const Vec3 gravity = {options.periodic[0] ? 0 : options.gravity.x,
                          options.periodic[1] ? 0 : options.gravity.y,
                          options.periodic[2] ? 0 : options.gravity.z};
    PartialSums all;
    const auto sums_of = [&](const Particle& p, const Vec3& w) {
        Sums one;
        one.add(p, w, gravity);
        return one;
    };
    engine->each_piece(false, [&](const Piece& piece) {
        const Particles<par::Cpu>& in = piece.arrays.particle;
        const std::uint32_t count = piece.particles;
        constexpr std::uint32_t block = 1024;
        std::vector<PartialSums> of_block((count + block - 1) / block);
        par::for_each(
            par::Cpu(), of_block.size(),
            [&](std::uint32_t number) {
                SumTerms<block> terms;
                for (std::uint32_t k = number * block; k < std::min((number + 1) * block, count); ++k)
                    if (const std::uint32_t id = in.id.data()[k], c = clump_of(id); c == no_clump) {
                        const Particle p = particle_at(in, k);
                        terms.add(sums_of(p, p.omega));
                    } else if (const ClumpState s = clump_state(c); s.body.id == id) {
                        terms.add(sums_of(s.body, s.w));
                    }
                terms.finish(of_block[number]);
            },
            2);
        for (const PartialSums& part : of_block) all += part;
    });
    for (const Particle& p : pending)
        if (p.clump < 0) all += sums_of(p, p.omega);
    for (const Clump& c : pending_clumps) {
        const ClumpState s = clump_state(c);
        all += sums_of(s.body, s.w);
    }
    return {.kinetic_energy = all.kinetic_energy.value(),
            .rotational_energy = all.rotational_energy.value(),
            .potential_energy = all.potential_energy.value(),
            .momentum = {all.momentum[0].value(), all.momentum[1].value(), all.momentum[2].value()}};
}

namespace {

/// Smallest distance of a round boundary from its axis or centre [m]
double narrowest_radius(const Boundary& b)
{
    return b.shape == Boundary::Shape::frustum ? std::min(b.radius, b.second_radius) : b.radius;
}

/// The place inside a boundary with the largest curvature
Nearest narrowest_place(const Boundary& b)
{
    Nearest near = nearest(b, b.r);
    if (b.shape != Boundary::Shape::frustum) return near;
    const double radius = narrowest_radius(b);  // the mean curvature of a cone at this distance from its axis
    near.curvature = radius > 0 ? -b.cosine / (2 * radius) : -infinite_curvature;
    return near;
}

}  // namespace

World::StepLimits World::step_limits(double least_speed) const
{
    StepLimits limits;
    double speed = least_speed;
    const auto each = [&](const auto& f) {
        each_particle(f);
        for (const Expected& e : expected)
            for (const Particle& p : e.samples) f(p);
    };
    each([&](const Particle& p) { speed = std::max(speed, p.v.norm()); });
    const auto add_collision = [&](double mass, double R) {
        double& shortest = limits.collision;
        const auto add = [&](const auto& l) {
            if constexpr (requires { l.collision_time(mass, R, speed); }) {
                shortest = std::min(shortest, l.collision_time(mass, R, speed));
            } else if constexpr (requires { l.k_n, l.gamma_n; }) {
                shortest = std::min(shortest, M_PI * std::sqrt(mass / static_cast<double>(l.k_n)));
                if (l.gamma_n > 0)  // a damper alone is stable up to h = 2/γ
                    shortest = std::min(shortest, M_PI / static_cast<double>(l.gamma_n));
            } else if constexpr (requires { l.E_eff; }) {
                const double E_eff = l.E_eff;
                shortest =
                    std::min(shortest, 2.87 * std::pow(mass * mass / (R * E_eff * E_eff * speed), 0.2));
            }
        };
        for (const PairLaw& law : laws) law.normal.visit(add);
    };
    each([&](const Particle& p) {
        const Material& m = materials[static_cast<std::size_t>(p.material)];
        if (p.fixed) return;
        limits.rayleigh = std::min(limits.rayleigh, rayleigh_time(p.radius, m));
        add_collision(p.mass / 2, p.radius / 2);  // of two equal particles
        for (const Boundary& b : boundaries)      // of a bowl or tube that is little larger than the particle
            if (b.inside != 0 && !is_larger_than(b, p.radius) && narrowest_radius(b) < 2 * p.radius)
                add_collision(1 / (1 / p.mass + b.inverse_mass()),
                              effective_radius(b, p.radius, narrowest_place(b)));
    });
    return limits;
}

void World::boundary_stiffness(std::vector<double>& sum) const
{
    update_for_query();
    sum.assign(boundaries.size(), 0);
    engine->each_piece(true, [&](const Piece& piece) {
        const Arrays<par::Cpu>& of = piece.arrays;
        const Pairs<par::Cpu>& pairs = of.pairs;
        for (std::uint32_t n = 0; n < pairs.count; ++n) {
            const std::uint32_t j = pairs.j.data()[n], surface = j & ~PairView::boundary_bit;
            if (j == surface) continue;
            const std::uint32_t i = pairs.i.data()[n];
            const double R = of.particle.velocity.data()[i].w;
            const Nearest near =
                surfaces().nearest(surface, global_position(domain.grid, of.particle.position.data()[i]), R);
            if (!(R > near.distance)) continue;
            const std::uint32_t k = surfaces().boundary_of(surface);
            const Boundary& b = boundaries[k];
            ContactPoint<double> contact{};
            contact.delta = R - near.distance, contact.R_i = R, contact.m_eff = 1;
            contact.R_eff = effective_radius(b, R, near);
            History<double> history{};
            if (pairs.internal.size() > 0 && pairs.in_contact.data()[n] != 0)
                history.largest_overlap = pairs.internal.data()[n].x;
            const PairLaw& law = laws[laws.size() > 1 ? pairs.law.data()[n] : 0];
            sum[b.body >= 0 ? static_cast<std::size_t>(b.body) : k] +=
                normal_stiffness(law, contact, history);
        }
    });
}

double World::contact_stiffness(int boundary, double overlap) const
{
    const Boundary& b = boundaries[static_cast<std::size_t>(boundary)];
    double largest = 0;
    each_particle([&](const Particle& p) {
        const std::uint8_t law = law_of[static_cast<std::size_t>(p.material) * materials.size() +
                                        static_cast<std::size_t>(b.material)];
        if (law == no_law) return;
        ContactPoint<double> contact{};
        contact.delta = overlap * p.radius, contact.R_i = contact.R_eff = p.radius, contact.m_eff = 1;
        largest = std::max(largest, normal_stiffness(laws[law], contact, {}));
    });
    return largest;
}

bool World::laws_have_energy() const
{
    return std::all_of(laws.begin(), laws.end(), [](const PairLaw& law) { return law.has_energy(); });
}

std::size_t World::bytes_needed(std::size_t n, bool rotation_laws, bool orientation, Device::Kind device)
{
    // A settled bed of equal spheres has 3.5 to 4 pairs per particle with the default skin, and 2.3 to 2.5
    // contacts. The CPU stores the loads of 2 to 7 % of the pairs; see SweepPlan.
    constexpr double pairs = 3.6, contacts = 2.3, head_room = 1 + 1 / 32.;
    const double loads = device == Device::cpu ? 0.06 * pairs : pairs;
    constexpr double of_state = 2 * sizeof(Position) + 2 * sizeof(Float4) + sizeof(Compensation) +
                                sizeof(Species) + sizeof(std::uint32_t),
                     of_search = sizeof(Float4) + sizeof(std::uint64_t) + 5 * sizeof(std::uint32_t) +
                                 contacts * sizeof(SavedContact),
                     of_watch = sizeof(Velocities) + sizeof(ParticlePart) / 64., of_sweep = sizeof(Load),
                     of_pair = 2 * sizeof(std::uint32_t) + sizeof(Float4) + 2,
                     of_load = sizeof(Load) + 2 * sizeof(std::uint32_t);
    const double each = of_state + of_search + of_watch + of_sweep + pairs * of_pair + loads * of_load +
                        (rotation_laws ? sizeof(Float4) * (1 + contacts + pairs + loads) : 0) +
                        (orientation ? 2 * sizeof(Float4) : 0);
    return static_cast<std::size_t>(head_room * each * static_cast<double>(n));
}

namespace {

/// The force at an overlap of a hundredth of the radius. v: rate of the overlap and tangential velocity [m/s]
template <class R>
ContactForce<R> sample_force(const PairLaw& law, double radius, double mass, bool at_boundary, double v,
                             double h)
{
    const auto single = [](double x) { return static_cast<R>(x); };
    ContactPoint<R> contact{};
    contact.delta = single(0.01 * radius), contact.h = single(h);
    contact.R_i = single(radius), contact.R_j = single(at_boundary ? 0 : radius);
    contact.R_eff = single(at_boundary ? radius : radius / 2);
    contact.m_eff = single(at_boundary ? mass : mass / 2);
    contact.n = {R(0), R(0), R(1)}, contact.v_n = single(v), contact.v_t = {single(v), R(0), R(0)};
    History<R> none{};
    return evaluate(law, contact, none, law.resists_rotation());
}

}  // namespace

bool detail::has_single_forces(const PairLaw& law, double radius, double mass, double h)
{
    constexpr double largest_error = 0.01;
    for (const bool at_boundary : {false, true}) {
        // about the speed of a collision with this overlap
        const double elastic = std::abs(sample_force<double>(law, radius, mass, at_boundary, 0, h).F.z),
                     v = std::sqrt(elastic * 0.01 * radius / mass);
        const ContactForce<double> exact = sample_force<double>(law, radius, mass, at_boundary, v, h);
        const ContactForce<float> rounded = sample_force<float>(law, radius, mass, at_boundary, v, h);
        const auto agree = [&](double a, float b, double scale) {
            // A force that is itself out of range is found at the contact that has it.
            const bool is_out = std::abs(a) > double(std::numeric_limits<float>::max());
            return is_out || std::abs(a - double(b)) <= largest_error * scale;
        };
        if (!agree(exact.F.z, rounded.F.z, std::abs(exact.F.z) + elastic) ||
            !agree(exact.F_t.x, rounded.F_t.x, std::abs(exact.F_t.x)))
            return false;
    }
    return true;
}

}  // namespace hilda::granular
