// SPDX-License-Identifier: GPL-3.0-or-later
// What a world tells of itself.
#include "granular/world_impl.hpp"

#include <algorithm>
#include <tuple>

namespace hilda::granular {

using namespace detail;

std::vector<Particle> World::particles() const
{
    const Particles<par::Cpu>& in = engine->arrays().particle;
    const Grid& grid = scene.grid;
    std::vector<Particle> all(in.count);
    for (std::uint32_t k = 0; k < in.count; ++k) {
        const Four v = in.velocity.data()[k], w = in.omega.data()[k];
        const Rest& rest = in.rest.data()[k];
        const Kind kind = in.kind.data()[k];
        Particle& p = all[in.id.data()[k]];
        p.r = place(grid, in.position.data()[k]) + grid.unit * to_double(rest_of_way<float>(rest.way));
        p.v = to_double(v) + to_double(from_halves(rest.v));
        p.omega = to_double(w) + to_double(from_halves(rest.omega));
        if (in.orientation.size() > 0) {
            const Four e = in.orientation.data()[k], left = in.orientation_rest.data()[k];
            p.e = unit(
                {double(e.x) + left.x, double(e.y) + left.y, double(e.z) + left.z, double(e.w) + left.w});
        }
        p.radius = v.w;
        p.material = kind.material;
        p.replica = kind.replica;
        p.fixed = w.w == 0;
        p.mass =
            p.fixed ? sphere_mass(p.radius, materials[kind.material].density) : 1 / static_cast<double>(w.w);
    }
    all.insert(all.end(), waiting.begin(), waiting.end());
    return all;
}

std::vector<Contact> World::contacts() const
{
    if (!std::isfinite(moved) && particles_in > 0 && !one_is_lost) {
        look_for_neighbours();
        moved = std::numeric_limits<
            double>::infinity();  // and once more before the next step, as it was asked for
    }
    const Arrays<par::Cpu>& a = engine->arrays();
    const Particles<par::Cpu>& particle = a.particle;
    const Pairs<par::Cpu>& pairs = a.pairs;
    const std::size_t many = pairs.count;
    const auto copy_of = [&](const auto& array) {
        using T = std::remove_reference_t<decltype(*array.data())>;
        par::Array<par::Cpu, T> copy(std::min(array.size(), many));
        par::copy_bytes(par::Cpu(), copy.data(), array.data(), copy.size() * sizeof(T));
        return copy;
    };
    const auto history = copy_of(pairs.history), turning = copy_of(pairs.turning),
               torque = copy_of(pairs.torque);
    const auto load = copy_of(pairs.load);
    const auto touches = copy_of(pairs.touches);
    const bool turns = turning.size() > 0;
    // histories of velocity Verlet are those of t; of the others, those of the step before
    const float h =
        options.scheme == Scheme::velocity_verlet && number > 0 ? 0 : static_cast<float>(options.h);
    find_loads(par::Cpu(), particle_view(scene, particle),
               {pairs.i.data(), pairs.j.data(), laws.size() > 1 ? pairs.law.data() : nullptr, history.data(),
                turns ? turning.data() : nullptr, load.data(), turns ? torque.data() : nullptr,
                touches.data(), pairs.count},
               {laws.data(), static_cast<int>(laws.size()), boundaries.data(), h});

    std::vector<Contact> all;
    for (std::uint32_t n = 0; n < pairs.count; ++n) {
        if (touches.data()[n] == 0) continue;
        const std::uint32_t i = pairs.i.data()[n], j = pairs.j.data()[n];
        Contact c;
        c.boundary = (j & PairView::boundary) != 0;
        c.i = particle.id.data()[i];
        c.j = c.boundary ? j & ~PairView::boundary : particle.id.data()[j];
        c.replica = particle.kind.data()[i].replica;
        const Position at = particle.position.data()[i];
        const double R = particle.velocity.data()[i].w;
        const Vec3 r = place(scene.grid, at);
        if (c.boundary) {
            const Nearest near = nearest(boundaries[c.j], r);
            c.n = near.n, c.delta = R - near.distance;
            c.C = r - near.distance * near.n;
        } else {
            const Difference d = difference(scene.grid, at, particle.position.data()[j]);
            const Vec3 apart = scene.grid.unit * Vec3{double(d.x), double(d.y), double(d.z)};
            c.n = (1 / apart.norm()) * apart;
            c.delta = R + particle.velocity.data()[j].w - apart.norm();
            c.C = r - R * c.n;
        }
        if (turns) c.T = to_double(torque.data()[n]);
        c.F = to_double(load.data()[n].F), c.u = to_double(history.data()[n]);
        if (!c.boundary && c.j < c.i) {
            std::swap(c.i, c.j);
            c.C += c.delta * c.n;  // at the radius of the other
            c.n = -c.n, c.F = -c.F, c.T = -c.T, c.u = -c.u;
        }
        all.push_back(c);
    }
    std::sort(all.begin(), all.end(), [](const Contact& x, const Contact& y) {
        return std::tuple(x.boundary, x.i, x.j) < std::tuple(y.boundary, y.i, y.j);
    });
    return all;
}

Wrench World::wrench(const std::vector<Contact>& contacts, int b, int replica) const
{
    Wrench sum;
    for (const Contact& c : contacts) {
        if (!c.boundary || static_cast<int>(c.j) != b || (replica >= 0 && c.replica != replica)) continue;
        sum.F -= c.F;
        sum.T -= (c.C - boundaries[c.j].r).cross(c.F) + c.T;
    }
    return sum;
}

double World::kinetic_energy() const
{
    double T = 0;
    for (const Particle& p : particles())
        T += 0.5 * p.mass * (p.v.dot(p.v) + 0.4 * p.radius * p.radius * p.omega.dot(p.omega));
    return T;
}

Vec3 World::momentum() const
{
    Vec3 P{0, 0, 0};
    for (const Particle& p : particles()) P += p.mass * p.v;
    return P;
}

World::StepLimits World::step_limits() const
{
    StepLimits limits;
    const std::vector<Particle> all = particles();
    double fastest = 0;
    for (const Particle& p : all) fastest = std::max(fastest, p.v.norm());
    for (const Particle& p : all) {
        const Material& m = materials[static_cast<std::size_t>(p.material)];
        const double G = m.E / (2 * (1 + m.nu));
        if (p.fixed) continue;
        limits.rayleigh =
            std::min(limits.rayleigh, M_PI * p.radius * std::sqrt(m.density / G) / (0.1631 * m.nu + 0.8766));
        for (const PairLaw& law : laws)
            law.normal.visit([&](const auto& l) {
                // of two of its kind, at 0.1 m/s or faster
                const double mass = p.mass / 2, R = p.radius / 2;
                if constexpr (requires { l.k_n; }) {
                    limits.collision =
                        std::min(limits.collision, M_PI * std::sqrt(mass / static_cast<double>(l.k_n)));
                    if (l.gamma_n > 0)  // a dashpot alone is stable up to 2/γ
                        limits.collision = std::min(limits.collision, M_PI / static_cast<double>(l.gamma_n));
                } else {
                    const double E_eff = l.E_eff, v = std::max(fastest, 0.1);
                    limits.collision = std::min(limits.collision,
                                                2.87 * std::pow(mass * mass / (R * E_eff * E_eff * v), 0.2));
                }
            });
    }
    return limits;
}

std::size_t World::bytes_needed(std::size_t n, bool orientation)
{
    // with laws of rolling and spin
    constexpr std::size_t of_particle =
                              3 * sizeof(Position) + 4 * sizeof(Four) + sizeof(Rest) + sizeof(Kind) + 40,
                          of_pair = 3 * sizeof(Four) + sizeof(Load) + 14, pairs = 6;
    return n * (of_particle + (orientation ? 2 * sizeof(Four) : 0) + pairs * of_pair + 2 * sizeof(Particle));
}

}  // namespace hilda::granular
