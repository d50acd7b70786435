// SPDX-License-Identifier: GPL-3.0-or-later
// Checks that the state of a world and its loads are finite. A run makes them before it writes an output.
#include "granular/world/value_text.hpp"
#include "granular/world/world_impl.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

namespace hilda::granular {

namespace detail {

double not_finite(const WatchRecord& w)
{
    static_assert(sizeof w % sizeof(double) == 0);
    constexpr std::size_t integers = 4, numbers = sizeof w / sizeof(double) - integers;
    static_assert(offsetof(WatchRecord, kinetic) == integers * sizeof(double));
    double all[numbers];
    std::memcpy(all, reinterpret_cast<const char*>(&w) + integers * sizeof(double), sizeof all);
    const double* const at =
        std::find_if(std::begin(all), std::end(all), [](double x) { return !std::isfinite(x); });
    return at == std::end(all) ? 0 : *at;
}

}  // namespace detail

using namespace detail;

namespace {

[[noreturn]] void refuse_state(const std::string& what, double t, const std::string& value)
{
    std::ostringstream text;
    text.precision(9);
    text << what << " is not finite at t = " << t << " s, got " << value;
    throw NotFiniteState(text.str());
}

}  // namespace

void World::check_finite() const
{
    if (!engine->is_finite()) engine->each_piece(true, [&](const Piece& piece) { check_particles(piece); });
    check_clumps();
    for (std::size_t b = 0; b < boundaries.size(); ++b)
        for (const Vec3& v : {boundaries[b].r, boundaries[b].axis, boundaries[b].v, boundaries[b].omega,
                              boundaries[b].F, boundaries[b].T})
            if (!granular::finite(v))
                refuse_state("boundary " + std::to_string(b) + ": its place, velocity or load", time,
                             shown(v));
    for (const RemovedParticle& r : removed_particles)
        if (!granular::finite(r.v) || !granular::finite(r.omega))
            refuse_state(name_of(r.id) + ", which has left the domain: the velocity", time,
                         shown(not_finite({r.v, r.omega})));
    if (const double x = not_finite(record); !(x == 0))
        refuse_state("an energy or momentum of the watch", time, shown(x));
}

void World::check_particles(const Piece& piece) const
{
    const Particles<par::Cpu>& p = piece.arrays.particle;
    for (std::uint32_t k = 0; k < piece.particles; ++k) {
        const Compensation& c = p.compensation.data()[k];
        const auto check = [&](const char* what, const Float4& x, const std::uint16_t* remainder) {
            const Vec3 all = to_double(x) + to_double(load_bfloat16(remainder));
            if (!granular::finite(all)) refuse_state(name_of(p.id.data()[k]) + what, time, shown(all));
        };
        check(": the velocity", p.velocity.data()[k], c.v);
        check(": the angular velocity", p.omega.data()[k], c.omega);
        if (p.orientation.size() == 0) continue;
        const Float4 e = p.orientation.data()[k], remainder = p.orientation_compensation.data()[k];
        if (!finite(e) || !finite(remainder))
            refuse_state(
                name_of(p.id.data()[k]) + ": the orientation", time,
                shown(Float4{e.x + remainder.x, e.y + remainder.y, e.z + remainder.z, e.w + remainder.w}));
    }
    for (std::uint32_t k = 0; p.acc.size() > 0 && k < piece.particles; ++k)
        if (!finite(p.acc.data()[k]) || !finite(p.alpha.data()[k]))
            refuse_state(name_of(p.id.data()[k]) + ": the acceleration", time,
                         shown(not_finite({to_double(p.acc.data()[k]), to_double(p.alpha.data()[k])})));
    check_histories(piece.arrays);
}

void World::check_histories(const Arrays<par::Cpu>& a) const
{
    const Pairs<par::Cpu>& pairs = a.pairs;
    const auto check = [&](const par::Array<par::Cpu, Float4>& values, std::uint32_t n) {
        if (values.size() == 0 || finite(values.data()[n])) return;
        const Float4 x = values.data()[n];
        const std::uint32_t* id = a.particle.id.data();
        const std::uint32_t j = pairs.j.data()[n];
        const bool boundary = (j & PairView::boundary_bit) != 0;
        refuse_state(
            name_of(id[pairs.i.data()[n]]) + " and " +
                (boundary ? "boundary " + std::to_string(surfaces().boundary_of(j & ~PairView::boundary_bit))
                          : name_of(id[j])) +
                ": the history of the contact",
            time, shown(x));
    };
    for (std::uint32_t n = 0; n < pairs.count; ++n) {
        if (pairs.in_contact.data()[n] == 0) continue;
        check(pairs.history, n), check(pairs.rotation_history, n), check(pairs.internal, n);
    }
}

void World::check_loads(const Totals& totals) const
{
    bool all_finite =
        std::all_of(totals.stress.begin(), totals.stress.end(), [](double x) { return std::isfinite(x); });
    for (const Wrench& on : totals.on_boundary)
        all_finite = all_finite && granular::finite(on.F) && granular::finite(on.T);
    if (all_finite) return;
    for (const ContactRecord& c : contacts())
        if (!granular::finite(c.F) || !granular::finite(c.T))
            refuse_state(name_of(c.i) + " and " +
                             (c.boundary ? "boundary " + std::to_string(c.j) : name_of(c.j)) +
                             ": the contact force",
                         time, shown(granular::finite(c.F) ? c.T : c.F));
    refuse_state("the sum of the contact forces", time,
                 shown(Vec3{totals.stress[0], totals.stress[4], totals.stress[8]}));
}

}  // namespace hilda::granular
