// SPDX-License-Identifier: GPL-3.0-or-later
// The engine of any back end.
#pragma once

#include "granular/backend/engine.hpp"

#include <chrono>
#include <cstring>
#include <type_traits>

namespace hilda::granular {

namespace detail {

/// 1 for a pair with a boundary that is not held
struct IsOnFree {
    const std::uint32_t* j;
    const Boundary* boundary;
    std::uint32_t* yes;
    HILDA_HD void operator()(std::uint32_t n) const
    {
        yes[n] = (j[n] & PairView::boundary) != 0 && boundary[j[n] & ~PairView::boundary].mass > 0 ? 1 : 0;
    }
};

struct Collect {
    const std::uint32_t* before;  ///< how many come before each
    std::uint32_t* which;
    HILDA_HD void operator()(std::uint32_t n) const
    {
        if (before[n + 1] > before[n]) which[before[n]] = n;
    }
};

struct OnBoundary {
    Vec3 F, T;
    std::uint32_t boundary;
};

/// What a pair does to its boundary
struct FindOnBoundary {
    CellGrid grid;
    const Position* position;
    const std::uint32_t *i, *j;
    const Load* load;
    const Four* torque;
    const Boundary* boundary;
    const std::uint32_t* which;
    OnBoundary* out;
    HILDA_HD void operator()(std::uint32_t k) const
    {
        const std::uint32_t n = which[k], b = j[n] & ~PairView::boundary;
        const Four f = load[n].F;
        const Vec3 F{-f.x, -f.y, -f.z}, r = place(grid, position[i[n]]);
        const Nearest near = nearest(boundary[b], r);
        Vec3 T = (r - near.distance * near.n - boundary[b].r).cross(F);
        if (torque != nullptr) T -= {torque[n].x, torque[n].y, torque[n].z};
        out[k] = {F, T, b};
    }
};

struct WayOf {
    const Position *now, *before;
    HILDA_HD float operator()(std::uint32_t k) const
    {
        // owner cells are those of before: the difference is that of the places in them
        const auto x = static_cast<float>(now[k].x - before[k].x),
                   y = static_cast<float>(now[k].y - before[k].y),
                   z = static_cast<float>(now[k].z - before[k].z);
        return sqrt(x * x + y * y + z * z);
    }
};

}  // namespace detail

template <class Backend>
class EngineOn : public Engine {
public:
    Arrays<par::Cpu>& arrays() override
    {
        if constexpr (is_cpu) {
            return own;
        } else {
            if (!current) copy(host, own);
            current = true;
            return host;
        }
    }
    void written() override
    {
        if constexpr (!is_cpu) copy(own, host);
    }

    void set_laws(const std::vector<PairLaw>& all, const std::vector<std::uint8_t>& between,
                  std::uint32_t count) override
    {
        materials = count;
        one_law = all.size() <= 1;
        turning = false;
        for (const PairLaw& l : all) turning = turning || l.turns();
        send(laws, all), send(law_of, between);
    }

    void set_boundaries(const std::vector<Boundary>& all) override
    {
        if (all.size() == known.size() &&
            (all.empty() || std::memcmp(static_cast<const void*>(all.data()), known.data(),
                                        all.size() * sizeof(Boundary)) == 0))
            return;
        known = all;
        any_free = false;
        for (const Boundary& b : all) any_free = any_free || b.mass > 0;
        send(boundaries, all);
    }

    void set_forces(const std::vector<Four>& all) override { send(force, all); }

    void find_neighbours(const Scene& scene) override
    {
        current = false;
        neighbours.find({.scene = scene,
                         .law_of = one_law ? nullptr : law_of.data(),
                         .materials = materials,
                         .boundary = boundaries.data(),
                         .boundaries = static_cast<std::uint32_t>(boundaries.size()),
                         .turning = turning},
                        own.particle, own.pairs);
        free_pairs = 0;
        if (!any_free) return;
        const std::uint32_t n = own.pairs.count;
        counts.resize(n), before.resize(n + 1);
        par::for_each(on, n, detail::IsOnFree{own.pairs.j.data(), boundaries.data(), counts.data()});
        free_pairs = static_cast<std::uint32_t>(par::exclusive_scan(on, counts.data(), before.data(), n));
        par::for_each(on, n, detail::Collect{before.data(), counts.data()});
    }

    void find_loads(const Scene& scene, float h) override
    {
        current = false;
        granular::find_loads(on, particle_view(scene, own.particle), pair_view(),
                             {laws.data(), static_cast<int>(laws.size()), boundaries.data(), h});
    }

    float advance(const StepOf& step) override
    {
        current = false;
        Particles<Backend>& p = own.particle;
        return granular::advance(on, p.count,
                                 {.position = p.position.data(),
                                  .velocity = p.velocity.data(),
                                  .omega = p.omega.data(),
                                  .rest = p.rest.data(),
                                  .acc = p.acc.data(),
                                  .turn = p.turn.data(),
                                  .orientation = p.orientation.data(),
                                  .orientation_rest = p.orientation_rest.data(),
                                  .start = own.pairs.start.data(),
                                  .other_start = own.pairs.other_start.data(),
                                  .other = own.pairs.other.data(),
                                  .load = own.pairs.load.data(),
                                  .touches = own.pairs.touches.data(),
                                  .torque = turning ? own.pairs.torque.data() : nullptr,
                                  .force = force.size() > 0 ? force.data() : nullptr,
                                  .id = p.id.data(),
                                  .step = step});
    }

    float longest_way() override
    {
        return par::largest(on, own.particle.count,
                            detail::WayOf{own.particle.position.data(), own.particle.before.data()});
    }

    const std::vector<Wrench>& on_free_boundaries(const Scene& scene) override
    {
        sums.assign(known.size(), Wrench{});
        on_boundary.resize(free_pairs);
        par::for_each(on, free_pairs,
                      detail::FindOnBoundary{scene.grid, own.particle.position.data(), own.pairs.i.data(),
                                             own.pairs.j.data(), own.pairs.load.data(),
                                             turning ? own.pairs.torque.data() : nullptr, boundaries.data(),
                                             counts.data(), on_boundary.data()});
        of_pairs.resize(free_pairs);
        par::copy_to_host(on, of_pairs.data(), on_boundary.data(), free_pairs * sizeof(detail::OnBoundary));
        for (const detail::OnBoundary& one : of_pairs)
            sums[one.boundary].F += one.F, sums[one.boundary].T += one.T;
        return sums;
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
               counts.bytes() + before.bytes() + on_boundary.bytes();
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
                turning ? p.turning.data() : nullptr,
                p.load.data(),
                turning ? p.torque.data() : nullptr,
                p.touches.data(),
                p.count};
    }

    template <class T>
    void send(par::Array<Backend, T>& to, const std::vector<T>& from)
    {
        to.resize(from.size());
        par::copy_to_device(on, to.data(), from.data(), from.size() * sizeof(T));
    }

    /// Between the arrays of the host and those of the device
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
        one(p.rest, pf.rest), one(p.kind, pf.kind), one(p.id, pf.id), one(p.acc, pf.acc),
            one(p.turn, pf.turn);
        one(p.orientation, pf.orientation), one(p.orientation_rest, pf.orientation_rest);
        one(p.before, pf.before);
        one(q.start, qf.start), one(q.i, qf.i), one(q.j, qf.j), one(q.other_start, qf.other_start);
        one(q.other, qf.other), one(q.law, qf.law), one(q.touches, qf.touches), one(q.history, qf.history);
        one(q.turning, qf.turning), one(q.torque, qf.torque), one(q.load, qf.load);
        p.count = pf.count, q.count = qf.count;
    }

    const Backend on = {};
    Arrays<Backend> own;
    Arrays<par::Cpu> host;  ///< of a GPU, as of the time when it was last asked for
    bool current = false;
    Neighbours<Backend> neighbours;
    par::Array<Backend, PairLaw> laws;
    par::Array<Backend, std::uint8_t> law_of;
    par::Array<Backend, Boundary> boundaries;
    par::Array<Backend, Four> force;
    std::vector<Boundary> known;
    std::uint32_t materials = 1, free_pairs = 0;
    bool one_law = true, turning = false, any_free = false;
    par::Array<Backend, std::uint32_t> counts, before;  ///< then: which pairs are on boundaries that are free
    par::Array<Backend, detail::OnBoundary> on_boundary;
    std::vector<detail::OnBoundary> of_pairs;
    std::vector<Wrench> sums;
};

}  // namespace hilda::granular
