// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/backend/lanes.hpp"
#include "granular/core/integrator.hpp"

#include <algorithm>

namespace hilda::granular {

namespace {

using Eight __attribute__((vector_size(32))) = float;

Eight eight(const Load& load)
{
    Eight e;
    std::memcpy(&e, &load, sizeof e);
    return e;
}

/// A pack of particles
struct AdvancePack {
    const Advance& to;
    std::uint32_t particles;

    /// F and, over the radius, T of particle k
    Load sum(std::uint32_t k) const
    {
        Eight as_i{}, as_j{};
        for (std::uint32_t n = to.start[k]; n < to.start[k + 1]; ++n) as_i += eight(to.load[n]);
        for (std::uint32_t m = to.other_start[k]; m < to.other_start[k + 1]; ++m)
            as_j += eight(to.load[to.other[m]]);
        constexpr Eight sign = {-1, -1, -1, -1, 1, 1, 1, 1};
        const Eight all = as_i + sign * as_j;
        Load out;
        std::memcpy(static_cast<void*>(&out), &all, sizeof all);
        return out;
    }
    Four sum_of_torques(std::uint32_t k) const
    {
        Vec<float> T{0, 0, 0};
        for (std::uint32_t n = to.start[k]; n < to.start[k + 1]; ++n)
            T += {to.torque[n].x, to.torque[n].y, to.torque[n].z};
        for (std::uint32_t m = to.other_start[k]; m < to.other_start[k + 1]; ++m) {
            const Four& t = to.torque[to.other[m]];
            T -= {t.x, t.y, t.z};
        }
        return {T.x, T.y, T.z, 0};
    }

    template <class Word, class T>
    static void load4(const T* from, std::uint32_t first, std::uint32_t valid, Word out[4])
    {
        load_rows<Word, T>([&](int k) { return &from[first + std::min<std::uint32_t>(k, valid - 1)]; }, out);
    }
    template <class Word, class T>
    static void store4(T* to, std::uint32_t first, std::uint32_t valid, const Word in[4])
    {
        store_rows(in, [&](int k) { return &to[first + std::min<std::uint32_t>(k, valid - 1)]; });
    }

    void turn_pack(std::uint32_t first, std::uint32_t valid, const Vec<Pack>& angle) const
    {
        Pack p[4], left[4];
        load4(to.orientation, first, valid, p), load4(to.orientation_rest, first, valid, left);
        const EulerParameters<Pack> d = turn_by(angle, {p[0], {p[1], p[2], p[3]}});
        add(p[0], d.e0, left[0]), add(p[1], d.e.x, left[1]);
        add(p[2], d.e.y, left[2]), add(p[3], d.e.z, left[3]);
        store4(to.orientation, first, valid, p), store4(to.orientation_rest, first, valid, left);
    }

    /// The largest |v|²
    float operator()(std::uint32_t first) const
    {
        const std::uint32_t valid = std::min<std::uint32_t>(lanes, particles - first);
        const Pack none(0.f);
        Pack F[4] = {none, none, none, none}, M[4] = {none, none, none, none},
             T[4] = {none, none, none, none};
        if (to.step.part != Part::before_loads) {
            Load sums[lanes];
            for (std::uint32_t k = 0; k < lanes; ++k) sums[k] = sum(first + std::min(k, valid - 1));
            load_rows<Pack, Four>([&](int k) { return &sums[k].F; }, F);
            load_rows<Pack, Four>([&](int k) { return &sums[k].M; }, M);
            if (to.force != nullptr) {
                Pack from_outside[4];
                load_rows<Pack, Four>(
                    [&](int k) { return &to.force[to.id[first + std::min<std::uint32_t>(k, valid - 1)]]; },
                    from_outside);
                for (int k = 0; k < 3; ++k) F[k] += from_outside[k];
            }
            if (to.torque != nullptr) {
                Four torques[lanes];
                for (std::uint32_t k = 0; k < lanes; ++k)
                    torques[k] = sum_of_torques(first + std::min(k, valid - 1));
                load_rows<Pack, Four>([&](int k) { return &torques[k]; }, T);
            }
        }
        Pack v[4], w[4], a[4] = {none, none, none, none}, b[4] = {none, none, none, none};
        Ints rest[4], at[4];
        load4(to.velocity, first, valid, v);
        load4(to.omega, first, valid, w);
        load4(to.rest, first, valid, rest);
        if (to.acc != nullptr) load4(to.acc, first, valid, a), load4(to.turn, first, valid, b);
        Moving<Pack> m{.v = {v[0], v[1], v[2]},
                       .omega = {w[0], w[1], w[2]},
                       .v_rest = {low(rest[1]), high(rest[1]), low(rest[2])},
                       .omega_rest = {high(rest[2]), low(rest[3]), high(rest[3])},
                       .rest = rest_of_way<Pack>(rest[0]),
                       .radius = v[3],
                       .per_mass = w[3]};
        Vec<Pack> acc{a[0], a[1], a[2]}, turn{b[0], b[1], b[2]};
        const Vec<Pack> torque{v[3] * M[0] + T[0], v[3] * M[1] + T[1], v[3] * M[2] + T[2]};
        const Went<Pack> all = go(to.step, m, {F[0], F[1], F[2]}, torque, acc, turn);

        v[0] = m.v.x, v[1] = m.v.y, v[2] = m.v.z, w[0] = m.omega.x, w[1] = m.omega.y, w[2] = m.omega.z;
        store4(to.velocity, first, valid, v);
        store4(to.omega, first, valid, w);
        const std::uint32_t dither = to.step.random;
        const Carried<Pack> went = carried(all.way, to.step.even);
        const auto half = [&](const Pack& left) { return upper_half(left, dither); };
        rest[0] = went.word;
        rest[1] = halves(half(m.v_rest.x), half(m.v_rest.y));
        rest[2] = halves(half(m.v_rest.z), half(m.omega_rest.x));
        rest[3] = halves(half(m.omega_rest.y), half(m.omega_rest.z));
        store4(to.rest, first, valid, rest);
        if (to.acc != nullptr) {
            a[0] = acc.x, a[1] = acc.y, a[2] = acc.z, b[0] = turn.x, b[1] = turn.y, b[2] = turn.z;
            store4(to.acc, first, valid, a), store4(to.turn, first, valid, b);
        }
        if (to.step.part == Part::whole || to.step.part == Part::before_loads) {
            load4(to.position, first, valid, at);
            at[1].v += went.x.v, at[2].v += went.y.v, at[3].v += went.z.v;
            store4(to.position, first, valid, at);
            if (to.orientation != nullptr) turn_pack(first, valid, all.angle);
        }
        return largest(select(w[3] > none, m.v.dot(m.v), none));
    }
};

}  // namespace

float advance(par::Cpu cpu, std::uint32_t particles, const Advance& arrays)
{
    const AdvancePack one{arrays, particles};
    const std::uint32_t packs = (particles + lanes - 1) / lanes;
    return par::largest(
        cpu, packs, [&](std::uint32_t k) { return one(k * lanes); }, 128);
}

}  // namespace hilda::granular
