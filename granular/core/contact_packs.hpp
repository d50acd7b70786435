// SPDX-License-Identifier: GPL-3.0-or-later
/// Contacts of particles in packs: geometry, force laws and histories, for the loops over pairs on the CPU.

#pragma once

#include "granular/backend/pack.hpp"
#include "granular/core/contact_loop.hpp"

#include <algorithm>

namespace hilda::granular::detail {

/// Four words of a row as packs
template <class T>
struct Words4 {
    T x, y, z, w;
};

template <class Word, class T>
Words4<Word> gather_rows(const T* from, const std::uint32_t* which)
{
    Word w[4];
    load_rows<Word, T>([&](int k) { return &from[which[k]]; }, w);
    return {w[0], w[1], w[2], w[3]};
}

/// Separation r_i - r_j of a pack of pairs, and the numbers q, d² and D of set_overlap [units, units²]
struct PackOverlap {
    Vec<Pack> separation;
    Pack q, d2, D;
};

/// Loads of a pack of contacts: F and M of Load, and the torque T of rolling and spin on body i
struct PackLoad {
    Pack F[4], M[4], T[4];
};

/// Contacts of a list of pairs
struct ContactPacks {
    const ParticleView& particles;
    const PairView& pairs;
    const LawView& laws;
    float units_per_metre = 1 / static_cast<float>(particles.grid.unit),
          unit = static_cast<float>(particles.grid.unit);

    /// The function difference() for packs
    template <class IndexOf>
    static Ints axis_difference(Ints cell_i, Ints cell_j, Ints i, Ints j, const CellGrid& g, int axis,
                                const IndexOf& index_of)
    {
        using Unsigned = Ints::Unsigned;
        Unsigned out = Unsigned(i.v) - Unsigned(j.v);
        if (g.periodic[axis] != 0) {
            const Ints::V d = index_of(cell_i.v) - index_of(cell_j.v), n = Ints::V{} + g.cells[axis];
            const Ints::V wraps = (2 * d > n ? -n : 2 * d < -n ? n : Ints::V{});
            out += Unsigned(wraps) * static_cast<std::uint32_t>(g.width[axis]);
        }
        return {Ints::V(out)};
    }

    /// Integers of the overlap of a pack of pairs
    struct Integers {
        Ints x, y, z, D;
        Squares squares;  ///< q > 0: the two particles overlap

        PackOverlap to_floats() const
        {
            return {
                {to_float(x), to_float(y), to_float(z)}, squares.difference(), squares.sum(), to_float(D)};
        }
    };
    /// image: of each pair; only with images
    template <bool with_images>
    Integers integers_of(const std::uint32_t* i, const std::uint32_t* j, const std::uint8_t* image, Pack R_i,
                         Pack R_j) const
    {
        const CellGrid& g = particles.grid;
        const auto a = gather_rows<Ints>(particles.position, i), b = gather_rows<Ints>(particles.position, j);
        using V = Ints::V;
        using Unsigned = Ints::Unsigned;
        const int mask_x = (1 << g.shift_y) - 1, mask_y = (1 << (g.shift_z - g.shift_y)) - 1;
        Integers out;
        out.D = {to_int(R_i * units_per_metre).v + to_int(R_j * units_per_metre).v};
        if constexpr (with_images) {
            set_image_differences(i, j, image, out);
            out.squares = Squares(out.x, out.y, out.z, out.D);
            return out;
        }
        out.x = axis_difference(a.x, b.x, a.y, b.y, g, 0, [&](V c) { return V(c & mask_x); });
        out.y = axis_difference(a.x, b.x, a.z, b.z, g, 1, [&](V c) { return V(c >> g.shift_y & mask_y); });
        out.z = axis_difference(a.x, b.x, a.w, b.w, g, 2, [&](V c) { return V(Unsigned(c) >> g.shift_z); });
        out.squares = Squares(out.x, out.y, out.z, out.D);
        return out;
    }
    /// The differences to images of the particles j. Not inlined, so that the code of other worlds stays fast
    [[gnu::noinline]] void set_image_differences(const std::uint32_t* i, const std::uint32_t* j,
                                                 const std::uint8_t* image, Integers& out) const
    {
        for (int k = 0; k < lanes; ++k) {
            const Difference d =
                difference(particles.grid, particles.position[i[k]], particles.position[j[k]], image[k]);
            out.x.v[k] = d.x, out.y.v[k] = d.y, out.z.v[k] = d.z;
        }
    }
    /// The images of these pairs, if PairView::image is set
    void copy_images(const std::uint32_t* n, std::uint8_t* to) const
    {
        for (int k = 0; pairs.image != nullptr && k < lanes; ++k) to[k] = pairs.image[n[k]];
    }
    /// The same, for pairs that need not be in contact: for these only positions and radii are read.
    template <bool with_images>
    Integers integers_of(const std::uint32_t* i, const std::uint32_t* j, const std::uint8_t* image) const
    {
        Pack R_i = particles.radius, R_j = R_i;
        if (!(particles.radius > 0))
            R_i = gather_rows<Pack>(particles.velocity, i).w,
            R_j = gather_rows<Pack>(particles.velocity, j).w;
        return integers_of<with_images>(i, j, image, R_i, R_j);
    }
    /// The same, with images if PairView::image is set
    Integers integers(const std::uint32_t* i, const std::uint32_t* j, const std::uint8_t* image) const
    {
        return pairs.image != nullptr ? integers_of<true>(i, j, image) : integers_of<false>(i, j, image);
    }

    void clear_history(std::uint32_t n) const
    {
        pairs.in_contact[n] = 0;
        pairs.history[n] = {};
        if (pairs.rotation_history != nullptr) pairs.rotation_history[n] = {};
        if (pairs.internal != nullptr) pairs.internal[n] = {};
    }
    /// The same for a pair with a stored load
    void clear_contact(std::uint32_t n) const
    {
        clear_history(n);
        pairs.load_of(n) = {};
        if (pairs.rotation_history != nullptr) pairs.torque_of(n) = {};
    }

    /// The contact points of a pack of contacts of particles i and j, with one law
    [[gnu::flatten]] ContactPoint<Pack> contact_point(const PairLaw& law, const PackOverlap& overlap,
                                                      const std::uint32_t* i, const std::uint32_t* j,
                                                      Pack& overlaps) const
    {
        const auto v_i = gather_rows<Pack>(particles.velocity, i),
                   v_j = gather_rows<Pack>(particles.velocity, j);
        const auto w_i = gather_rows<Pack>(particles.omega, i), w_j = gather_rows<Pack>(particles.omega, j);
        ContactPoint<Pack> contact;
        contact.h = laws.h;
        contact.R_i = v_i.w, contact.R_j = v_j.w;
        const Pack inverse =
            set_overlap(contact, overlap.q, overlap.d2, overlap.D, overlap.separation, Pack(unit));
        set_masses(contact, w_i.w, w_j.w);
        set_rates(
            contact,
            ContactVelocities<Pack>{
                {v_i.x - v_j.x, v_i.y - v_j.y, v_i.z - v_j.z}, {w_i.x, w_i.y, w_i.z}, {w_j.x, w_j.y, w_j.z}},
            law.lever, laws.lag * units_per_metre * inverse, pairs.rotation_history != nullptr);
        overlaps = larger(overlaps, contact.delta / smaller(contact.R_i, contact.R_j));
        return contact;
    }
    /// The loads of a pack of contacts of particles i and j, with one law; n: numbers of the pairs.
    [[gnu::flatten]] PackLoad evaluate_particles(const PairLaw& law, const PackOverlap& overlap,
                                                 const std::uint32_t* i, const std::uint32_t* j,
                                                 const std::uint32_t* n, Pack& overlaps) const
    {
        return evaluate_pack(law, contact_point(law, overlap, i, j, overlaps), n);
    }

    /// Positions of particles in the global frame [m]
    struct Points {
        alignas(64) double x[lanes], y[lanes], z[lanes];
    };
    Points points(const std::uint32_t* i) const
    {
        const CellGrid& g = particles.grid;
        const auto p = detail::gather_rows<Ints>(particles.position, i);
        alignas(64) std::int32_t cell[lanes], x[lanes], y[lanes], z[lanes];
        std::memcpy(cell, &p.x, sizeof cell), std::memcpy(x, &p.y, sizeof x);
        std::memcpy(y, &p.z, sizeof y), std::memcpy(z, &p.w, sizeof z);
        Points out;
        for (int k = 0; k < lanes; ++k) {
            const Vec3 r = global_position(g, {static_cast<std::uint32_t>(cell[k]), x[k], y[k], z[k]});
            out.x[k] = r.x, out.y[k] = r.y, out.z[k] = r.z;
        }
        return out;
    }

    /// The same vector in all lanes
    static Vec<Pack> splat(const Vec3& a)
    {
        return {Pack(static_cast<float>(a.x)), Pack(static_cast<float>(a.y)), Pack(static_cast<float>(a.z))};
    }
    static void set_lane(Vec<Pack>& to, int k, const Vec3& a)
    {
        to.x.v[k] = static_cast<float>(a.x), to.y.v[k] = static_cast<float>(a.y),
        to.z.v[k] = static_cast<float>(a.z);
    }
    static void set_lane(ContactVelocities<Pack>& to, int k, const ContactVelocities<double>& from)
    {
        set_lane(to.v, k, from.v), set_lane(to.omega_i, k, from.omega_i),
            set_lane(to.omega_j, k, from.omega_j);
    }
    /// The loads of a pack of contacts n with a flat boundary. `contact` has the overlaps and normals;
    /// `of` are the velocities at the closest points.
    void evaluate_on_boundary(const PairLaw& law, const Boundary& b, ContactPoint<Pack>& contact, Pack R,
                              const ContactVelocities<Pack>& of, const Words4<Pack>& w,
                              const std::uint32_t* n, Pack& overlaps) const
    {
        contact.h = laws.h;
        contact.R_i = contact.R_eff = R, contact.R_j = Pack(0.f);
        contact.m_eff = Pack(1.f) / (w.w + Pack(b.inverse_mass()));
        set_rates(contact, of, law.lever);
        overlaps = larger(overlaps, contact.delta / contact.R_i);
        store_loads(evaluate_pack(law, contact, n), n);
    }

    /// Evaluates the force law and advances the histories of the pairs n. Several lanes may hold the same
    /// pair; they then store the same values.
    [[gnu::flatten]] PackLoad evaluate_pack(const PairLaw& law, const ContactPoint<Pack>& contact,
                                            const std::uint32_t* n) const
    {
        return pairs.internal != nullptr ? evaluate_with_internal(law, contact, n)
                                         : evaluate_pack<false>(law, contact, n);
    }
    /// Not inlined, so that the code of worlds without internal variables stays short and fast
    [[gnu::noinline, gnu::flatten]] PackLoad evaluate_with_internal(const PairLaw& law,
                                                                    const ContactPoint<Pack>& contact,
                                                                    const std::uint32_t* n) const
    {
        return evaluate_pack<true>(law, contact, n);
    }
    template <bool with_internal>
    PackLoad evaluate_pack(const PairLaw& law, const ContactPoint<Pack>& contact,
                           const std::uint32_t* n) const
    {
        const auto u = gather_rows<Pack>(pairs.history, n);
        History<Pack> history{};
        history.u = {u.x, u.y, u.z};
        history.slid = u.w < Pack(0.f);  // the sign of the age marks sliding
        history.age = abs(u.w) + laws.h;
        const bool rotation_laws = pairs.rotation_history != nullptr;
        if (rotation_laws) {
            const auto psi = gather_rows<Pack>(pairs.rotation_history, n);
            history.psi = {psi.x, psi.y, psi.z}, history.spin = psi.w;
        }
        if constexpr (with_internal) set_internal(history, gather_rows<Pack>(pairs.internal, n));
        const ContactForce<Pack> out = evaluate<with_internal>(law, contact, history, rotation_laws);
        if constexpr (with_internal) {
            const Pack to_internal[4] = {history.largest_overlap, history.turning, history.amplitude,
                                         history.reference_force};
            store_rows(to_internal, [&](int k) { return &pairs.internal[n[k]]; });
        }
        if (rotation_laws) {
            const Pack to_rotation[4] = {history.psi.x, history.psi.y, history.psi.z, history.spin};
            store_rows(to_rotation, [&](int k) { return &pairs.rotation_history[n[k]]; });
        }
        const Pack to_history[4] = {history.u.x, history.u.y, history.u.z,
                                    select(history.slid, -history.age, history.age)};
        store_rows(to_history, [&](int k) { return &pairs.history[n[k]]; });
        const auto [M, depth] = friction_torque(law, contact, out.F_t);
        const Pack zero(0.f);
        return {{out.F.x, out.F.y, out.F.z, zero}, {M.x, M.y, M.z, depth}, {out.T.x, out.T.y, out.T.z, zero}};
    }

    /// Stores the loads of the pairs n.
    void store_loads(const PackLoad& load, const std::uint32_t* n) const
    {
        std::uint32_t slot[lanes];
        for (int k = 0; k < lanes; ++k) slot[k] = pairs.stored.slot(n[k]);
        store_rows(load.F, [&](int k) { return &pairs.load[slot[k]].F; });
        store_rows(load.M, [&](int k) { return &pairs.load[slot[k]].M; });
        if (pairs.rotation_history != nullptr)
            store_rows(load.T, [&](int k) { return &pairs.torque[slot[k]]; });
    }
};

/// Calls f(law, elements, number of elements) once per law. law_of(e) is the number of the law of an element;
/// the elements of a law keep their order. `sorted` has memory for `count` elements.
template <class LawOf, class F>
void by_law(const LawView& laws, const LawOf& law_of, const std::uint32_t* elements, std::uint32_t count,
            std::uint32_t* sorted, const F& f)
{
    std::uint32_t start[257] = {};
    for (std::uint32_t k = 0; k < count; ++k) ++start[law_of(elements[k]) + 1];
    for (int l = 0; l < 256; ++l) start[l + 1] += start[l];
    std::uint32_t next[256];
    std::copy_n(start, 256, next);
    for (std::uint32_t k = 0; k < count; ++k) sorted[next[law_of(elements[k])]++] = elements[k];
    for (int l = 0; l < laws.laws; ++l)
        if (start[l + 1] > start[l]) f(laws.law[l], sorted + start[l], start[l + 1] - start[l]);
}

}  // namespace hilda::granular::detail
