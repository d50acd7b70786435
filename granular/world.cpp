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

std::string name_of(std::uint32_t id) { return "particle " + std::to_string(id); }

/// Schemes that want the accelerations of the step before
bool keeps_accelerations(Scheme s) { return s == Scheme::chung || s == Scheme::velocity_verlet; }

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

World::World(const WorldOptions& o, std::vector<Material> all)
    : World(o, std::move(all), make_engine(o.device))
{}

World::World(const WorldOptions& o, std::vector<Material> all, std::unique_ptr<Engine> on)
    : options(o), materials(std::move(all)), engine(std::move(on))
{
    for (const auto& [low, high, axis] :
         {std::tuple{o.low.x, o.high.x, 'x'}, {o.low.y, o.high.y, 'y'}, {o.low.z, o.high.z, 'z'}})
        if (!(low < high) || !std::isfinite(low) || !std::isfinite(high))
            refuse("domain", std::string("the high end along ") + axis + " must be above the low one", high);
    if (!(o.h > 0) || !std::isfinite(o.h)) refuse("step", "must be positive", o.h);
    if (!(o.skin > 0 && o.skin <= 1)) refuse("skin", "must be in (0, 1] diameters", o.skin);
    constexpr std::size_t most = 4096;  // whose table of pairs takes 16 MB
    if (materials.size() > most)
        refuse("materials", "there must not be more than " + std::to_string(most), materials.size());
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
    laws_changed = true;
    look_again();
}

int World::add(const Boundary& b)
{
    if (b.material < 0 || b.material >= static_cast<int>(materials.size()))
        refuse("boundary", "no material has this number", b.material);
    if (!finite(b.r) || !finite(b.v) || !finite(b.omega) || !finite(b.F))
        refuse("boundary", "place, velocities and force must be finite", b.r.norm() + b.v.norm());
    const bool round = b.shape == Boundary::Shape::cylinder || b.shape == Boundary::Shape::sphere;
    if (round && !(b.radius > 0 && std::isfinite(b.radius)))
        refuse("boundary", "the radius must be positive", b.radius);
    if (b.shape != Boundary::Shape::sphere && !(std::abs(b.axis.norm() - 1) < 1e-9))
        refuse("boundary", "axis must be a unit vector; its length", b.axis.norm());
    if (!(b.mass >= 0) || !(b.inertia >= 0) || !std::isfinite(b.mass + b.inertia))
        refuse("boundary", "mass and inertia must not be negative", b.mass >= 0 ? b.inertia : b.mass);
    boundaries.push_back(b);
    laws_changed = true;
    look_again();
    return static_cast<int>(boundaries.size()) - 1;
}

std::uint32_t World::add(const Particle& p)
{
    const auto id = static_cast<std::uint32_t>(count());
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

/// Cells for particles as large as the largest of these
Scene World::scene_of(const std::vector<Particle>& all) const
{
    Scene in;
    Grid& grid = in.grid;
    double largest = 0;
    in.radius = static_cast<float>(all[0].radius);
    for (const Particle& p : all) {
        largest = std::max(largest, 2 * p.radius);
        if (static_cast<float>(p.radius) != in.radius) in.radius = 0;
        in.replicas = std::max(in.replicas, std::uint32_t{p.replica} + 1);
    }
    in.skin = static_cast<float>(options.skin * largest);
    const double edge = largest + in.skin;
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
    const double cells = double(in.replicas) * grid.cells[0] * grid.cells[1] * grid.cells[2];
    if (cells > 0x7fffffff) refuse("domain", "has more than 2^31 cells, with all of its replicas", cells);
    grid.unit = widest / Grid::widest;
    for (int k = 0; k < 3; ++k) {
        const double length = high[k] - low[k];
        grid.width[k] = static_cast<std::int32_t>(
            std::lround((options.periodic[k] ? length / grid.cells[k] : edge) / grid.unit));
        grid.last[k] = static_cast<std::int32_t>(
            std::lround(length / grid.unit - double(grid.width[k]) * (grid.cells[k] - 1)));
    }
    return in;
}

/// Cells and places in them. ParticleLost for one that had left the domain; InvalidCase for one that was never in it.
std::vector<Position> World::places(const Scene& in, const std::vector<Particle>& all) const
{
    const Grid& grid = in.grid;
    std::vector<Position> position(all.size());
    for (std::uint32_t k = 0; k < all.size(); ++k) {
        std::int32_t cell[3], at[3];
        const double r[] = {all[k].r.x, all[k].r.y, all[k].r.z};
        for (int c = 0; c < 3; ++c) {
            double units = (r[c] - grid.low[c]) / grid.unit;
            const double length = double(grid.width[c]) * (grid.cells[c] - 1) + grid.last[c];
            if (grid.periodic[c] != 0) {
                units -= length * std::floor(units / length);
            } else if (!(units >= 0 && units <= length)) {
                if (k >= particles_in)
                    refuse(name_of(k), std::string("is outside the domain along ") + "xyz"[c], r[c]);
                const std::uint32_t* id = engine->arrays().particle.id.data();
                lose(static_cast<std::uint32_t>(std::find(id, id + particles_in, k) - id),
                     "has left the domain");
            }
            const double whole = std::min(std::floor(units / grid.width[c]), double(grid.cells[c] - 1));
            cell[c] = static_cast<std::int32_t>(whole);
            at[c] = static_cast<std::int32_t>(std::lround(units - whole * grid.width[c]));
        }
        position[k] = {Grid::pack(cell[0], cell[1], cell[2]), at[0], at[1], at[2]};
    }
    return position;
}

/// Those that were added since the last step become part of the arrays, which are then in the order of the ids. What is
/// refused before that leaves the world as it was.
void World::settle_in()
{
    if (!refused.empty()) throw InvalidCase(refused);
    if (waiting.empty()) return;
    if (laws.empty()) refuse("world", "no law is set for its materials", "none");
    const std::vector<Particle> all = particles();
    const Scene next = scene_of(all);
    const std::vector<Position> position = places(next, all);
    check_laws(all);
    Arrays<par::Cpu>& a = engine->arrays();
    const auto first = static_cast<std::uint32_t>(particles_in);
    scene = next;

    // contacts and accelerations of those that are there go on
    Particles<par::Cpu>& p = a.particle;
    const auto id = [&](std::uint32_t k) { return p.id.data()[k]; };
    for (std::uint32_t n = 0; n < a.pairs.count; ++n) {
        std::uint32_t &i = a.pairs.i.data()[n], &j = a.pairs.j.data()[n];
        i = id(i);
        if ((j & PairView::boundary) == 0) j = id(j);
    }
    std::vector<Four> acc_of(all.size(), to_four(options.gravity, 0)), turn_of(all.size());
    for (std::uint32_t k = 0; k < p.acc.size(); ++k)
        acc_of[id(k)] = p.acc.data()[k], turn_of[id(k)] = p.turn.data()[k];

    p.resize(static_cast<std::uint32_t>(all.size()));
    for (std::uint32_t k = 0; k < p.count; ++k) {
        const Particle& one = all[k];
        const Four v = to_four(one.v, one.radius);
        p.position.data()[k] = position[k];
        p.velocity.data()[k] = v;
        p.omega.data()[k] = to_four(one.omega, one.fixed ? 0 : 1 / one.mass);
        Rest rest{
            .way = {}, .v = {}, .material = static_cast<std::uint16_t>(one.material), .replica = one.replica};
        if (k < first) {
            const Vec3 left = one.v - to_double(v);
            const double of[] = {left.x, left.y, left.z};
            for (int c = 0; c < 3; ++c) rest.v[c] = Rest::narrow(static_cast<float>(of[c]));
        }
        p.rest.data()[k] = rest;
        p.id.data()[k] = k;
    }
    if (keeps_accelerations(options.scheme)) {
        p.acc.resize(p.count), p.turn.resize(p.count);
        std::copy(acc_of.begin(), acc_of.end(), p.acc.data());
        std::copy(turn_of.begin(), turn_of.end(), p.turn.data());
    }
    waiting.clear();
    particles_in = all.size();
    if (!forces.empty()) forces.resize(all.size()), forces_changed = true;
    engine->written();
    look_for_neighbours();
    try {
        check_overlaps(first);
    } catch (const InvalidCase& e) {
        refused = e.what();
        throw;
    }
}

/// All materials that may meet have a law.
void World::check_laws(const std::vector<Particle>& particles) const
{
    const std::size_t n = materials.size();
    std::vector<char> of_particles(n, 0), all(n, 0);
    std::uint16_t replica = 0;
    for (const Particle& p : particles)
        of_particles[static_cast<std::size_t>(p.material)] = 1, replica = std::max(replica, p.replica);
    all = of_particles;
    for (const Boundary& b : boundaries) {
        all[static_cast<std::size_t>(b.material)] = 1;
        if (b.mass > 0 && replica > 0)
            refuse("boundary", "one that is free cannot be in all replicas, of which the last is", replica);
    }
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
            if (of_particles[i] != 0 && all[j] != 0 && law_of[i * n + j] == no_law)
                refuse("laws", "there is none between two materials that may meet",
                       "'" + materials[i].name + "' and '" + materials[j].name + "'");
}

/// Where particles begin, they are not pressed into each other or into a boundary: those from the first new one on.
void World::check_overlaps(std::uint32_t first) const
{
    constexpr double deepest = 0.05;  // of the smaller radius
    const std::vector<Particle> all = particles();
    for (const Contact& c : contacts()) {
        if (c.i < first && (c.boundary || c.j < first)) continue;
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

/// The particle at k of the arrays is lost: where, when and how fast.
void World::lose(std::uint32_t k, const std::string& how) const
{
    const Particles<par::Cpu>& p = engine->arrays().particle;
    const std::uint32_t id = p.id.data()[k];
    const Vec3 v = to_double(p.velocity.data()[k]);
    std::ostringstream what;
    what << name_of(id) << ' ' << how << " at t = " << time << " s, with a velocity of (" << v.x << ", "
         << v.y << ", " << v.z << ") m/s";
    throw ParticleLost(what.str(), id, time);
}

/// The list of pairs holds until two have come nearer to each other by the skin.
void World::keep_neighbours()
{
    const double far = 0.5 * scene.skin;
    if (moved <= far && moved_boundaries <= far) return;
    // The sum of the longest ways of each step is a bound; the longest way of one particle may be less.
    if (std::isfinite(moved) && moved_boundaries <= far) {
        const double measured = engine->longest_way() * scene.grid.unit;
        if (measured <= 0.8 * far) {
            moved = measured;
            return;
        }
    }
    look_for_neighbours();
}

void World::look_for_neighbours() const
{
    if (laws_changed) {
        check_laws(particles());
        engine->set_laws(laws, law_of, static_cast<std::uint32_t>(materials.size()));
    }
    laws_changed = false;
    engine->set_boundaries(boundaries);
    try {
        engine->find_neighbours(scene);
    } catch (const LeftDomain& lost) {
        const Particles<par::Cpu>& p = engine->arrays().particle;
        const auto* at = std::find(p.id.data(), p.id.data() + p.count, lost.id);
        lose(static_cast<std::uint32_t>(at - p.id.data()), "has left the domain");
    }
    moved = moved_boundaries = 0;
    ++found;
}

StepOf World::step_of(Part part) const
{
    return {.scheme = options.scheme,
            .part = part,
            .gravity = {static_cast<float>(options.gravity.x), static_cast<float>(options.gravity.y),
                        static_cast<float>(options.gravity.z)},
            .h = static_cast<float>(options.h),
            .per_metre = static_cast<float>(1 / scene.grid.unit),
            .turns = locked_turning ? 0.f : 1.f};
}

/// Loads give tools their velocities of the step.
void World::push_tools()
{
    if (std::none_of(boundaries.begin(), boundaries.end(), [](const Boundary& b) { return b.mass > 0; }))
        return;
    const std::vector<Wrench> on = engine->on_free_boundaries(scene);
    for (std::size_t k = 0; k < boundaries.size(); ++k) {
        Boundary& b = boundaries[k];
        if (!(b.mass > 0)) continue;
        const Vec3 a = (1 / b.mass) * (on[k].F + b.F) + options.gravity;
        b.v += options.h * Vec3{b.free[0] ? a.x : 0, b.free[1] ? a.y : 0, b.free[2] ? a.z : 0};
        if (b.inertia > 0) b.omega += (options.h / b.inertia) * on[k].T;
    }
}

/// By their velocities; the longest way of a point on one of them within the domain
double World::move_boundaries()
{
    const double h = options.h;
    double longest = 0;
    for (Boundary& b : boundaries) {
        b.r += h * b.v;
        double way = h * b.v.norm();
        const double angle = h * b.omega.norm();
        if (b.shape != Boundary::Shape::sphere && b.omega.cross(b.axis).norm() > 0) {
            const Vec3 e = (h / angle) * b.omega;
            const Vec3 turned = std::cos(angle) * b.axis + std::sin(angle) * e.cross(b.axis) +
                                ((1 - std::cos(angle)) * e.dot(b.axis)) * e;
            b.axis = (1 / turned.norm()) * turned;
            // the corner of the domain that is farthest from it
            const Vec3 a = options.low - b.r, c = options.high - b.r;
            way +=
                angle * Vec3{std::max(std::abs(a.x), std::abs(c.x)), std::max(std::abs(a.y), std::abs(c.y)),
                             std::max(std::abs(a.z), std::abs(c.z))}
                            .norm();
        }
        longest = std::max(longest, way);
    }
    return longest;
}

void World::before_each_step(std::function<void(World&)> f) { callbacks.push_back(std::move(f)); }

void World::step(long n)
{
    settle_in();
    for (; n > 0; --n) {
        for (const auto& f : callbacks) f(*this);
        settle_in();
        one_step();
        time = static_cast<double>(++number) * options.h;
    }
}

void World::one_step()
{
    const auto h = static_cast<float>(options.h);
    const bool verlet = options.scheme == Scheme::velocity_verlet;
    Lap lap;
    const auto take = [&](double& to) {
        if (timed) engine->wait();
        to += lap.take();
    };
    const auto find_loads = [&] {
        take(times.advance);
        keep_neighbours();
        engine->set_boundaries(boundaries);
        take(times.neighbours);
        engine->find_loads(scene, h);
        take(times.loads);
    };
    if (forces_changed) engine->set_forces(forces);
    forces_changed = false;
    const auto limit = [&](double way) {
        if (way < scene.grid.unit * Grid::widest) return;
        const Particles<par::Cpu>& p = engine->arrays().particle;
        std::uint32_t worst = 0;
        double most = -1;
        for (std::uint32_t k = 0; k < p.count && !std::isnan(most); ++k) {
            const double speed = to_double(p.velocity.data()[k]).norm();
            if (!(speed <= most)) most = speed, worst = k;
        }
        lose(worst, "moves more than a cell in a step");
    };
    // Some schemes go with the velocity of before, some with that of after.
    const auto go = [&](Part part) {
        const float before = std::exchange(fastest, std::sqrt(engine->advance(step_of(part))));
        const double way = options.h * static_cast<double>(par::worse(before, fastest));
        limit(way);
        return way;
    };
    if (number == 0 && keeps_accelerations(options.scheme)) {
        find_loads();
        engine->advance(step_of(Part::only_loads));
    }
    if (verlet) {
        moved += go(Part::before_loads);
        moved_boundaries += move_boundaries();
        find_loads();
        push_tools();
        go(Part::after_loads);
    } else {
        if (number > 0 || !keeps_accelerations(options.scheme)) find_loads();
        push_tools();
        moved += go(Part::whole);
        moved_boundaries += move_boundaries();
    }
    take(times.advance);
}

std::vector<Particle> World::particles() const
{
    const Particles<par::Cpu>& in = engine->arrays().particle;
    const Grid& grid = scene.grid;
    std::vector<Particle> all(in.count);
    for (std::uint32_t k = 0; k < in.count; ++k) {
        const Four v = in.velocity.data()[k], w = in.omega.data()[k];
        const Rest& rest = in.rest.data()[k];
        Particle& p = all[in.id.data()[k]];
        p.r = place(grid, in.position.data()[k]) +
              grid.unit * Vec3{Rest::wide(rest.way[0]), Rest::wide(rest.way[1]), Rest::wide(rest.way[2])};
        p.v = to_double(v) + Vec3{Rest::wide(rest.v[0]), Rest::wide(rest.v[1]), Rest::wide(rest.v[2])},
        p.omega = to_double(w);
        p.radius = v.w;
        p.material = rest.material;
        p.replica = rest.replica;
        p.fixed = w.w == 0;
        p.mass =
            p.fixed ? sphere_mass(p.radius, materials[rest.material].density) : 1 / static_cast<double>(w.w);
    }
    all.insert(all.end(), waiting.begin(), waiting.end());
    return all;
}

std::vector<Contact> World::contacts() const
{
    if (!std::isfinite(moved) && particles_in > 0) {
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
        c.replica = particle.rest.data()[i].replica;
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

Wrench World::wrench(int b, int replica) const
{
    Wrench sum;
    for (const Contact& c : contacts()) {
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

void World::set_velocity(std::uint32_t id, const Vec3& v, const Vec3& omega)
{
    if (id >= count()) refuse("velocity", "no particle has this id", id);
    if (!finite(v) || !finite(omega)) refuse("velocity of " + name_of(id), "must be finite", v.norm());
    settle_in();
    Particles<par::Cpu>& p = engine->arrays().particle;
    for (std::uint32_t k = 0; k < p.count; ++k)
        if (p.id.data()[k] == id) {
            p.velocity.data()[k] = to_four(v, p.velocity.data()[k].w);
            for (std::uint16_t& rest : p.rest.data()[k].v) rest = 0;
            p.omega.data()[k] = to_four(omega, p.omega.data()[k].w);
        }
    engine->written();
}

void World::set_force(std::uint32_t id, const Vec3& F)
{
    if (id >= count()) refuse("force", "no particle has this id", id);
    if (!finite(F)) refuse("force on " + name_of(id), "must be finite", F.norm());
    forces.resize(count());
    forces[id] = to_four(F, 0);
    forces_changed = true;
}

std::size_t World::bytes_needed(std::size_t n)
{
    // with laws of rolling and spin
    constexpr std::size_t of_particle = 3 * sizeof(Position) + 4 * sizeof(Four) + sizeof(Rest) + 40,
                          of_pair = 3 * sizeof(Four) + sizeof(Load) + 14, pairs = 6;
    return n * (of_particle + pairs * of_pair + 2 * sizeof(Particle));
}

}  // namespace hilda::granular
