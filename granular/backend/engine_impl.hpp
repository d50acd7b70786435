// SPDX-License-Identifier: GPL-3.0-or-later
// Implementation of Engine for any back end.
#pragma once

#include "granular/backend/engine.hpp"

#include <chrono>
#include <cstring>
#include <type_traits>

namespace hilda::granular {

namespace detail {

/// flag[n] = 1 for a pair with a boundary that has a mass
struct FlagFreeBoundaryPair {
    const std::uint32_t* j;
    const Boundary* boundary;
    std::uint32_t* flag;
    HILDA_HD void operator()(std::uint32_t n) const
    {
        flag[n] =
            (j[n] & PairView::boundary_bit) != 0 && boundary[j[n] & ~PairView::boundary_bit].mass > 0 ? 1 : 0;
    }
};

/// Writes the indices of the flagged pairs, in their order.
struct CompactIndices {
    const std::uint32_t* offset;  ///< number of flagged pairs before each pair
    std::uint32_t* which;
    HILDA_HD void operator()(std::uint32_t n) const
    {
        if (offset[n + 1] > offset[n]) which[offset[n]] = n;
    }
};

/// Force [N] and torque about Boundary::r [N m] of one pair on its boundary
struct BoundaryLoad {
    Vec3 F, T;
    std::uint32_t boundary;
};

/// Load of a pair on its boundary
struct ComputeBoundaryLoad {
    CellGrid grid;
    const Position* position;
    const std::uint32_t *i, *j;
    const Load* load;
    const Float4* torque;
    const Boundary* boundary;
    const std::uint32_t* which;
    BoundaryLoad* out;
    HILDA_HD void operator()(std::uint32_t k) const
    {
        const std::uint32_t n = which[k], b = j[n] & ~PairView::boundary_bit;
        const Float4 f = load[n].F;
        const Vec3 F{-f.x, -f.y, -f.z}, r = global_position(grid, position[i[n]]);
        const Nearest near = nearest(boundary[b], r);
        Vec3 T = (r - near.distance * near.n - boundary[b].r).cross(F);
        if (torque != nullptr) T -= {torque[n].x, torque[n].y, torque[n].z};
        out[k] = {F, T, b};
    }
};

/// Displacement of a particle since the last neighbour search [units]
struct DisplacementSinceBuild {
    const Position *now, *at_build;
    HILDA_HD float operator()(std::uint32_t k) const
    {
        // owner cells do not change between searches, so the difference is that of the local coordinates
        const auto x = static_cast<float>(now[k].x - at_build[k].x),
                   y = static_cast<float>(now[k].y - at_build[k].y),
                   z = static_cast<float>(now[k].z - at_build[k].z);
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
            if (!host_is_current) copy(host, own);
            host_is_current = true;
            return host;
        }
    }
    void arrays_modified() override
    {
        if constexpr (!is_cpu) copy(own, host);
    }

    void set_laws(const std::vector<PairLaw>& all, const std::vector<std::uint8_t>& law_of_pair,
                  std::uint32_t count) override
    {
        materials = count;
        one_law = all.size() <= 1;
        rotation_laws = false;
        for (const PairLaw& l : all) rotation_laws = rotation_laws || l.resists_rotation();
        send(laws, all), send(law_of, law_of_pair);
    }

    void set_boundaries(const std::vector<Boundary>& all) override
    {
        if (all.size() == last_boundaries.size() &&
            (all.empty() || std::memcmp(static_cast<const void*>(all.data()), last_boundaries.data(),
                                        all.size() * sizeof(Boundary)) == 0))
            return;
        last_boundaries = all;
        any_free = false;
        for (const Boundary& b : all) any_free = any_free || b.mass > 0;
        send(boundaries, all);
    }

    void set_forces(const std::vector<Float4>& all) override { send(force, all); }

    void find_neighbours(const Domain& domain) override
    {
        host_is_current = false;
        neighbours.find({.domain = domain,
                         .law_of = one_law ? nullptr : law_of.data(),
                         .materials = materials,
                         .boundary = boundaries.data(),
                         .boundaries = static_cast<std::uint32_t>(boundaries.size()),
                         .rotation_laws = rotation_laws},
                        own.particle, own.pairs);
        free_pairs = 0;
        if (!any_free) return;
        const std::uint32_t n = own.pairs.count;
        counts.resize(n), offset.resize(n + 1);
        par::for_each(on, n,
                      detail::FlagFreeBoundaryPair{own.pairs.j.data(), boundaries.data(), counts.data()});
        free_pairs = static_cast<std::uint32_t>(par::exclusive_scan(on, counts.data(), offset.data(), n));
        par::for_each(on, n, detail::CompactIndices{offset.data(), counts.data()});
    }

    void find_loads(const Domain& domain, float h) override
    {
        host_is_current = false;
        granular::find_loads(on, particle_view(domain, own.particle), pair_view(),
                             {laws.data(), static_cast<int>(laws.size()), boundaries.data(), h});
    }

    float advance(const StepParameters& step) override
    {
        host_is_current = false;
        Particles<Backend>& p = own.particle;
        return granular::advance(on, p.count,
                                 {.position = p.position.data(),
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
                                  .step = step});
    }

    float largest_displacement() override
    {
        return par::largest(on, own.particle.count,
                            detail::DisplacementSinceBuild{own.particle.position.data(),
                                                           own.particle.position_at_build.data()});
    }

    const std::vector<Wrench>& free_boundary_wrenches(const Domain& domain) override
    {
        wrenches.assign(last_boundaries.size(), Wrench{});
        boundary_loads.resize(free_pairs);
        par::for_each(on, free_pairs,
                      detail::ComputeBoundaryLoad{
                          domain.grid, own.particle.position.data(), own.pairs.i.data(), own.pairs.j.data(),
                          own.pairs.load.data(), rotation_laws ? own.pairs.torque.data() : nullptr,
                          boundaries.data(), counts.data(), boundary_loads.data()});
        host_boundary_loads.resize(free_pairs);
        par::copy_to_host(on, host_boundary_loads.data(), boundary_loads.data(),
                          free_pairs * sizeof(detail::BoundaryLoad));
        for (const detail::BoundaryLoad& load : host_boundary_loads)
            wrenches[load.boundary].F += load.F, wrenches[load.boundary].T += load.T;
        return wrenches;
    }

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
               counts.bytes() + offset.bytes() + boundary_loads.bytes();
    }

private:
    static constexpr bool is_cpu = std::is_same_v<Backend, par::Cpu>;

    PairView pair_view() const
    {
        const Pairs<Backend>& p = own.pairs;
        return {p.i.data(),
                p.j.data(),
                one_law ? nullptr : p.law.data(),
                p.history.data(),
                rotation_laws ? p.rotation_history.data() : nullptr,
                p.load.data(),
                rotation_laws ? p.torque.data() : nullptr,
                p.in_contact.data(),
                p.count};
    }

    template <class T>
    void send(par::Array<Backend, T>& to, const std::vector<T>& from)
    {
        to.resize(from.size());
        par::copy_to_device(on, to.data(), from.data(), from.size() * sizeof(T));
    }

    /// Copies all arrays between the host and the device.
    template <class To, class From>
    void copy(Arrays<To>& to, Arrays<From>& from)
    {
        const auto one = [&](auto& a, auto& b) {
            using T = std::remove_reference_t<decltype(*b.data())>;
            a.resize(b.size());
            if constexpr (std::is_same_v<To, par::Cpu>)
                par::copy_to_host(on, a.data(), b.data(), b.size() * sizeof(T));
            else
                par::copy_to_device(on, a.data(), b.data(), b.size() * sizeof(T));
        };
        auto& p = to.particle;
        auto& q = to.pairs;
        auto& pf = from.particle;
        auto& qf = from.pairs;
        one(p.position, pf.position), one(p.velocity, pf.velocity), one(p.omega, pf.omega);
        one(p.compensation, pf.compensation), one(p.species, pf.species), one(p.id, pf.id),
            one(p.acc, pf.acc), one(p.alpha, pf.alpha);
        one(p.orientation, pf.orientation), one(p.orientation_compensation, pf.orientation_compensation);
        one(p.position_at_build, pf.position_at_build);
        one(q.start, qf.start), one(q.i, qf.i), one(q.j, qf.j), one(q.other_start, qf.other_start);
        one(q.other, qf.other), one(q.law, qf.law), one(q.in_contact, qf.in_contact),
            one(q.history, qf.history);
        one(q.rotation_history, qf.rotation_history), one(q.torque, qf.torque), one(q.load, qf.load);
        p.count = pf.count, q.count = qf.count;
    }

    const Backend on = {};
    Arrays<Backend> own;
    Arrays<par::Cpu> host;  ///< copy of a GPU's arrays; up to date if host_is_current
    bool host_is_current = false;
    Neighbours<Backend> neighbours;
    par::Array<Backend, PairLaw> laws;
    par::Array<Backend, std::uint8_t> law_of;
    par::Array<Backend, Boundary> boundaries;
    par::Array<Backend, Float4> force;
    std::vector<Boundary> last_boundaries;
    std::uint32_t materials = 1, free_pairs = 0;
    bool one_law = true, rotation_laws = false, any_free = false;
    par::Array<Backend, std::uint32_t> counts, offset;  ///< counts: indices of the pairs with free boundaries
    par::Array<Backend, detail::BoundaryLoad> boundary_loads;
    std::vector<detail::BoundaryLoad> host_boundary_loads;
    std::vector<Wrench> wrenches;
};

}  // namespace hilda::granular
