// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/world.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <numeric>
#include <sstream>

namespace hilda::granular {

namespace {

template <class Value>
[[noreturn]] void refuse(const std::string& where, const std::string& what, const Value& value)
{
    std::ostringstream text;
    text.precision(9);
    text << where << ": " << what << ", got " << value;
    throw InvalidCase(text.str());
}

bool finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

double sphere_mass(double radius, double density)
{
    return 4.0 / 3 * M_PI * radius * radius * radius * density;
}

Vec3 to_double(const Four& v) { return {v.x, v.y, v.z}; }
Four to_four(const Vec3& v, double w)
{
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), static_cast<float>(w)};
}

/// Time since it was last taken [s]
class Lap {
public:
    double take()
    {
        const auto now = std::chrono::steady_clock::now();
        return std::chrono::duration<double>(now - std::exchange(last, now)).count();
    }

private:
    std::chrono::steady_clock::time_point last = std::chrono::steady_clock::now();
};

}  // namespace

World::World(const WorldOptions& o, std::vector<Material> all) : options(o), materials(std::move(all))
{
    for (const auto& [low, high, axis] :
         {std::tuple{o.low.x, o.high.x, 'x'}, {o.low.y, o.high.y, 'y'}, {o.low.z, o.high.z, 'z'}})
        if (!(low < high) || !std::isfinite(low) || !std::isfinite(high))
            refuse("domain", std::string("the high end along ") + axis + " must be above the low one", high);
    if (!(o.h > 0) || !std::isfinite(o.h)) refuse("step", "must be positive", o.h);
    if (!(o.skin > 0 && o.skin <= 1)) refuse("skin", "must be in (0, 1] diameters", o.skin);
    for (const Material& m : materials) {
        const std::string where = "material '" + m.name + "'";
        if (!(m.density > 0) || !std::isfinite(m.density))
            refuse(where, "density must be positive", m.density);
        if (!(m.E > 0) || !std::isfinite(m.E)) refuse(where, "E must be positive", m.E);
        if (!(m.nu > -1 && m.nu < 0.5)) refuse(where, "nu must be between -1 and 0.5", m.nu);
    }
    law_of.assign(materials.size() * materials.size(), no_law);
}

World::~World() = default;

void World::set_law(int i, int j, const PairLaw& law)
{
    const int n = static_cast<int>(materials.size());
    for (const int m : {i, j})
        if (m < 0 || m >= n) refuse("law", "no material has this number", m);
    if (laws.size() >= 255) refuse("law", "no more than 255 laws are possible", laws.size() + 1);
    law_of[i * n + j] = law_of[j * n + i] = static_cast<std::uint8_t>(laws.size());
    laws.push_back(law);
    look_again();
}

int World::add(const Boundary& b)
{
    if (b.material < 0 || b.material >= static_cast<int>(materials.size()))
        refuse("boundary", "no material has this number", b.material);
    boundaries.push_back(b);
    look_again();
    return static_cast<int>(boundaries.size()) - 1;
}

std::uint32_t World::add(const Particle& p)
{
    const auto id = static_cast<std::uint32_t>(particle.count + waiting.size());
    const std::string where = "particle " + std::to_string(id);
    if (!(p.radius > 0) || !std::isfinite(p.radius)) refuse(where, "the radius must be positive", p.radius);
    if (!finite(p.r) || !finite(p.v) || !finite(p.omega))
        refuse(where, "place and velocities must be finite", p.r.x);
    if (p.material < 0 || p.material >= static_cast<int>(materials.size()))
        refuse(where, "no material has this number", p.material);
    if (!(p.mass >= 0) || !std::isfinite(p.mass)) refuse(where, "the mass must not be negative", p.mass);
    waiting.push_back(p);
    if (!(p.mass > 0))
        waiting.back().mass = sphere_mass(p.radius, materials[static_cast<std::size_t>(p.material)].density);
    return id;
}

void World::reserve(std::size_t n) { waiting.reserve(n); }

std::string World::name_of(std::uint32_t id) const { return "particle " + std::to_string(id); }

/// Cells for particles as large as the largest of these
void World::set_grid(const std::vector<Particle>& all)
{
    double largest = 0;
    radius_of_all = static_cast<float>(all[0].radius);
    for (const Particle& p : all) {
        largest = std::max(largest, 2 * p.radius);
        if (static_cast<float>(p.radius) != radius_of_all) radius_of_all = 0;
    }
    skin = static_cast<float>(options.skin * largest);
    const double edge = largest + skin;
    const double low[] = {options.low.x, options.low.y, options.low.z},
                 high[] = {options.high.x, options.high.y, options.high.z};
    double widest = edge;
    for (int k = 0; k < 3; ++k) {
        grid.low[k] = low[k];
        grid.periodic[k] = options.periodic[k];
        const double length = high[k] - low[k];
        const double cells = options.periodic[k] ? std::floor(length / edge) : std::ceil(length / edge);
        const int most = k == 2 ? 1 << Grid::bits_z : 1 << Grid::bits_y;
        if (cells > most)
            refuse("domain",
                   "is more cells wide than " + std::to_string(most) + "; a cell is a diameter and the skin",
                   cells);
        if (options.periodic[k] && cells < 3)
            refuse("domain", "must be three largest diameters wide, with the skin, where it is periodic",
                   length);
        grid.cells[k] = static_cast<std::int32_t>(cells);
        if (options.periodic[k]) widest = std::max(widest, length / cells);
    }
    grid.unit = widest / Grid::widest;
    for (int k = 0; k < 3; ++k)
        grid.width[k] =
            options.periodic[k]
                ? static_cast<std::int32_t>(std::lround((high[k] - low[k]) / grid.cells[k] / grid.unit))
                : static_cast<std::int32_t>(std::lround(edge / grid.unit));
}

/// Those that were added since the last step become part of the arrays, which are then in the order of the ids.
void World::settle_in()
{
    if (waiting.empty()) return;
    const std::vector<Particle> all = particles();
    waiting.clear();
    set_grid(all);

    // contacts and accelerations of those that are there go on
    const auto id = [&](std::uint32_t k) { return particle.id.data()[k]; };
    for (std::uint32_t n = 0; n < pairs.count; ++n) {
        std::uint32_t &i = pairs.i.data()[n], &j = pairs.j.data()[n];
        i = id(i);
        if ((j & PairView::boundary) == 0) j = id(j);
    }
    std::vector<Four> acc_of(all.size()), turn_of(all.size());
    for (std::uint32_t k = 0; k < acc.size(); ++k)
        acc_of[id(k)] = acc.data()[k], turn_of[id(k)] = turn.data()[k];

    particle.resize(static_cast<std::uint32_t>(all.size()));
    for (std::uint32_t k = 0; k < particle.count; ++k) {
        const Particle& p = all[k];
        std::int32_t cell[3], at[3];
        const double r[] = {p.r.x, p.r.y, p.r.z};
        for (int c = 0; c < 3; ++c) {
            const double units = (r[c] - grid.low[c]) / grid.unit;
            const double whole = std::floor(units / grid.width[c]);
            if (!(whole >= 0 && whole < grid.cells[c]))
                refuse(name_of(k), std::string("is outside the domain along ") + "xyz"[c], r[c]);
            cell[c] = static_cast<std::int32_t>(whole);
            at[c] = static_cast<std::int32_t>(std::lround(units - whole * grid.width[c]));
        }
        particle.position.data()[k] = {Grid::pack(cell[0], cell[1], cell[2]), at[0], at[1], at[2]};
        const double mass = p.mass > 0 ? p.mass : sphere_mass(p.radius, materials[p.material].density);
        particle.velocity.data()[k] = to_four(p.v, p.radius);
        particle.omega.data()[k] = to_four(p.omega, p.fixed ? 0 : 1 / mass);
        particle.rest.data()[k] = {.way = {}, .v = {}, .material = static_cast<std::uint32_t>(p.material)};
        particle.id.data()[k] = k;
    }
    if (options.scheme == Scheme::chung || options.scheme == Scheme::velocity_verlet) {
        acc.resize(particle.count), turn.resize(particle.count);
        std::copy(acc_of.begin(), acc_of.end(), acc.data());
        std::copy(turn_of.begin(), turn_of.end(), turn.data());
    }
    check_laws();
    look_again();
    look_for_neighbours();
    check_overlaps();
}

/// All materials that may meet have a law.
void World::check_laws() const
{
    const std::size_t n = materials.size();
    std::vector<char> of_particles(n, 0), all(n, 0);
    for (std::uint32_t k = 0; k < particle.count; ++k) of_particles[particle.rest.data()[k].material] = 1;
    all = of_particles;
    for (const Boundary& b : boundaries) all[static_cast<std::size_t>(b.material)] = 1;
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
            if (of_particles[i] != 0 && all[j] != 0 && law_of[i * n + j] == no_law)
                refuse("laws", "there is none between two materials that may meet",
                       "'" + materials[i].name + "' and '" + materials[j].name + "'");
}

/// Where particles begin, they are not pressed into each other or into a boundary.
void World::check_overlaps() const
{
    if (number > 0) return;
    constexpr double deepest = 0.05;  // of the smaller radius
    const std::vector<Particle> all = particles();
    for (const Contact& c : contacts()) {
        const double R = c.boundary ? all[c.i].radius : std::min(all[c.i].radius, all[c.j].radius);
        if (c.delta > deepest * R)
            refuse(name_of(c.i) + " and " + (c.boundary ? "boundary " + std::to_string(c.j) : name_of(c.j)),
                   "must not overlap by more than 5 % of a radius at the start", c.delta);
    }
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
                } else {
                    const double E_eff = l.E_eff, v = std::max(fastest, 0.1);
                    limits.collision = std::min(limits.collision,
                                                2.87 * std::pow(mass * mass / (R * E_eff * E_eff * v), 0.2));
                }
            });
    }
    return limits;
}

void World::look_for_neighbours()
{
    const bool turning = std::any_of(laws.begin(), laws.end(), [](const PairLaw& l) { return l.turns(); });
    const Reach reach{.grid = grid,
                      .skin = skin,
                      .law_of = laws.size() > 1 ? law_of.data() : nullptr,
                      .materials = static_cast<std::uint32_t>(materials.size()),
                      .boundary = boundaries.data(),
                      .boundaries = static_cast<std::uint32_t>(boundaries.size()),
                      .turning = turning};
    try {
        neighbours.find(reach, particle, pairs);
    } catch (const LeftDomain& lost) {
        const std::uint32_t id = lost.id;
        const auto* at = std::find(particle.id.data(), particle.id.data() + particle.count, id);
        const Vec3 v = to_double(particle.velocity.data()[at - particle.id.data()]);
        std::ostringstream what;
        what << "particle " << id << " has left the domain at t = " << time << " s, with a velocity of ("
             << v.x << ", " << v.y << ", " << v.z << ") m/s";
        throw ParticleLost(what.str(), id, time);
    }
    moved = 0;
    ++found;
}

LawView World::law_view() const
{
    return {laws.data(), static_cast<int>(laws.size()), boundaries.data(), static_cast<float>(options.h)};
}

ParticleView World::particle_view() const
{
    return {grid, particle.position.data(), particle.velocity.data(), particle.omega.data(), radius_of_all};
}

PairView World::pair_view() const
{
    return {pairs.i.data(),       pairs.j.data(),       laws.size() > 1 ? pairs.law.data() : nullptr,
            pairs.history.data(), pairs.turning.data(), pairs.load.data(),
            pairs.torque.data(),  pairs.touches.data(), pairs.count};
}

Advance World::advance_by(Part part)
{
    const bool turning = pairs.torque.size() > 0;
    return {.position = particle.position.data(),
            .velocity = particle.velocity.data(),
            .omega = particle.omega.data(),
            .rest = particle.rest.data(),
            .acc = acc.data(),
            .turn = turn.data(),
            .start = pairs.start.data(),
            .other_start = pairs.other_start.data(),
            .other = pairs.other.data(),
            .load = pairs.load.data(),
            .torque = turning ? pairs.torque.data() : nullptr,
            .step = {.scheme = options.scheme,
                     .part = part,
                     .gravity = {static_cast<float>(options.gravity.x), static_cast<float>(options.gravity.y),
                                 static_cast<float>(options.gravity.z)},
                     .h = static_cast<float>(options.h),
                     .per_metre = static_cast<float>(1 / grid.unit),
                     .turns = locked_turning ? 0.f : 1.f}};
}

void World::step(long n)
{
    const par::Cpu cpu;
    if (!waiting.empty()) {
        if (laws.empty()) refuse("world", "no law is set for its materials", "none");
        settle_in();
    }
    const bool verlet = options.scheme == Scheme::velocity_verlet;
    for (; n > 0; --n) {
        Lap lap;
        if (verlet && number > 0) advance(cpu, particle.count, advance_by(Part::before_loads));
        times.advance += lap.take();
        if (moved > 0.5 * skin) look_for_neighbours();
        times.neighbours += lap.take();
        find_loads(cpu, particle_view(), pair_view(), law_view());
        times.loads += lap.take();
        const float fastest =
            advance(cpu, particle.count, advance_by(verlet ? Part::after_loads : Part::whole));
        times.advance += lap.take();
        double way = options.h * std::sqrt(static_cast<double>(fastest));
        for (Boundary& b : boundaries) {
            b.r += options.h * b.v;
            way = std::max(way, options.h * b.v.norm());
        }
        if (!(way < grid.unit * Grid::widest)) {
            std::uint32_t k = 0;
            float most = -1;
            for (std::uint32_t m = 0; m < particle.count; ++m) {
                const Four v = particle.velocity.data()[m];
                const float v2 = v.x * v.x + v.y * v.y + v.z * v.z;
                if (!(v2 <= most)) most = v2, k = m;
            }
            std::ostringstream what;
            what << "particle " << particle.id.data()[k]
                 << " moves more than a cell in a step at t = " << time << " s, with " << std::sqrt(most)
                 << " m/s";
            throw ParticleLost(what.str(), particle.id.data()[k], time);
        }
        moved += way;
        time = static_cast<double>(++number) * options.h;
    }
}

std::vector<Particle> World::particles() const
{
    std::vector<Particle> all(particle.count);
    for (std::uint32_t k = 0; k < particle.count; ++k) {
        const Four v = particle.velocity.data()[k], w = particle.omega.data()[k];
        const Rest& rest = particle.rest.data()[k];
        Particle& p = all[particle.id.data()[k]];
        p.r = place(grid, particle.position.data()[k]) +
              grid.unit * Vec3{Rest::wide(rest.way[0]), Rest::wide(rest.way[1]), Rest::wide(rest.way[2])};
        p.v = to_double(v) + Vec3{Rest::wide(rest.v[0]), Rest::wide(rest.v[1]), Rest::wide(rest.v[2])},
        p.omega = to_double(w);
        p.radius = v.w;
        p.material = static_cast<int>(rest.material);
        p.fixed = w.w == 0;
        p.mass = p.fixed ? 0 : 1 / static_cast<double>(w.w);
    }
    all.insert(all.end(), waiting.begin(), waiting.end());
    return all;
}

std::vector<Contact> World::contacts() const
{
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
    PairView view = pair_view();
    view.history = history.data(), view.load = load.data(), view.touches = touches.data();
    if (view.turning != nullptr) view.turning = turning.data(), view.torque = torque.data();
    find_loads(par::Cpu(), particle_view(), view, law_view());

    std::vector<Contact> all;
    for (std::uint32_t n = 0; n < pairs.count; ++n) {
        if (touches.data()[n] == 0) continue;
        const std::uint32_t i = pairs.i.data()[n], j = pairs.j.data()[n];
        Contact c;
        c.boundary = (j & PairView::boundary) != 0;
        c.i = particle.id.data()[i];
        c.j = c.boundary ? j & ~PairView::boundary : particle.id.data()[j];
        const Position at = particle.position.data()[i];
        const double R = particle.velocity.data()[i].w;
        const Vec3 r = place(grid, at);
        if (c.boundary) {
            const Nearest near = nearest(boundaries[c.j], r);
            c.n = near.n, c.delta = R - near.distance;
            c.C = r - near.distance * near.n;
        } else {
            const Difference d = difference(grid, at, particle.position.data()[j]);
            const Vec3 apart = grid.unit * Vec3{double(d.x), double(d.y), double(d.z)};
            c.n = (1 / apart.norm()) * apart;
            c.delta = R + particle.velocity.data()[j].w - apart.norm();
            c.C = r - R * c.n;
        }
        if (view.torque != nullptr) c.T = to_double(torque.data()[n]);
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

Wrench World::wrench(int b) const
{
    Wrench sum;
    for (const Contact& c : contacts()) {
        if (!c.boundary || static_cast<int>(c.j) != b) continue;
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

void World::set_velocity(std::uint32_t id, const Vec3& v, const Vec3& omega)
{
    settle_in();
    for (std::uint32_t k = 0; k < particle.count; ++k)
        if (particle.id.data()[k] == id) {
            particle.velocity.data()[k] = to_four(v, particle.velocity.data()[k].w);
            for (std::uint16_t& rest : particle.rest.data()[k].v) rest = 0;
            particle.omega.data()[k] = to_four(omega, particle.omega.data()[k].w);
        }
}

std::size_t World::bytes() const
{
    return particle.bytes() + pairs.bytes() + neighbours.bytes() + acc.bytes() + turn.bytes();
}

}  // namespace hilda::granular
