// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/backend/split_mix.hpp"
#include "granular/core/rigid_body.hpp"
#include "granular/world/value_text.hpp"
#include "granular/world/world_impl.hpp"

#include <algorithm>
#include <chrono>

namespace hilda::granular {

using namespace detail;

namespace {

/// Stopwatch: take() returns the time since the previous call [s].
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
            refuse("domain", std::string("the high end along ") + axis + " must be above the low one",
                   std::isfinite(low) ? high : low);
    if (!(o.h > 0) || !std::isfinite(o.h)) refuse("step", "must be positive", o.h);
    if (!(o.skin > 0 && o.skin <= 1)) refuse("skin", "must be in (0, 1] diameters", o.skin);
    constexpr std::size_t max_materials = 4096;  // the table of pairs then takes 16 MB
    if (materials.size() > max_materials)
        refuse("materials", "there must not be more than " + std::to_string(max_materials), materials.size());
    for (const Material& m : materials) {
        const std::string where = "material '" + m.name + "'";
        if (!(m.density > 0) || !std::isfinite(m.density))
            refuse(where, "density must be positive", m.density);
        if (!(m.E > 0) || !std::isfinite(m.E)) refuse(where, "E must be positive", m.E);
        if (!(m.nu > -1 && m.nu < 0.5)) refuse(where, "nu must be between -1 and 0.5", m.nu);
    }
    law_of.assign(materials.size() * materials.size(), no_law);
    engine->set_watched(watched);
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
    start_balance();
    laws_changed = true;
    invalidate_neighbours();
}

void World::set_laws(const std::vector<PairLaw>& all)
{
    if (all.size() != laws.size()) refuse("laws", "their number must not change", all.size());
    laws = all;
    // before the first neighbour search that sends them
    if (!laws_changed) engine->set_laws(laws, law_of, static_cast<std::uint32_t>(materials.size()));
}

int World::add(const Boundary& b)
{
    if (b.shape == Boundary::Shape::mesh)
        throw io::InvalidInput("boundary: a mesh must be added with its triangles, got none");
    return add_boundary(b);
}

namespace {

/// Refuses the dimensions of a boundary that it cannot have.
void check_shape(const Boundary& b)
{
    using Shape = Boundary::Shape;
    const auto positive = [](double x) { return x > 0 && std::isfinite(x); };
    const auto not_negative = [](double x) { return x >= 0 && std::isfinite(x); };
    const bool round = b.shape == Shape::cylinder || b.shape == Shape::sphere || b.shape == Shape::disk ||
                       b.shape == Shape::torus;
    if (round && !positive(b.radius)) refuse("boundary", "the radius must be positive", b.radius);
    if (b.shape == Shape::torus && !(b.second_radius > b.radius && std::isfinite(b.second_radius)))
        refuse("boundary", "the ring of a torus must be larger than its tube", b.second_radius);
    if (b.shape != Shape::frustum) return;
    for (const double R : {b.radius, b.second_radius})
        if (!not_negative(R)) refuse("boundary", "the radii of a frustum must not be negative", R);
    if (!(b.radius > 0 || b.second_radius > 0))
        refuse("boundary", "one radius of a frustum must be positive", b.second_radius);
    if (!positive(b.to - b.from)) refuse("boundary", "the length must be positive", b.to - b.from);
    const double along = b.cosine * (b.second_radius - b.radius) - b.sine * (b.to - b.from);
    if (!(std::abs(along) <= 1e-9 * (b.to - b.from)) || !(std::abs(std::hypot(b.cosine, b.sine) - 1) < 1e-9))
        refuse("boundary", "the half angle of a frustum must be that of its radii; difference [m]", along);
    const bool is_open = (b.flags & open_first_end) != 0 && (b.flags & open_second_end) != 0;
    if ((b.flags & two_sided_surface) != 0 && (b.inside != 0 || !is_open))
        refuse("boundary", "a two-sided frustum must have open ends; flags", b.flags);
}

}  // namespace

int World::add_boundary(const Boundary& b)
{
    if (b.body >= 0) refuse("boundary", "must become a part by set_part()", b.body);

    if (b.material < 0 || b.material >= static_cast<int>(materials.size()))
        refuse("boundary", "no material has this number", b.material);
    if (!finite(b.r) || !finite(b.v) || !finite(b.omega) || !finite(b.F) || !finite(b.T))
        refuse("boundary", "position, velocities, force and torque must be finite",
               not_finite({b.r, b.v, b.omega, b.F, b.T}));
    check_shape(b);
    if (b.shape != Boundary::Shape::sphere && !(std::abs(b.axis.norm() - 1) < 1e-9))
        refuse("boundary", "the length of axis must be 1", b.axis.norm());
    if (!(b.mass >= 0) || !std::isfinite(b.mass))
        refuse("boundary", "the mass must be finite and not negative", b.mass);
    if (!b.inertia.is_zero() && !is_inertia(b.inertia))
        refuse(
            "boundary",
            "the principal moments of inertia must be positive, and none larger than the sum of the others",
            shown(b.inertia));
    if (boundaries.size() >= Surfaces::first_triangle)
        refuse("boundaries", "there are too many", boundaries.size() + 1);
    boundaries.push_back(b);
    start_balance();
    laws_changed = true;
    invalidate_neighbours();
    return static_cast<int>(boundaries.size()) - 1;
}

int World::add(const Boundary& b, const TriangleMesh& mesh, bool two_sided)
{
    const std::string name = "boundary " + std::to_string(boundaries.size());
    check_mesh(mesh, name, two_sided);
    if (b.shape != Boundary::Shape::mesh)
        refuse(name, "the shape of a boundary with triangles must be a mesh", static_cast<int>(b.shape));
    const std::size_t triangles = meshes->triangle.size() + mesh.triangle.size();
    if (triangles > TriangleMesh::most_triangles)
        refuse(name, "all meshes must not have more than 2^22 triangles", triangles);
    const int number = add_boundary(b);
    // The engine may share them.
    if (meshes.use_count() > 1) meshes = std::make_shared<Meshes>(*meshes);
    meshes->add(mesh, static_cast<std::uint32_t>(number), two_sided);
    meshes_changed = true;
    return number;
}

namespace {

/// Whether the components are finite in single precision
bool is_single(const Vec3& v)
{
    constexpr double most = std::numeric_limits<float>::max();
    return std::abs(v.x) <= most && std::abs(v.y) <= most && std::abs(v.z) <= most;
}

/// Throws io::InvalidInput with the first component that is not.
[[noreturn]] void refuse_numbers(const std::string& where, std::initializer_list<Vec3> all)
{
    if (const double x = not_finite(all); x != 0) refuse(where, "must be finite", x);
    double largest = 0;
    for (const Vec3& v : all)
        for (const double x : {v.x, v.y, v.z})
            if (std::abs(x) > std::abs(largest)) largest = x;
    refuse(where, "must be in the range of single precision, up to 3.4e38", largest);
}

}  // namespace

void World::set_velocities(const std::vector<std::uint32_t>& ids, const std::vector<Vec3>& v,
                           const std::vector<Vec3>& omega)
{
    const auto omega_of = [&](std::size_t n) { return omega.empty() ? Vec3{0, 0, 0} : omega[n]; };
    places_of(ids, "velocity");
    for (std::size_t n = 0; n < ids.size(); ++n)
        if (!is_single(v[n]) || !is_single(omega_of(n)))
            refuse_numbers("velocity of " + name_of(ids[n]), {v[n], omega_of(n)});
    insert_pending();
    const std::vector<std::uint32_t> places = places_of(ids, "velocity");
    for (const std::uint32_t id : ids)
        if (clump_of(id) != no_clump)
            refuse("velocity of " + name_of(id), "must not be set, because it belongs to a clump; particle",
                   id);
    Particles<par::Cpu>& p = engine->arrays().particle;
    for (std::size_t n = 0; n < ids.size(); ++n) {
        const std::uint32_t k = places[n];
        p.velocity.data()[k] = to_float4(v[n], p.velocity.data()[k].w);
        store_bfloat16(p.compensation.data()[k].v, rounding_error(v[n]), dither_to_nearest);
        if (omega.empty()) continue;
        store_bfloat16(p.compensation.data()[k].omega, rounding_error(omega[n]), dither_to_nearest);
        p.omega.data()[k] = to_float4(omega[n], p.omega.data()[k].w);
    }
    start_balance();
    engine->arrays_modified();
}

void World::stop(std::uint16_t replica)
{
    insert_pending();
    Particles<par::Cpu>& p = engine->arrays().particle;
    for (std::uint32_t k = 0; k < p.count; ++k) {
        if (p.species.data()[k].replica != replica) continue;
        p.velocity.data()[k] = to_float4({0, 0, 0}, p.velocity.data()[k].w);
        p.omega.data()[k] = to_float4({0, 0, 0}, p.omega.data()[k].w);
        p.compensation.data()[k] = {.displacement = p.compensation.data()[k].displacement};
    }
    par::Array<par::Cpu, ClumpBody>& all = engine->arrays().clump;
    for (std::size_t k = 0; k < all.size(); ++k) {
        ClumpBody& b = all.data()[k];
        if (b.replica != replica) continue;
        b.velocity = to_float4({0, 0, 0}, b.velocity.w), b.momentum = to_float4({0, 0, 0}, b.momentum.w);
        b.compensation = {.displacement = b.compensation.displacement};
    }
    start_balance();
    engine->arrays_modified();
}

void World::set_forces(const std::vector<std::uint32_t>& ids, const std::vector<Vec3>& F)
{
    if (next_id != inserted_count) places_of(ids, "force");  // some are removed
    for (const std::uint32_t id : ids)
        if (id >= next_id + pending.size()) refuse("force", "no particle has this id", id);
    for (std::size_t n = 0; n < ids.size(); ++n)
        if (!is_single(F[n])) refuse_numbers("force on " + name_of(ids[n]), {F[n]});
    forces.resize(next_id + pending.size());
    for (std::size_t n = 0; n < ids.size(); ++n) forces[ids[n]] = to_float4(F[n], 0);
    forces_changed = true;
}

/// Throws ParticleLost for the particle with index k in the arrays. The message has its id, the time and its
/// velocity.
void World::throw_lost(std::uint32_t k, const std::string& how) const
{
    const Particles<par::Cpu>& p = engine->arrays().particle;
    const std::uint32_t id = p.id.data()[k];
    const Vec3 v = to_double(p.velocity.data()[k]);
    std::ostringstream what;
    what << name_of(id) << ' ' << how << " at t = " << time << " s, with a velocity of (" << v.x << ", "
         << v.y << ", " << v.z << ") m/s";
    throw ParticleLost(what.str(), id, time);
}

/// Rebuilds the neighbour list if a particle or a boundary may have moved by more than half the skin since
/// the list was built. Before that no pair outside the list can be in contact.
void World::update_neighbours()
{
    const double allowed = 0.5 * domain.skin;
    if (particle_displacement <= allowed && boundary_displacement <= allowed) return;
    // particle_displacement is an upper bound: the sum over the steps of the largest displacement in each
    // step. The largest displacement of one particle since the last rebuild may be smaller. If it is at
    // most 0.8 of the limit, the list remains valid.
    if (std::isfinite(particle_displacement) && boundary_displacement <= allowed) {
        const double measured = engine->largest_displacement() * domain.grid.unit;
        if (measured <= 0.8 * allowed) {
            particle_displacement = measured;
            return;
        }
    }
    rebuild_neighbours();
}

void World::rebuild_neighbours()
{
    try {
        find_neighbours();
    } catch (const LeftDomain& lost) {
        if (!removes()) throw_left(lost.id);
        const bool before = std::exchange(in_step, true);
        remove_outside();
        find_neighbours();
        in_step = before;
    }
}

/// Throws LeftDomain, in which case the list and the order of the particles have not changed.
void World::find_neighbours() const
{
    if (laws_changed) {
        check_laws({});
        engine->set_laws(laws, law_of, static_cast<std::uint32_t>(materials.size()));
    }
    laws_changed = false;
    send_boundaries();
    send_clumps();
    try {
        engine->find_neighbours(domain);
    } catch (const TooManyPairs&) {
        refuse("particles",
               "the neighbour list must not have more than 2^31 pairs; reduce the skin or the ratio of "
               "radii; particles",
               count());
    }
    particle_displacement = boundary_displacement = path = 0;
    boundaries_at_build.clear();
    for (const Boundary& b : boundaries) boundaries_at_build.emplace_back(b);
    ++rebuild_count;
}

StepParameters World::step_parameters(Part part) const
{
    // The dither of the two parts of a velocity Verlet step differs.
    const auto count = static_cast<std::uint64_t>(2 * step_count + (part == Part::after_loads ? 2 : 1));
    const double golden =
        0.6180339887498949 * static_cast<double>(count);  // low-discrepancy (golden-ratio) sequence
    return {.scheme = options.scheme,
            .part = part,
            .gravity = {static_cast<float>(options.gravity.x), static_cast<float>(options.gravity.y),
                        static_cast<float>(options.gravity.z)},
            .h = static_cast<float>(options.h),
            .units_per_metre = static_cast<float>(1 / domain.grid.unit),
            .torque_factor = rotation_locked ? 0.f : 1.f,
            .displacement_dither = static_cast<float>(golden - std::floor(golden) - 0.5),
            .velocity_dither = static_cast<std::uint32_t>(SplitMix::mixed(count * SplitMix::step) >> 48)};
}

/// Gives the boundaries to the engine, and records whether one was changed.
void World::send_boundaries() const
{
    if (std::exchange(meshes_changed, false)) engine->set_meshes(meshes);
    if (engine->set_boundaries(boundaries)) boundaries_changed = true;
}

void World::before_each_step(std::function<void(World&)> f) { callbacks.push_back(std::move(f)); }

void World::step(long n)
{
    insert_pending();
    for (; n > 0; --n) {
        for (const auto& f : callbacks) f(*this);
        insert_pending();
        one_step();
        time = static_cast<double>(++step_count) * options.h;
        in_step = false;
        if (watched) check_watch();
    }
}

void World::one_step()
{
    const bool verlet = options.scheme == Scheme::velocity_verlet;
    Lap lap;
    const auto take = [&](double& to) {
        if (timed) engine->wait();
        to += lap.take();
    };
    const auto find_loads = [&](bool store, double lag) {
        take(times.advance);
        update_neighbours();
        if (verlet) send_boundaries();  // they have moved in this step
        take(times.neighbours);
        in_step = true;
        engine->find_loads(domain, {static_cast<float>(options.h), static_cast<float>(lag * options.h)},
                           store, path);
        take(times.loads);
    };
    if (forces_changed) engine->set_forces(forces);
    forces_changed = false;
    const auto check_displacement = [&](double displacement) {
        if (displacement < domain.grid.unit * CellGrid::widest) return;
        if (std::isinf(max_speed) && engine->arrays().clump.size() > 0) throw_turns_too_far();
        const Particles<par::Cpu>& p = engine->arrays().particle;
        std::uint32_t fastest = 0;
        double max_speed_found = -1;
        for (std::uint32_t k = 0; k < p.count && !std::isnan(max_speed_found); ++k) {
            const double speed = to_double(p.velocity.data()[k]).norm();
            if (!(speed <= max_speed_found)) max_speed_found = speed, fastest = k;
        }
        throw_lost(fastest, "moves by more than a cell in one step");
    };
    // Depending on the scheme, a step moves the particles with the velocity before or after its update. The
    // bound of the displacement uses the larger one.
    const auto advance = [&](Part part) {
        in_step = true;
        const float before = std::exchange(max_speed, std::sqrt(engine->advance(step_parameters(part))));
        const double displacement = options.h * static_cast<double>(par::nan_max(before, max_speed));
        check_displacement(displacement);
        // The displacement of `chung` may exceed h times the speeds at both ends of the step.
        path += options.scheme == Scheme::chung ? 2 * displacement : displacement;
        return displacement;
    };
    const auto move = [&] {
        const double displacement = move_boundaries();
        boundary_displacement += displacement, path += displacement;
    };
    place_parts();
    send_boundaries();
    send_clumps();
    engine->prepare(domain);
    if (!is_posed()) move_attached();
    if (step_count == 0 && uses_previous_acceleration(options.scheme)) {
        find_loads(true, 0);
        engine->advance(step_parameters(Part::only_loads));
        if (verlet) find_tool_loads();
    }
    if (verlet) {
        accelerate_tools(0.5);
        particle_displacement += advance(Part::before_loads);
        move();
        if (!is_posed()) move_attached();
        find_loads(false, velocity_lag(options.scheme));
        find_tool_loads();
        accelerate_tools(0.5);
        watch_loads();
        advance(Part::after_loads);
        watch_advance();
    } else {
        if (step_count > 0 || !uses_previous_acceleration(options.scheme))
            find_loads(false, velocity_lag(options.scheme));
        find_tool_loads();
        accelerate_tools(1);
        watch_loads();
        particle_displacement += advance(Part::whole);
        watch_advance();
        move();
        if (!is_posed()) move_attached();
    }
    boundaries_changed = false;
    take(times.advance);
}

}  // namespace hilda::granular
