// SPDX-License-Identifier: GPL-3.0-or-later
// Time integration on the CPU: a pack of particles at a time.
#include "granular/backend/lanes.hpp"
#include "granular/core/integrator.hpp"

#include <algorithm>

namespace hilda::granular {

namespace {

using Float8 __attribute__((vector_size(32))) = float;

Float8 load8(const Load& load)
{
    Float8 e;
    std::memcpy(&e, &load, sizeof e);
    return e;
}

/// Advances a pack of particles.
struct AdvancePack {
    const AdvanceView& arrays;
    std::uint32_t particles;

    /// Sums of F and M over the pairs of particle k; the torque is the radius times the sum of M.
    Load sum(std::uint32_t k) const
    {
        Float8 as_i{}, as_j{};
        for (std::uint32_t n = arrays.start[k]; n < arrays.start[k + 1]; ++n) as_i += load8(arrays.load[n]);
        for (std::uint32_t m = arrays.other_start[k]; m < arrays.other_start[k + 1]; ++m)
            as_j += load8(arrays.load[arrays.other[m]]);
        constexpr Float8 sign = {-1, -1, -1, -1, 1, 1, 1, 1};
        const Float8 total = as_i + sign * as_j;
        Load out;
        std::memcpy(static_cast<void*>(&out), &total, sizeof total);
        return out;
    }
    /// Sum of the torques of rolling and spin on particle k [N m]
    Float4 sum_of_torques(std::uint32_t k) const
    {
        Vec<float> T{0, 0, 0};
        for (std::uint32_t n = arrays.start[k]; n < arrays.start[k + 1]; ++n)
            T += {arrays.torque[n].x, arrays.torque[n].y, arrays.torque[n].z};
        for (std::uint32_t m = arrays.other_start[k]; m < arrays.other_start[k + 1]; ++m) {
            const Float4& t = arrays.torque[arrays.other[m]];
            T -= {t.x, t.y, t.z};
        }
        return {T.x, T.y, T.z, 0};
    }

    // Lanes beyond `valid` repeat the last valid particle and store the same values.
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

    void rotate_pack(std::uint32_t first, std::uint32_t valid, const Vec<Pack>& angle) const
    {
        Pack p[4], error[4];
        load4(arrays.orientation, first, valid, p),
            load4(arrays.orientation_compensation, first, valid, error);
        const EulerParameters<Pack> d = rotation_increment(angle, {p[0], {p[1], p[2], p[3]}});
        add(p[0], d.e0, error[0]), add(p[1], d.e.x, error[1]);
        add(p[2], d.e.y, error[2]), add(p[3], d.e.z, error[3]);
        store4(arrays.orientation, first, valid, p),
            store4(arrays.orientation_compensation, first, valid, error);
    }

    /// Advances the particles from `first` on; returns their largest |v|².
    float operator()(std::uint32_t first) const
    {
        const std::uint32_t valid = std::min<std::uint32_t>(lanes, particles - first);
        const Pack zero(0.f);
        Pack F[4] = {zero, zero, zero, zero}, M[4] = {zero, zero, zero, zero},
             T[4] = {zero, zero, zero, zero};
        if (arrays.step.part != Part::before_loads) {
            Load sums[lanes];
            for (std::uint32_t k = 0; k < lanes; ++k) sums[k] = sum(first + std::min(k, valid - 1));
            load_rows<Pack, Float4>([&](int k) { return &sums[k].F; }, F);
            load_rows<Pack, Float4>([&](int k) { return &sums[k].M; }, M);
            if (arrays.force != nullptr) {
                Pack external[4];
                load_rows<Pack, Float4>(
                    [&](int k) {
                        return &arrays.force[arrays.id[first + std::min<std::uint32_t>(k, valid - 1)]];
                    },
                    external);
                for (int k = 0; k < 3; ++k) F[k] += external[k];
            }
            if (arrays.torque != nullptr) {
                Float4 torques[lanes];
                for (std::uint32_t k = 0; k < lanes; ++k)
                    torques[k] = sum_of_torques(first + std::min(k, valid - 1));
                load_rows<Pack, Float4>([&](int k) { return &torques[k]; }, T);
            }
        }
        Pack v[4], w[4], a[4] = {zero, zero, zero, zero}, b[4] = {zero, zero, zero, zero};
        Ints compensation[4], at[4];
        load4(arrays.velocity, first, valid, v);
        load4(arrays.omega, first, valid, w);
        load4(arrays.compensation, first, valid, compensation);
        if (arrays.acc != nullptr) load4(arrays.acc, first, valid, a), load4(arrays.alpha, first, valid, b);
        ParticleState<Pack> m{
            .v = {v[0], v[1], v[2]},
            .omega = {w[0], w[1], w[2]},
            .v_compensation = {low(compensation[1]), high(compensation[1]), low(compensation[2])},
            .omega_compensation = {high(compensation[2]), low(compensation[3]), high(compensation[3])},
            .remainder = unpack_remainder<Pack>(compensation[0]),
            .radius = v[3],
            .inverse_mass = w[3]};
        Vec<Pack> acc{a[0], a[1], a[2]}, alpha{b[0], b[1], b[2]};
        const Vec<Pack> torque{v[3] * M[0] + T[0], v[3] * M[1] + T[1], v[3] * M[2] + T[2]};
        const Displacement<Pack> moved =
            advance_particle(arrays.step, m, {F[0], F[1], F[2]}, torque, acc, alpha);

        v[0] = m.v.x, v[1] = m.v.y, v[2] = m.v.z, w[0] = m.omega.x, w[1] = m.omega.y, w[2] = m.omega.z;
        store4(arrays.velocity, first, valid, v);
        store4(arrays.omega, first, valid, w);
        const std::uint32_t dither = arrays.step.velocity_dither;
        const SplitDisplacement<Pack> units =
            split_displacement(moved.translation, arrays.step.displacement_dither);
        const auto half = [&](const Pack& error) { return round_to_bfloat16(error, dither); };
        compensation[0] = units.remainder;
        compensation[1] = halves(half(m.v_compensation.x), half(m.v_compensation.y));
        compensation[2] = halves(half(m.v_compensation.z), half(m.omega_compensation.x));
        compensation[3] = halves(half(m.omega_compensation.y), half(m.omega_compensation.z));
        store4(arrays.compensation, first, valid, compensation);
        if (arrays.acc != nullptr) {
            a[0] = acc.x, a[1] = acc.y, a[2] = acc.z, b[0] = alpha.x, b[1] = alpha.y, b[2] = alpha.z;
            store4(arrays.acc, first, valid, a), store4(arrays.alpha, first, valid, b);
        }
        if (arrays.step.part == Part::whole || arrays.step.part == Part::before_loads) {
            load4(arrays.position, first, valid, at);
            at[1] = at[1] + units.x, at[2] = at[2] + units.y, at[3] = at[3] + units.z;
            store4(arrays.position, first, valid, at);
            if (arrays.orientation != nullptr) rotate_pack(first, valid, moved.rotation);
        }
        return largest(select(w[3] > zero, m.v.dot(m.v), zero));
    }
};

}  // namespace

float advance(par::Cpu cpu, std::uint32_t particles, const AdvanceView& arrays)
{
    const AdvancePack advance_pack{arrays, particles};
    const std::uint32_t packs = (particles + lanes - 1) / lanes;
    return par::largest(
        cpu, packs, [&](std::uint32_t k) { return advance_pack(k * lanes); }, 128);
}

}  // namespace hilda::granular
