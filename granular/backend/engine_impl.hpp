// SPDX-License-Identifier: GPL-3.0-or-later
// Implementation of Engine for any back end.
#pragma once

#include "granular/backend/cpu_loops.hpp"
#include "granular/backend/engine.hpp"
#include "granular/backend/instruction_set.hpp"
#include "granular/backend/pair_lists.hpp"
#include "granular/backend/transfer.hpp"
#include "granular/backend/watch_arrays.hpp"
#include "granular/core/surfaces/hand_over.hpp"
#include "granular/core/surfaces/triangle_contacts.hpp"
#include "granular/core/sweep.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <type_traits>

#include <omp.h>

namespace hilda::granular {

namespace detail {

/// Whether a pair has a boundary with a mass
struct HasFreeBoundary {
    const std::uint32_t* j;
    Surfaces surfaces;
    HILDA_HD bool operator()(std::uint32_t n) const
    {
        return (j[n] & PairView::boundary_bit) != 0 &&
               surfaces.boundary[surfaces.boundary_of(j[n] & ~PairView::boundary_bit)].mass > 0;
    }
};

/// Force [N] and torque about Boundary::r [N m] of one pair on its boundary
struct BoundaryLoad {
    Vec3 F, T;
    std::uint32_t boundary;
};

/// Load of a pair on its boundary
struct ComputeBoundaryLoad {
    ParticleView particles;
    PairView pairs;
    Surfaces surfaces;
    const std::uint32_t* which;
    BoundaryLoad* out;
    HILDA_HD void operator()(std::uint32_t k) const
    {
        const std::uint32_t n = which[k], surface = pairs.j[n] & ~PairView::boundary_bit, i = pairs.i[n],
                            b = surfaces.boundary_of(surface);
        if (pairs.in_contact[n] == 0) {
            out[k] = {{0, 0, 0}, {0, 0, 0}, b};
            return;
        }
        const Load& load = pairs.load_of(n);
        const Vec3 F = -to_double(load.F), r = global_position(particles.grid, particles.position[i]);
        Vec3 T = surfaces.contact_lever(surface, r, particles.velocity[i].w, load.M.w).cross(F);
        if (pairs.torque != nullptr) T -= to_double(pairs.torque_of(n));
        out[k] = {F, T, b};
    }
};

/// Displacement of a particle since the last neighbour search [units]
struct DisplacementSinceBuild {
    const Position *now, *at_build;
    HILDA_HD float operator()(std::uint32_t k) const
    {
        // without a periodic image, because owner cells do not change between searches
        const auto x = static_cast<float>(wrapped_difference(now[k].x, at_build[k].x)),
                   y = static_cast<float>(wrapped_difference(now[k].y, at_build[k].y)),
                   z = static_cast<float>(wrapped_difference(now[k].z, at_build[k].z));
        return sqrt(x * x + y * y + z * z);
    }
};

}  // namespace detail

/// Engine on a back end: par::Cpu, par::Gpu, or a back end of a test
template <class Backend>
class EngineOn : public Engine {
public:
    Arrays<par::Cpu>& arrays() override
    {
        if constexpr (is_cpu) {
            return own;
        } else {
            if (!host_is_current) detail::copy(on, host, own);
            host_is_current = true;
            return host;
        }
    }
    void arrays_modified() override
    {
        if constexpr (is_cpu)
            triangle_contacts.wake();
        else
            detail::copy(on, own, host);
    }

    void set_laws(const std::vector<PairLaw>& all, const std::vector<std::uint8_t>& law_of_pair,
                  std::uint32_t count) override
    {
        materials = count;
        one_law = all.size() <= 1;
        rotation_laws = internal = false;
        for (const PairLaw& l : all)
            rotation_laws = rotation_laws || l.resists_rotation(), internal = internal || l.has_internal();
        send(laws, all), send(law_of, law_of_pair);
    }

    void set_meshes(std::shared_ptr<const Meshes> all) override
    {
        meshes = std::move(all);
        if constexpr (!is_cpu) {
            send(triangle, meshes->triangle), send(vertex, meshes->vertex);
            send(vertex_normal, meshes->vertex_normal);
            send(fan_start, meshes->fan_start), send(fan, meshes->fan);
        }
        blocks = {};
    }

    bool set_boundaries(const std::vector<Boundary>& all) override
    {
        if (all.size() == last_boundaries.size() &&
            (all.empty() || std::memcmp(static_cast<const void*>(all.data()), last_boundaries.data(),
                                        all.size() * sizeof(Boundary)) == 0))
            return false;
        last_boundaries = all;
        any_free = false;
        for (const Boundary& b : all) any_free = any_free || b.mass > 0;
        send(boundaries, all);
        return true;
    }

    void set_forces(const std::vector<Float4>& all) override { send(force, all); }

    void set_attached(const std::vector<AttachedParticle>& all) override
    {
        send(attached, all);
        find_attached();
    }

    void move_attached(const Domain& domain, const std::vector<BoundaryPose>& all) override
    {
        host_is_current = false;
        send(poses, all);
        Particles<Backend>& p = own.particle;
        par::for_each(
            on, static_cast<std::uint32_t>(attached.size()),
            MoveAttached{domain.grid, attached.data(), attached_index.data(), poses.data(), p.position.data(),
                         p.velocity.data(), p.omega.data(), p.compensation.data()});
    }

    void set_clumps(const Domain& domain, const ClumpTables& tables) override
    {
        send(clump_shape, tables.shape), send(clump_sphere, tables.sphere), send(clump_of, tables.of);
        clump_reach = tables.reach;
        list_members(domain);
    }

    void find_neighbours(const Domain& domain) override
    {
        host_is_current = false;
        assign_clumps(domain);
        // The members of clumps may be outside the domain by their distance from the centre of mass.
        const bool new_lists = blocks.update(domain.grid, double{domain.largest} + domain.skin + clump_reach,
                                             last_boundaries, *meshes);
        BoundaryBlockView near = blocks.view();
        if constexpr (!is_cpu) {
            if (new_lists) resting.send(*this, blocks.resting), moving.send(*this, blocks.moving);
            resting.replace(near.resting), moving.replace(near.moving);
        }
        const SearchInput input{.domain = domain,
                                .law_of = one_law ? nullptr : law_of.data(),
                                .materials = materials,
                                .surfaces = surfaces(),
                                .near = near,
                                .rotation_laws = rotation_laws,
                                .internal = internal,
                                .clump_of = clump_of.size() > 0 ? clump_of.data() : nullptr};
        if constexpr (is_cpu)
            loops->find_neighbours(neighbours, input, own.particle, own.pairs);
        else
            neighbours.find(input, own.particle, own.pairs);
        find_attached();
        list_members(domain);
        plan.reset();
        free_pairs = 0;
        if (any_free)
            free_pairs =
                list_pairs(detail::HasFreeBoundary{own.pairs.j.data(), surfaces()}, with_free_boundary);
        triangle_pairs = 0;
        if (!meshes->triangle.empty())
            triangle_pairs = list_pairs(HasTriangle{own.pairs.j.data()}, with_triangle);
        if constexpr (is_cpu)
            loops->list_triangles(triangle_contacts, pair_view(), surfaces(), with_triangle.data(),
                                  triangle_pairs);
        if (watched) prepare_watch();
    }

    void find_loads(const Domain& domain, const LoadTimes& times, bool store,
                    [[maybe_unused]] double path) override
    {
        host_is_current = false;
        if constexpr (is_cpu) {
            const SweepPlan::Ahead ahead = store     ? SweepPlan::Ahead::all
                                           : watched ? SweepPlan::Ahead::with_fixed
                                                     : SweepPlan::Ahead::none;
            if (!plan.is_for(omp_get_max_threads(), ahead)) {
                plan.make(own.particle, own.pairs, omp_get_max_threads(), ahead);
                if (watched) resize_overlaps();
            }
        }
        PairView pairs = pair_view();
        if (watched) pairs.largest_overlap = watch.overlaps();
        const ParticleView particles = particle_view(domain, own.particle);
        if constexpr (is_cpu) {
            // Those with triangles are the last ones of the list.
            const auto others = static_cast<std::uint32_t>(plan.list.size()) - triangle_pairs;
            loops->find_listed_loads(on, particles, pairs, law_view(times), plan.list.data(), others);
            loops->find_triangle_loads(triangle_contacts, particles, pairs, law_view(times),
                                       own.pairs.start.data(), path);
            pending = {particles, pairs, law_view(times)};
        } else {
            if (triangle_pairs > 0)
                par::for_each(
                    on, triangle_pairs,
                    HandOver{particles, pairs, surfaces(), with_triangle.data(), own.pairs.start.data()});
            granular::find_loads(on, particles, pairs, law_view(times));
        }
    }

    float advance(const StepParameters& step) override
    {
        host_is_current = false;
        Particles<Backend>& p = own.particle;
        const AdvanceView arrays{.position = p.position.data(),
                                 .velocity = p.velocity.data(),
                                 .omega = p.omega.data(),
                                 .compensation = p.compensation.data(),
                                 .acc = p.acc.data(),
                                 .alpha = p.alpha.data(),
                                 .orientation = p.orientation.data(),
                                 .orientation_compensation = p.orientation_compensation.data(),
                                 .start = own.pairs.start.data(),
                                 .other_start = own.pairs.other_start.data(),
                                 .other = own.pairs.other.data(),
                                 .load = own.pairs.load.data(),
                                 .in_contact = own.pairs.in_contact.data(),
                                 .torque = rotation_laws ? own.pairs.torque.data() : nullptr,
                                 .force = force.size() > 0 ? force.data() : nullptr,
                                 .id = p.id.data(),
                                 .step = step,
                                 .total = clump_of.size() > 0 ? particle_loads.data() : nullptr,
                                 .ghost = p.ghost.size() > 0 ? p.ghost.data() : nullptr};
        const float of_particles = advance_particles(arrays);
        if (own.clump.size() == 0) return of_particles;
        // The members have been advanced as particles of their own. They are placed again.
        return par::nan_max(of_particles, par::largest(on, static_cast<std::uint32_t>(own.clump.size()),
                                                       AdvanceClump{members(), own.clump.data(),
                                                                    particle_loads.data(), step}));
    }

    float largest_displacement() override
    {
        return par::largest(on, own.particle.count,
                            detail::DisplacementSinceBuild{own.particle.position.data(),
                                                           own.particle.position_at_build.data()});
    }

    const std::vector<Wrench>& free_boundary_wrenches(const Domain& domain) override
    {
        find_wrench_parts(domain);
        return wrenches_of_parts();
    }

    void set_watched(bool is_watched) override
    {
        watched = is_watched;
        plan.reset();
        if (watched && own.pairs.start.size() > 0) prepare_watch();
    }

    float take_largest_overlap() override { return watch.take_largest_overlap(on); }

    ExternalSums external_sums(const Domain& domain, const std::vector<BoundaryVelocity>& before,
                               const std::vector<BoundaryVelocity>& after) override
    {
        return external_part(domain, before, after).value();
    }

    ParticleSums particle_sums(const Domain& domain, bool only_forces) override
    {
        return particle_part(domain, only_forces).value();
    }

    ContactSums contact_sums(const Domain& domain, float h) override
    {
        return contact_part(domain, h).value();
    }

    KineticSums kinetic_sums(double s) override { return kinetic_part(s).value(); }

    void wait() override { par::wait(on); }

    double copy_rate() override
    {
        constexpr std::size_t size = std::size_t{1} << 28;
        constexpr int times = 8;
        par::Array<Backend, char> from(size), to(size);
        par::fill(on, from.data(), size, char{1}), par::fill(on, to.data(), size, char{2});
        wait();
        const auto begin = std::chrono::steady_clock::now();
        for (int k = 0; k < times; ++k) par::copy_bytes(on, to.data(), from.data(), size);
        wait();
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
        return 2.0 * times * size / seconds.count();
    }

    std::size_t bytes() const override
    {
        return own.particle.bytes() + own.pairs.bytes() + force.bytes() + neighbours.bytes() +
               with_free_boundary.bytes() + lister.bytes() + boundary_loads.bytes() + watch.bytes() +
               attached.bytes() + attached_index.bytes() + poses.bytes() + plan.bytes() + blocks.bytes() +
               resting.bytes() + moving.bytes() + triangle.bytes() + vertex.bytes() + vertex_normal.bytes() +
               fan_start.bytes() + fan.bytes() + with_triangle.bytes() + triangle_contacts.bytes() +
               (is_cpu ? meshes->bytes() : 0) + own.clump.bytes() + clump_shape.bytes() +
               clump_sphere.bytes() + clump_of.bytes() + clump_index.bytes() + particle_loads.bytes();
    }

protected:
    static constexpr bool is_cpu = std::is_same_v<Backend, par::Cpu>;

    // The sums of this process; see Engine.

    ExternalPart external_part(const Domain& domain, const std::vector<BoundaryVelocity>& before,
                               const std::vector<BoundaryVelocity>& after)
    {
        return watch.external_sums(on, particle_view(domain, own.particle), pair_view(), surfaces(), before,
                                   after);
    }

    ParticlePart particle_part(const Domain& domain, bool only_forces)
    {
        const Particles<Backend>& p = own.particle;
        if (!only_forces)
            par::copy_bytes(on, neighbours.position_copy(), p.position.data(), p.count * sizeof(Position));
        return watch.particle_sums(on, particle_view(domain, p), p, force.size() > 0 ? force.data() : nullptr,
                                   clump_view(), only_forces);
    }

    ContactPart contact_part(const Domain& domain, float h)
    {
        ParticleView particles = particle_view(domain, own.particle);
        particles.position = neighbours.position_copy();
        return watch.contact_sums(on, particles, pair_view(), law_view({h, 0}), loops);
    }

    KineticPart kinetic_part(double s) { return watch.kinetic_sums(on, own.particle, clump_view(), s); }

    /// Force and torque on a boundary with a mass
    struct WrenchPart {
        FixedVec F, T;
        WrenchPart& operator+=(const WrenchPart& o)
        {
            F += o.F, T += o.T;
            return *this;
        }
    };
    /// Sets wrench_parts.
    void find_wrench_parts(const Domain& domain)
    {
        boundary_loads.resize(free_pairs);
        par::for_each(
            on, free_pairs,
            detail::ComputeBoundaryLoad{particle_view(domain, own.particle), pair_view(), surfaces(),
                                        with_free_boundary.data(), boundary_loads.data()});
        host_boundary_loads.resize(free_pairs);
        par::copy_to_host(on, host_boundary_loads.data(), boundary_loads.data(),
                          free_pairs * sizeof(detail::BoundaryLoad));
        wrench_parts.assign(last_boundaries.size(), {});
        for (const detail::BoundaryLoad& load : host_boundary_loads)
            wrench_parts[load.boundary].F += load.F, wrench_parts[load.boundary].T += load.T;
    }

    const std::vector<Wrench>& wrenches_of_parts()
    {
        wrenches.clear();
        for (const WrenchPart& part : wrench_parts) wrenches.push_back({part.F.value(), part.T.value()});
        return wrenches;
    }

    PairView pair_view() const
    {
        const Pairs<Backend>& p = own.pairs;
        return {.i = p.i.data(),
                .j = p.j.data(),
                .law = one_law ? nullptr : p.law.data(),
                .history = p.history.data(),
                .rotation_history = rotation_laws ? p.rotation_history.data() : nullptr,
                .load = p.load.data(),
                .torque = rotation_laws ? p.torque.data() : nullptr,
                .in_contact = p.in_contact.data(),
                .count = p.count,
                .internal = internal ? p.internal.data() : nullptr,
                .stored = is_cpu ? plan.stored() : StoredLoads{},
                .image = p.image.size() > 0 ? p.image.data() : nullptr};
    }

    LawView law_view(const LoadTimes& times) const
    {
        return {laws.data(), static_cast<int>(laws.size()), surfaces(), times.h, times.lag};
    }

    Surfaces surfaces() const
    {
        if constexpr (is_cpu) return {boundaries.data(), meshes->view()};
        return {boundaries.data(),
                {triangle.data(), vertex.data(), vertex_normal.data(), fan_start.data(), fan.data()}};
    }

    float advance_particles(const AdvanceView& arrays)
    {
        const std::uint32_t n = own.particle.count;
        if constexpr (is_cpu) {
            if (arrays.step.part == Part::before_loads) return loops->advance_before_loads(on, n, arrays);
            return loops->sweep(on, pending.particles, pending.pairs, pending.laws, arrays, plan, n);
        } else {
            return granular::advance(on, n, arrays);
        }
    }

    ClumpView clump_view() const
    {
        if (clump_of.size() == 0) return {};
        return {clump_of.data(), own.particle.id.data(), own.clump.data()};
    }

    MemberView members()
    {
        Particles<Backend>& p = own.particle;
        return {.grid = clump_grid,
                .shape = clump_shape.data(),
                .sphere = clump_sphere.data(),
                .index = clump_index.data(),
                .position = p.position.data(),
                .velocity = p.velocity.data(),
                .omega = p.omega.data(),
                .compensation = p.compensation.data(),
                .orientation = p.orientation.data(),
                .orientation_compensation = p.orientation_compensation.data()};
    }

    /// Lists the indices of the particles by id, with the order of the particles in the arrays.
    void list_members(const Domain& domain)
    {
        if (clump_of.size() == 0) return;
        clump_grid = domain.grid;
        clump_index.resize(clump_of.size()), particle_loads.resize(own.particle.count);
        par::for_each(on, own.particle.count, ListIds{own.particle.id.data(), clump_index.data()});
    }

    /// Assigns the clumps to their cells.
    void assign_clumps(const Domain& domain)
    {
        if (own.clump.size() == 0) return;
        const float outside = par::largest(
            on, static_cast<std::uint32_t>(own.clump.size()),
            AssignClumpCell{{domain.grid, nullptr, nullptr, nullptr, nullptr}, own.clump.data()});
        if (outside == 0) return;
        ClumpBody one;
        par::copy_to_host(on, &one, own.clump.data() + static_cast<std::size_t>(outside) - 1, sizeof one);
        throw LeftDomain{one.first_id};
    }

    /// Lists the indices of the attached particles.
    void find_attached()
    {
        if (attached.size() == 0) return;
        attached_index.resize(attached.size());
        par::fill(on, attached_index.data(), attached_index.size(), not_listed);
        par::for_each(on, own.particle.count,
                      FindAttached{own.particle.id.data(), attached.data(),
                                   static_cast<std::uint32_t>(attached.size()), attached_index.data()});
    }

    /// See PairLister; after a neighbour search
    template <class Condition>
    std::uint32_t list_pairs(const Condition& condition, par::Array<Backend, std::uint32_t>& list)
    {
        return lister.list_pairs(on, condition, own.pairs.count, list);
    }
    template <class T>
    void send(par::Array<Backend, T>& to, const std::vector<T>& from)
    {
        detail::send(on, to, from);
    }

    void prepare_watch()
    {
        watch.prepare(on, own, boundaries.size() > 0, lister);
        resize_overlaps();
    }
    /// One number for each task of a loop that compares overlaps
    void resize_overlaps()
    {
        const auto tasks = [](std::size_t n, std::size_t of_task) { return (n + of_task - 1) / of_task; };
        watch.resize_overlaps(on, is_cpu ? std::max(tasks(own.particle.count, SweepPlan::block),
                                                    tasks(plan.list.size(), list_chunk))
                                         : 1);
    }

    static const CpuLoops* loops_of_backend()
    {
        if constexpr (is_cpu) return &cpu_loops();
        return nullptr;
    }

    const Backend on = {};
    const CpuLoops* const loops = loops_of_backend();  ///< of the CPU, for the life of the engine
    Arrays<Backend> own;
    Arrays<par::Cpu> host;  ///< copy of a GPU's arrays; up to date if host_is_current
    bool host_is_current = false;
    Neighbours<Backend> neighbours;
    par::Array<Backend, PairLaw> laws;
    par::Array<Backend, std::uint8_t> law_of;
    par::Array<Backend, Boundary> boundaries;
    par::Array<Backend, Float4> force;
    par::Array<Backend, AttachedParticle> attached;
    par::Array<Backend, std::uint32_t> attached_index;  ///< see FindAttached
    par::Array<Backend, BoundaryPose> poses;
    par::Array<Backend, ClumpShape> clump_shape;
    par::Array<Backend, ClumpSphere> clump_sphere;
    par::Array<Backend, std::uint32_t> clump_of, clump_index;  ///< see ClumpTables; particles by id
    par::Array<Backend, Load> particle_loads;                  ///< see AdvanceView::total
    double clump_reach = 0;
    CellGrid clump_grid;
    std::vector<Boundary> last_boundaries;
    BoundaryBlocks blocks;  ///< of last_boundaries
    /// Lists of `blocks` in the memory of a GPU
    struct SurfaceArrays {
        par::Array<Backend, std::uint32_t> start, surface;
        void send(EngineOn& engine, const SurfaceLists& from)
        {
            engine.send(start, from.start), engine.send(surface, from.surface);
        }
        void replace(SurfaceListView& view) const
        {
            view.start = start.data(), view.surface = surface.data();
        }
        std::size_t bytes() const { return start.bytes() + surface.bytes(); }
    } resting, moving;
    std::shared_ptr<const Meshes> meshes = std::make_shared<Meshes>();
    // the same in the memory of a GPU; see MeshView
    par::Array<Backend, MeshTriangle> triangle;
    par::Array<Backend, Vec3> vertex, vertex_normal;
    par::Array<Backend, std::uint32_t> fan_start, fan;
    SweepPlan plan;                      ///< of the CPU
    TriangleContacts triangle_contacts;  ///< of the CPU
    /// Arguments of find_loads() for the pass in advance()
    struct Pending {
        ParticleView particles;
        PairView pairs;
        LawView laws;
    } pending = {};
    std::uint32_t materials = 1, free_pairs = 0, triangle_pairs = 0;
    bool one_law = true, rotation_laws = false, internal = false, any_free = false;
    par::Array<Backend, std::uint32_t> with_free_boundary, with_triangle;  ///< numbers of these pairs
    detail::PairLister<Backend> lister;
    par::Array<Backend, detail::BoundaryLoad> boundary_loads;
    std::vector<detail::BoundaryLoad> host_boundary_loads;
    std::vector<WrenchPart> wrench_parts;  ///< by boundary number
    std::vector<Wrench> wrenches;
    bool watched = false;
    WatchArrays<Backend> watch;
};

}  // namespace hilda::granular
