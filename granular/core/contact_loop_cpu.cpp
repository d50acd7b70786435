// SPDX-License-Identifier: GPL-3.0-or-later
// The loop over pairs on the CPU. The pairs in contact are selected first; the force laws are then evaluated
// for packs of them.
#include "granular/core/contact_packs.hpp"
#include "granular/core/sweep.hpp"

namespace hilda::granular {

namespace {

constexpr std::uint32_t chunk = 2048;  // pairs per task, independent of the number of threads

/// Processes one chunk of the pairs, or of a list of pairs, per call.
struct ContactLoop : detail::ContactPacks {
    std::uint32_t pairs_of_chunk = chunk;
    const std::uint32_t* list = nullptr;  ///< numbers of the pairs; nullptr: all
    std::uint32_t count = pairs.count;    ///< number of pairs of the list

    /// The pairs of a chunk that are to be evaluated
    struct Selected {
        std::uint32_t touching[chunk + lanes], boundary[chunk];
        std::uint32_t touching_count = 0, boundary_count = 0;
    };

    void operator()(std::uint32_t number) const
    {
        const std::uint32_t begin = number * pairs_of_chunk, end = std::min(begin + pairs_of_chunk, count);
        Selected selected;
        if (list == nullptr)
            select_from_all(begin, end, selected);
        else
            select_from_list(begin, end, selected);
        Pack overlaps(0.f);  // over the smaller radius; the largest ones
        each_law(selected.touching, selected.touching_count,
                 [&](const PairLaw& law, const std::uint32_t* of_law, std::uint32_t of_law_count) {
                     for (std::uint32_t first = 0; first < of_law_count; first += lanes) {
                         std::uint32_t n[lanes], i[lanes], j[lanes];
                         for (std::uint32_t k = 0; k < lanes; ++k) {
                             n[k] = of_law[std::min(first + k, of_law_count - 1)];
                             i[k] = pairs.i[n[k]], j[k] = pairs.j[n[k]];
                         }
                         std::uint8_t image[lanes];
                         copy_images(n, image);
                         store_loads(
                             evaluate_particles(law, integers(i, j, image).to_floats(), i, j, n, overlaps),
                             n);
                     }
                 });
        each_law(selected.boundary, selected.boundary_count,
                 [&](const PairLaw& law, const std::uint32_t* of_law, std::uint32_t of_law_count) {
                     evaluate_boundaries(law, of_law, of_law_count, overlaps);
                 });
        if (pairs.largest_overlap != nullptr)
            pairs.largest_overlap[number] = larger(pairs.largest_overlap[number], largest(overlaps));
    }

    void select_from_all(std::uint32_t begin, std::uint32_t end, Selected& out) const
    {
        for (std::uint32_t first = begin; first < end; first += lanes) {
            const std::uint32_t *i = pairs.i + first, *j = pairs.j + first;
            std::uint8_t* contact_flags = pairs.in_contact + first;
            unsigned valid_lanes = (1u << lanes) - 1;
            std::uint32_t copy_i[lanes], copy_j[lanes];
            std::uint8_t copied_flags[lanes] = {};
            const std::uint8_t* image = pairs.image != nullptr ? pairs.image + first : nullptr;
            std::uint8_t copied_images[lanes];
            const bool partial = end - first < lanes;
            const unsigned boundary = partial ? 1 : highest_bits(j);
            if (boundary != 0) {  // a partial pack, or one with boundaries as partners
                const std::uint32_t valid = std::min<std::uint32_t>(lanes, end - first);
                valid_lanes = (1u << valid) - 1;
                for (std::uint32_t k = 0; k < lanes; ++k) {
                    const std::uint32_t at = std::min(k, valid - 1);
                    copy_i[k] = copy_j[k] = i[at];
                    if ((j[at] & PairView::boundary_bit) == 0)
                        copy_j[k] = j[at];
                    else if (k < valid)
                        out.boundary[out.boundary_count++] = first + k, valid_lanes &= ~(1u << k);
                }
                std::copy_n(contact_flags, valid, copied_flags);
                i = copy_i, j = copy_j;
                if (image != nullptr) {
                    for (std::uint32_t k = 0; k < lanes; ++k)
                        copied_images[k] = image[std::min(k, valid - 1)];
                    image = copied_images;
                }
            }
            const unsigned before = boundary != 0 ? flags(copied_flags) : flags(contact_flags);
            const unsigned overlapping = integers(i, j, image).squares.positive() & valid_lanes,
                           ended = before & valid_lanes & ~overlapping;
            out.touching_count += append(out.touching + out.touching_count, first, overlapping);
            if (boundary == 0) {
                set_flags(contact_flags, overlapping);
            } else {
                for (unsigned remaining = overlapping; remaining != 0; remaining &= remaining - 1)
                    contact_flags[__builtin_ctz(remaining)] = 1;
            }
            for (unsigned remaining = ended; remaining != 0; remaining &= remaining - 1)
                clear_contact(first + static_cast<std::uint32_t>(__builtin_ctz(remaining)));
        }
    }

    void select_from_list(std::uint32_t begin, std::uint32_t end, Selected& out) const
    {
        std::uint32_t n[lanes], i[lanes], j[lanes], found = 0;
        const auto test = [&] {
            if (found == 0) return;
            for (std::uint32_t k = found; k < lanes; ++k) n[k] = n[0], i[k] = i[0], j[k] = j[0];
            std::uint8_t image[lanes];
            copy_images(n, image);
            const unsigned overlapping = integers(i, j, image).squares.positive();
            for (std::uint32_t k = 0; k < found; ++k) {
                if ((overlapping >> k & 1) != 0)
                    pairs.in_contact[n[k]] = 1, out.touching[out.touching_count++] = n[k];
                else if (pairs.in_contact[n[k]] != 0)
                    clear_contact(n[k]);
            }
            found = 0;
        };
        for (std::uint32_t m = begin; m < end; ++m) {
            n[found] = list[m], i[found] = pairs.i[list[m]], j[found] = pairs.j[list[m]];
            if ((j[found] & PairView::boundary_bit) != 0)
                out.boundary[out.boundary_count++] = list[m];
            else if (++found == lanes)
                test();
        }
        test();
    }

    /// by_law() for a list of pairs
    template <class F>
    void each_law(const std::uint32_t* which, std::uint32_t number, const F& f) const
    {
        if (number == 0) return;
        if (pairs.law == nullptr) return f(laws.law[0], which, number);
        std::uint32_t sorted[chunk];
        detail::by_law(
            laws, [&](std::uint32_t n) { return pairs.law[n]; }, which, number, sorted, f);
    }

    /// Contacts with surfaces, in runs of pairs with the same plane, or with boundaries of other shapes
    void evaluate_boundaries(const PairLaw& law, const std::uint32_t* which, std::uint32_t number,
                             Pack& overlaps) const
    {
        for (std::uint32_t first = 0, last = 0; first < number; first = last) {
            const std::uint32_t j = pairs.j[which[first]], k = j & ~PairView::boundary_bit;
            const auto is_plane = [&](std::uint32_t surface) {
                return !Surfaces::is_triangle(surface) &&
                       laws.surfaces.boundary[surface].shape == Boundary::Shape::plane;
            };
            if (is_plane(k)) {
                while (last < number && pairs.j[which[last]] == j) ++last;
                evaluate_plane(law, laws.surfaces.boundary[k], which + first, last - first, overlaps);
                continue;
            }
            while (last < number && !is_plane(pairs.j[which[last]] & ~PairView::boundary_bit)) ++last;
            evaluate_surfaces(law, which + first, last - first, overlaps);
        }
    }

    /// Contacts with a plane: geometry in double precision, as in find_boundary_contact(), and force law per
    /// pack
    void evaluate_plane(const PairLaw& law, const Boundary& b, const std::uint32_t* which,
                        std::uint32_t number, Pack& overlaps) const
    {
        std::uint32_t touching[2 * lanes], touching_count = 0;
        const auto flush = [&] {
            for (std::uint32_t k = touching_count; k < lanes; ++k) touching[k] = touching[0];
            evaluate_touching_plane(law, b, touching, overlaps);
            touching_count -= std::min<std::uint32_t>(touching_count, lanes);
            std::copy_n(touching + lanes, touching_count, touching);
        };
        for (std::uint32_t first = 0; first < number; first += lanes) {
            const std::uint32_t valid = std::min<std::uint32_t>(lanes, number - first);
            std::uint32_t n[lanes], i[lanes];
            for (std::uint32_t k = 0; k < lanes; ++k)
                n[k] = which[first + std::min(k, valid - 1)], i[k] = pairs.i[n[k]];
            const Points r = points(i);
            const Pack R = detail::gather_rows<Pack>(particles.velocity, i).w;
            alignas(64) double overlap[lanes];
            for (int k = 0; k < lanes; ++k)
                overlap[k] = R.v[k] - (Vec3{r.x[k], r.y[k], r.z[k]} - b.r).dot(b.axis);
            for (std::uint32_t k = 0; k < valid; ++k) {
                if (overlap[k] > 0)
                    pairs.in_contact[n[k]] = 1, touching[touching_count++] = n[k];
                else if (pairs.in_contact[n[k]] != 0)
                    clear_contact(n[k]);
            }
            if (touching_count >= lanes) flush();
        }
        if (touching_count > 0) flush();
    }

    void evaluate_touching_plane(const PairLaw& law, const Boundary& b, const std::uint32_t* n,
                                 Pack& overlaps) const
    {
        std::uint32_t i[lanes];
        for (int k = 0; k < lanes; ++k) i[k] = pairs.i[n[k]];
        const Points r = points(i);
        const auto v = detail::gather_rows<Pack>(particles.velocity, i),
                   w = detail::gather_rows<Pack>(particles.omega, i);
        ContactVelocities<Pack> velocities{{}, {w.x, w.y, w.z}, splat(b.omega)};
        ContactPoint<Pack> contact;
        for (int k = 0; k < lanes; ++k) {
            const Vec3 at{r.x[k], r.y[k], r.z[k]}, of{v.x.v[k], v.y.v[k], v.z.v[k]};
            const Nearest near = nearest(b, at);
            contact.delta.v[k] = static_cast<float>(v.w.v[k] - near.distance);
            if (laws.lag != 0 && turns(b))
                set_lane(velocities, k,
                         boundary_velocities(laws.surfaces, pairs.j[n[k]] & ~PairView::boundary_bit, at, near,
                                             of, {w.x.v[k], w.y.v[k], w.z.v[k]}, v.w.v[k], laws.lag));
            else
                set_lane(velocities.v, k, of - velocity(b, at - near.distance * near.n));
        }
        contact.n = splat(b.axis);
        evaluate_on_boundary(law, b, contact, v.w, velocities, w, n, overlaps);
    }

    /// Contacts with surfaces of any shape: the geometry is computed per pair in double precision, the force
    /// law per pack.
    [[gnu::flatten]] void evaluate_surfaces(const PairLaw& law, const std::uint32_t* which,
                                            std::uint32_t number, Pack& overlaps) const
    {
        // a pack of contacts in the memory layout of ContactPoint<Pack>
        constexpr int values = sizeof(ContactPoint<float>) / sizeof(float);
        static_assert(sizeof(ContactPoint<Pack>) >= (values - 1) * sizeof(Pack));
        struct alignas(64) Lanes {
            float value[values - 1][lanes];  // all members but the step size
        } in = {};
        std::uint32_t touching[lanes];
        std::uint32_t touching_count = 0;
        const auto flush = [&] {
            if (touching_count == 0) return;
            for (std::uint32_t k = touching_count; k < lanes; ++k) {
                touching[k] = touching[0];
                for (auto& row : in.value) row[k] = row[0];
            }
            ContactPoint<Pack> contact;
            std::memcpy(static_cast<void*>(&contact), &in, sizeof in);
            contact.h = laws.h;
            overlaps = larger(overlaps, contact.delta / contact.R_i);
            store_loads(evaluate_pack(law, contact, touching), touching);
            touching_count = 0;
        };
        for (std::uint32_t m = 0; m < number; ++m) {
            const std::uint32_t at = which[m], i = pairs.i[at];
            ContactPoint<float> one{};
            if (!find_boundary_contact(one, particles.grid, particles.position[i], particles.velocity[i],
                                       particles.omega[i], laws.surfaces,
                                       pairs.j[at] & ~PairView::boundary_bit, laws.lag, law.lever)) {
                if (pairs.in_contact[at] != 0) clear_contact(at);
                continue;
            }
            float value[values];
            std::memcpy(value, &one, sizeof value);
            for (int k = 0; k < values - 1; ++k) in.value[k][touching_count] = value[k];
            pairs.in_contact[at] = 1;
            touching[touching_count++] = at;
            if (touching_count == lanes) flush();
        }
        flush();
    }
};

}  // namespace

void find_loads(par::Cpu cpu, const ParticleView& particles, const PairView& pairs, const LawView& laws)
{
    par::for_each(cpu, (pairs.count + chunk - 1) / chunk, ContactLoop{{particles, pairs, laws}}, 1);
}

void find_listed_loads(par::Cpu cpu, const ParticleView& particles, const PairView& pairs,
                       const LawView& laws, const std::uint32_t* list, std::uint32_t count)
{
    par::for_each(cpu, (count + list_chunk - 1) / list_chunk,
                  ContactLoop{{particles, pairs, laws}, list_chunk, list, count}, 1);
}

}  // namespace hilda::granular
