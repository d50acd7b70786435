// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/core/surfaces/triangle_contacts.hpp"

#include "granular/core/contact_packs.hpp"
#include "granular/core/surfaces/hand_over.hpp"
#include "granular/core/sweep.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace hilda::granular {

namespace {

/// The largest float that is not above x
float rounded_down(double x)
{
    const auto near = static_cast<float>(x);
    return near > x ? std::nextafter(near, -std::numeric_limits<float>::infinity()) : near;
}

/// The contacts of a chunk in a step
struct Contacts {
    std::vector<double> distance, n_x, n_y, n_z, x, y, z;  ///< normal and centre in the global frame [m]
    std::vector<std::uint32_t> pair, particle, boundary;
    std::vector<std::uint32_t> ended;   ///< pairs without overlap that were in contact
    std::vector<std::uint32_t> sorted;  ///< contacts by law and boundary
    std::uint32_t count = 0;

    void reset(std::size_t most)
    {
        count = 0;
        ended.clear();
        if (pair.size() >= most) return;
        for (auto* values : {&distance, &n_x, &n_y, &n_z, &x, &y, &z}) values->resize(most);
        for (auto* values : {&pair, &particle, &boundary}) values->resize(most);
    }
};

/// Processes one chunk per call.
struct TriangleLoop : detail::ContactPacks {
    TriangleContacts& all;
    const std::uint32_t* start;
    double path;
    float path_so_far = -rounded_down(-path);

    void operator()(std::uint32_t number) const
    {
        static thread_local Contacts contacts;  // in the cache of the core
        contacts.reset(all.longest + lanes);
        find_contacts(number, contacts);
        end_contacts(contacts);
        Pack overlaps(0.f);
        each_pack(contacts, [&](const PairLaw& law, const Boundary& b, const auto& at) {
            evaluate(law, b, contacts, at, overlaps);
        });
        if (pairs.largest_overlap != nullptr)
            pairs.largest_overlap[number] = larger(pairs.largest_overlap[number], largest(overlaps));
    }

    /// Lists the contacts of a chunk and those that have ended.
    void find_contacts(std::uint32_t number, Contacts& to) const
    {
        const std::uint32_t begin = all.first[number], end = all.end[number],
                            end_of_faces = begin + all.faces[number];
        const auto lanes_before = [](std::uint32_t first, std::uint32_t last) {
            return last - first < lanes ? (1u << (last - first)) - 1 : (1u << lanes) - 1;
        };
        bool changed = false;
        for (std::uint32_t first = begin; first < end; first += lanes) {
            Pack awake_at;
            std::memcpy(&awake_at, all.awake_at.data() + first, sizeof awake_at);
            const unsigned keep = bits(awake_at > Pack(path_so_far));
            if (first < end_of_faces) {
                const unsigned face = keep & lanes_before(first, end_of_faces);
                if (face != 0) find_face_contacts(first, face, to);
            }
            for (unsigned woken = lanes_before(first, end) & ~keep; woken != 0; woken &= woken - 1)
                changed |= examine(first + static_cast<std::uint32_t>(__builtin_ctz(woken)), to);
        }
        if (changed) put_faces_first(number);
    }

    /// Finds the closest feature, and the state until the particle has moved by most of its margin. Returns
    /// whether the candidate is in a face now and was not before, or the reverse.
    [[gnu::noinline]] bool examine(std::uint32_t c, Contacts& to) const
    {
        const MeshView& mesh = laws.surfaces.mesh;
        const Boundary& b = laws.surfaces.boundary[all.boundary[c]];
        const std::uint32_t t = all.surface[c] - Surfaces::first_triangle, i = all.particle[c];
        const Vec3 r = global_position(particles.grid, particles.position[i]), p = rotated_back(b.p, r - b.r);
        const double R = particles.velocity[i].w;
        const Nearest near = nearest(mesh, t, p, R);
        const bool overlaps = R - near.distance > 0, was_in_face = all.in_face[c] != 0;
        if (overlaps) {
            const Vec3 n = rotated(b.p, near.n);
            const std::uint32_t m = to.count++;
            to.distance[m] = near.distance;
            to.n_x[m] = n.x, to.n_y[m] = n.y, to.n_z[m] = n.z;
            to.x[m] = r.x, to.y[m] = r.y, to.z[m] = r.z;
            to.pair[m] = all.pair[c], to.particle[m] = i, to.boundary[m] = all.boundary[c];
        } else if (pairs.in_contact[all.pair[c]] != 0) {
            to.ended.push_back(all.pair[c]);
        }

        double margin = distance_in_face(mesh, t, p);
        const bool in_face = margin > 0;
        if (in_face) {
            const MeshPlane& face = mesh.triangle[t].face;
            const double side = face.height(p) < 0 ? -1 : 1;
            all.n_x[c] = side * face.n.x, all.n_y[c] = side * face.n.y, all.n_z[c] = side * face.n.z;
            all.offset[c] = side * face.offset;
        } else if (!overlaps) {
            const double gap = (p - closest_point(mesh, t, p)).norm() - R;
            margin = std::max(gap, distance_to_ownership(mesh, t, p));
        }
        all.in_face[c] = in_face ? 1 : 0;
        const double rounding = 16 * particles.grid.unit;
        all.awake_at[c] =
            margin > rounding ? rounded_down(path + 0.9 * margin) : -std::numeric_limits<float>::infinity();
        return in_face != was_in_face;
    }

    /// The candidates `which` of a pack, in faces
    [[gnu::noinline]] void find_face_contacts(std::uint32_t first, unsigned which, Contacts& to) const
    {
        while (which != 0) {
            const std::uint32_t boundary = all.boundary[first + static_cast<unsigned>(__builtin_ctz(which))];
            Ints boundaries;
            std::memcpy(&boundaries, all.boundary.data() + first, sizeof boundaries);
            const unsigned same =
                bits(PackMask{boundaries.v == Ints::V{} + static_cast<std::int32_t>(boundary)});
            find_face_contacts(first, which & same, laws.surfaces.boundary[boundary], to);
            which &= ~same;
        }
    }
    void find_face_contacts(std::uint32_t first, unsigned which, const Boundary& b, Contacts& to) const
    {
        const std::uint32_t* const i = all.particle.data() + first;
        const Points r = points(i);
        const Pack R = detail::gather_rows<Pack>(particles.velocity, i).w;
        const double *const n_x = all.n_x.data() + first, *const n_y = all.n_y.data() + first,
                            *const n_z = all.n_z.data() + first, *const offset = all.offset.data() + first;
        alignas(64) double height[lanes], x[lanes], y[lanes], z[lanes];
        Pack overlap;
        for (unsigned k = 0; k < lanes; ++k) {
            const Vec3 p = rotated_back(b.p, Vec3{r.x[k], r.y[k], r.z[k]} - b.r), n{n_x[k], n_y[k], n_z[k]};
            height[k] = MeshPlane{n, offset[k]}.height(p);
            overlap.v[k] = static_cast<float>(R.v[k] - height[k]);
            const Vec3 global = rotated(b.p, n);
            x[k] = global.x, y[k] = global.y, z[k] = global.z;
        }
        const unsigned overlapping = bits(overlap > Pack(0.f));
        const unsigned contacts = overlapping & which;
        const auto add = [&](std::vector<double>& values, const double* from) {
            compress(values.data() + to.count, from, contacts);
        };
        add(to.distance, height), add(to.n_x, x), add(to.n_y, y), add(to.n_z, z);
        add(to.x, r.x), add(to.y, r.y), add(to.z, r.z);
        const auto add_words = [&](std::vector<std::uint32_t>& values, const std::uint32_t* from) {
            Ints words;
            std::memcpy(&words, from, sizeof words);
            compress(values.data() + to.count, words, contacts);
        };
        add_words(to.pair, all.pair.data() + first), add_words(to.particle, i);
        add_words(to.boundary, all.boundary.data() + first);
        to.count += static_cast<std::uint32_t>(__builtin_popcount(contacts));
        for (unsigned apart = which & ~overlapping; apart != 0; apart &= apart - 1) {
            const std::uint32_t pair = all.pair[first + static_cast<unsigned>(__builtin_ctz(apart))];
            if (pairs.in_contact[pair] != 0) to.ended.push_back(pair);
        }
    }

    void put_faces_first(std::uint32_t number) const
    {
        std::uint32_t a = all.first[number], b = all.end[number];
        const std::uint32_t begin = a;
        while (true) {
            while (a < b && all.in_face[a] != 0) ++a;
            while (a < b && all.in_face[b - 1] == 0) --b;
            if (a == b) break;
            const auto swap_in = [&](auto&... values) { (std::swap(values[a], values[b - 1]), ...); };
            swap_in(all.n_x, all.n_y, all.n_z, all.offset, all.awake_at, all.in_face, all.pair, all.particle,
                    all.surface, all.boundary);
        }
        all.faces[number] = a - begin;
    }

    /// Hands the histories of the contacts over that have ended, or clears them.
    void end_contacts(const Contacts& contacts) const
    {
        const HandOver hand_over{particles, pairs, laws.surfaces, nullptr, start};
        const HasTriangle has_triangle{pairs.j};
        for (const std::uint32_t n : contacts.ended) {
            std::uint32_t begin = n;
            while (begin > start[pairs.i[n]] && has_triangle(begin - 1)) --begin;
            hand_over.within_row(begin);
        }
        for (const std::uint32_t n : contacts.ended)
            if (pairs.in_contact[n] != 0) clear_contact(n);
    }

    /// Calls f(law, boundary, at) for packs of contacts with one law and one boundary; at(k) is the number of
    /// the contact of lane k.
    template <class F>
    void each_pack(Contacts& of, const F& f) const
    {
        const std::uint32_t count = of.count;
        bool one_boundary = true;
        for (std::uint32_t m = 0; m < count; ++m) {
            pairs.in_contact[of.pair[m]] = 1;
            one_boundary &= of.boundary[m] == of.boundary[0];
        }
        if (pairs.law == nullptr && one_boundary) {
            for (std::uint32_t first = 0; first < count; first += lanes)
                f(laws.law[0], laws.surfaces.boundary[of.boundary[0]],
                  [&](std::uint32_t k) { return std::min(first + k, count - 1); });
            return;
        }
        std::vector<std::uint32_t>& sorted = of.sorted;
        sorted.resize(count);
        for (std::uint32_t m = 0; m < count; ++m) sorted[m] = m;
        const auto law = [&](std::uint32_t m) { return pairs.law == nullptr ? 0 : pairs.law[of.pair[m]]; };
        std::sort(sorted.begin(), sorted.end(), [&](std::uint32_t a, std::uint32_t b) {
            return std::tuple(law(a), of.boundary[a], a) < std::tuple(law(b), of.boundary[b], b);
        });
        for (std::uint32_t first = 0, last = 0; first < count; first = last) {
            const std::uint32_t head = sorted[first];
            while (last < count && last < first + lanes && law(sorted[last]) == law(head) &&
                   of.boundary[sorted[last]] == of.boundary[head])
                ++last;
            f(laws.law[law(head)], laws.surfaces.boundary[of.boundary[head]],
              [&](std::uint32_t k) { return sorted[std::min(first + k, last - 1)]; });
        }
    }

    /// The force law for a pack of contacts with one mesh
    template <class At>
    void evaluate(const PairLaw& law, const Boundary& b, const Contacts& from, const At& at,
                  Pack& overlaps) const
    {
        std::uint32_t m[lanes], n[lanes], i[lanes];
        for (unsigned k = 0; k < lanes; ++k) m[k] = at(k), n[k] = from.pair[m[k]], i[k] = from.particle[m[k]];
        const auto v = detail::gather_rows<Pack>(particles.velocity, i),
                   w = detail::gather_rows<Pack>(particles.omega, i);
        ContactVelocities<Pack> velocities;
        ContactPoint<Pack> contact;
        for (unsigned k = 0; k < lanes; ++k) {
            const Vec3 r{from.x[m[k]], from.y[m[k]], from.z[m[k]]};
            const Nearest near{from.distance[m[k]], {from.n_x[m[k]], from.n_y[m[k]], from.n_z[m[k]]}};
            contact.delta.v[k] = static_cast<float>(v.w.v[k] - near.distance);
            const auto lane = static_cast<int>(k);
            set_lane(contact.n, lane, near.n);
            set_lane(velocities, lane,
                     boundary_velocities(laws.surfaces, pairs.j[n[k]] & ~PairView::boundary_bit, r, near,
                                         {v.x.v[k], v.y.v[k], v.z.v[k]}, {w.x.v[k], w.y.v[k], w.z.v[k]},
                                         v.w.v[k], laws.lag));
        }
        evaluate_on_boundary(law, b, contact, v.w, velocities, w, n, overlaps);
    }
};

}  // namespace

void TriangleContacts::list(const PairView& pairs, const Surfaces& surfaces, const std::uint32_t* which,
                            std::uint32_t count)
{
    first.clear(), end.clear();
    longest = 0;
    std::uint32_t size = 0;
    for (std::uint32_t begin = 0, next = 0; begin < count; begin = next) {
        next = std::min(begin + list_chunk, count);
        while (next < count && pairs.i[which[next]] == pairs.i[which[next - 1]]) ++next;
        first.push_back(size), end.push_back(size + (next - begin));
        size = end.back() + lanes;
        longest = std::max(longest, next - begin);
    }
    for (auto* values : {&n_x, &n_y, &n_z, &offset}) values->resize(size);
    for (auto* values : {&pair, &particle, &surface, &boundary}) values->assign(size, 0);
    std::uint32_t c = 0;
    for (std::size_t k = 0; k < first.size(); ++k)
        for (std::uint32_t m = first[k]; m < end[k]; ++m, ++c) {
            pair[m] = which[c], particle[m] = pairs.i[which[c]];
            surface[m] = pairs.j[which[c]] & ~PairView::boundary_bit;
            boundary[m] = surfaces.boundary_of(surface[m]);
        }
    wake();
}

void TriangleContacts::wake()
{
    awake_at.assign(pair.size(), -std::numeric_limits<float>::infinity());
    in_face.assign(pair.size(), 0);
    faces.assign(first.size(), 0);
}

void TriangleContacts::find_loads(par::Cpu cpu, const ParticleView& particles, const PairView& pairs,
                                  const LawView& laws, const std::uint32_t* start, double path)
{
    par::for_each(cpu, faces.size(), TriangleLoop{{particles, pairs, laws}, *this, start, path}, 1);
}

std::size_t TriangleContacts::bytes() const
{
    const auto of = [](const auto&... values) { return (... + (values.capacity() * sizeof values[0])); };
    return of(first, end, faces, n_x, n_y, n_z, offset, awake_at, in_face, pair, particle, surface, boundary);
}

}  // namespace hilda::granular
