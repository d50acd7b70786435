// SPDX-License-Identifier: GPL-3.0-or-later
// Clumps of a world: their templates, insertion, state and serialisation.
#include "granular/world/value_text.hpp"
#include "granular/world/world_impl.hpp"
#include "io/archive.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

using namespace detail;

namespace {

EulerParameters<double> conjugate(const EulerParameters<double>& p) { return {p.e0, -p.e}; }

std::string clump_name(std::uint32_t id) { return "clump of particle " + std::to_string(id); }

}  // namespace

int World::add_template(const ClumpTemplate& t)
{
    t.check();
    const std::string where = "clump '" + t.name + "'";
    if (t.material < 0 || t.material >= static_cast<int>(materials.size()))
        refuse(where, "no material has this number", t.material);
    const Vec3 size = options.high - options.low;
    if (const double widest = std::max({size.x, size.y, size.z}); !(2 * t.bounding_radius() <= widest))
        refuse(where,
               "must not be larger than the domain, " + io::shortest(widest) +
                   " m; diameter of the sphere around it [m]",
               2 * t.bounding_radius());
    const PrincipalInertia principal = principal_inertia(t.inertia);
    const Vec3 J = principal.moment;
    const double mean = (J.x + J.y + J.z) / 3;
    double R = std::sqrt(2.5 * mean / t.mass);
    // The bits of a particle; the inertia has rounding errors.
    if (t.spheres.size() == 1 && std::abs(R - t.spheres[0].radius) < 1e-12 * R) R = t.spheres[0].radius;
    ClumpShape shape{.first = static_cast<std::uint32_t>(clump_tables.sphere.size()),
                     .count = static_cast<std::uint32_t>(t.spheres.size()),
                     .extra = {mean / J.x - 1, mean / J.y - 1, mean / J.z - 1},
                     .reach = 0,
                     .axes = principal.axes};
    for (double* extra : {&shape.extra.x, &shape.extra.y, &shape.extra.z})
        if (std::abs(*extra) < 1e-12) *extra = 0;
    double cubes = 0;
    for (const Sphere& s : t.spheres) cubes += s.radius * s.radius * s.radius;
    for (const Sphere& s : t.spheres) {
        const Vec3 X = rotated_back(principal.axes, s.r - t.centre);
        shape.reach = std::max(shape.reach, X.norm());
        clump_tables.sphere.push_back({X, s.radius, s.radius * s.radius * s.radius / cubes});
    }
    clump_tables.shape.push_back(shape);
    templates.push_back(t), clump_axes.push_back(principal.axes), clump_R.push_back(R);
    clumps_changed = true;
    return static_cast<int>(templates.size()) - 1;
}

/// Throws io::InvalidInput if the scale of a clump is not positive or too large for a periodic axis.
void World::check_size(int number, double scale, const std::string& where) const
{
    if (number < 0 || number >= static_cast<int>(templates.size()))
        refuse(where, "no clump has this number", number);
    if (!(scale > 0) || !std::isfinite(scale)) refuse(where, "the scale must be positive", scale);
    const ClumpTemplate& t = templates[static_cast<std::size_t>(number)];
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 size = options.high - options.low;
        const double length = axis == 0   ? size.x
                              : axis == 1 ? size.y
                                          : size.z,
                     diameter = 2 * scale * t.bounding_radius();
        if (options.periodic[static_cast<std::size_t>(axis)] && !(1.1 * diameter <= length))
            refuse(where,
                   std::string("along ") + "xyz"[axis] +
                       ", a periodic axis, the domain must be at least 1.1 times as long as the clump, " +
                       io::shortest(1.1 * diameter) + " m; length [m]",
                   length);
    }
}

void World::expect_clumps(int shape, const std::vector<double>& scales, std::uint16_t replica,
                          std::size_t clumps)
{
    Expected of{{}, 0};
    for (const double scale : scales) {
        check_size(shape, scale, "expected clump");
        const ClumpTemplate& t = templates[static_cast<std::size_t>(shape)];
        for (const Sphere& s : t.spheres)
            of.samples.push_back(checked({.radius = scale * s.radius,
                                          .material = t.material,
                                          .mass = t.mass * (scale * scale * scale),
                                          .replica = replica},
                                         "expected clump"));
        of.reach = std::max(of.reach, scale * clump_tables.shape[static_cast<std::size_t>(shape)].reach);
        of.particles = clumps * t.spheres.size();
    }
    if (!of.samples.empty()) expected.push_back(of);
}

std::uint32_t World::add_clump(const Clump& given)
{
    const auto id = static_cast<std::uint32_t>(next_id + pending.size());
    const std::string where = clump_name(id);
    check_size(given.shape, given.scale, where);
    if (!(std::abs(length(given.e) - 1) < 1e-3))
        refuse(where, "Euler parameters must have the length 1 within 1e-3", length(given.e));
    Clump c = given;
    c.e = unit(given.e), c.id = id;
    const ClumpTemplate& t = templates[static_cast<std::size_t>(c.shape)];
    c.mass = t.mass * (c.scale * c.scale * c.scale);
    const ClumpShape& shape = clump_tables.shape[static_cast<std::size_t>(c.shape)];
    const EulerParameters<double> e{c.e[0], {c.e[1], c.e[2], c.e[3]}},
        p = product(e, clump_axes[static_cast<std::size_t>(c.shape)]);
    std::vector<Particle> members;
    for (std::uint32_t m = 0; m < shape.count; ++m) {
        const ClumpSphere& s = clump_tables.sphere[shape.first + m];
        const Vec3 d = rotated(p, c.scale * s.X);
        Particle member{.r = c.r + d,
                        .radius = c.scale * s.radius,
                        .material = t.material,
                        .v = c.v + c.omega.cross(d),
                        .omega = c.omega,
                        .mass = c.mass,
                        .replica = c.replica,
                        .id = id + m,
                        .clump = id};
        if (options.orientation) member.e = c.e;
        members.push_back(checked(member, name_of(member.id)));
    }
    pending.insert(pending.end(), members.begin(), members.end());
    pending_clumps.push_back(c);
    return id;
}

std::vector<Clump> World::clumps() const
{
    if (templates.empty()) return {};
    const auto number = static_cast<std::uint32_t>(engine->arrays().clump.size());
    std::vector<Clump> all;
    all.reserve(number + pending_clumps.size());
    const auto add = [&](Clump c, const ClumpState& s) {
        c.L = (0.4 * c.mass * s.body.radius * s.body.radius) * s.w;
        all.push_back(c);
    };
    for (std::uint32_t k = 0; k < number; ++k) {
        const ClumpBody& b = engine->arrays().clump.data()[k];
        const ClumpState s = clump_state(k);
        const EulerParameters<double> e = product(b.p, conjugate(clump_axes[b.shape]));
        add({.shape = static_cast<int>(b.shape),
             .r = s.body.r,
             .e = unit({e.e0, e.e.x, e.e.y, e.e.z}),
             .v = s.body.v,
             .omega = s.body.omega,
             .scale = b.scale,
             .replica = s.body.replica,
             .id = b.first_id,
             .mass = s.body.mass},
            s);
    }
    for (const Clump& c : pending_clumps) add(c, clump_state(c));
    return all;
}

/// State of an inserted clump
World::ClumpState World::clump_state(std::uint32_t number) const
{
    const Arrays<par::Cpu>& a = engine->arrays();
    const ClumpBody& b = a.clump.data()[number];
    const Vec3 w = with_error(b.momentum, b.compensation.omega);
    Particle p;
    p.id = b.first_id, p.clump = b.first_id;
    p.r = global_position(domain.grid, b.position) +
          domain.grid.unit * to_double(unpack_remainder<float>(b.compensation.displacement));
    p.v = with_error(b.velocity, b.compensation.v);
    p.omega = clump_omega(clump_tables.shape[b.shape], b.p, w);
    p.radius = b.velocity.w;
    p.mass = 1 / static_cast<double>(b.momentum.w);
    p.material = templates[b.shape].material;
    p.replica = b.replica;
    return {p, w};
}

World::ClumpState World::clump_state(const Clump& c) const
{
    const auto number = static_cast<std::size_t>(c.shape);
    Particle p;
    p.id = c.id, p.clump = c.id, p.r = c.r, p.v = c.v, p.omega = c.omega, p.mass = c.mass;
    p.radius = c.scale * clump_R[number], p.material = templates[number].material, p.replica = c.replica;
    const EulerParameters<double> e{c.e[0], {c.e[1], c.e[2], c.e[3]}};
    return {p, clump_momentum(clump_tables.shape[number], product(e, clump_axes[number]), c.omega)};
}

/// Share of the mass of a clump that its particle with this id has
double World::fraction_of(std::uint32_t id, std::uint32_t clump) const
{
    const ClumpBody& b = engine->arrays().clump.data()[clump];
    return clump_tables.sphere[clump_tables.shape[b.shape].first + (id - b.first_id)].fraction;
}

Vec3 World::offset_in_clump(std::uint32_t id) const
{
    const std::uint32_t c = clump_of(id);
    if (c == no_clump) return {0, 0, 0};
    const ClumpBody& b = engine->arrays().clump.data()[c];
    return rotated(b.p,
                   b.scale * clump_tables.sphere[clump_tables.shape[b.shape].first + (id - b.first_id)].X);
}

/// Largest distance of a particle from the centre of mass of its clump, of inserted and pending ones [m]
double World::reach_of_clumps() const
{
    if (templates.empty()) return 0;
    double reach = 0;
    const auto include = [&](std::size_t shape, double scale) {
        reach = std::max(reach, scale * clump_tables.shape[shape].reach);
    };
    const par::Array<par::Cpu, ClumpBody>& all = engine->arrays().clump;
    for (std::size_t k = 0; k < all.size(); ++k) include(all.data()[k].shape, all.data()[k].scale);
    for (const Clump& c : pending_clumps) include(static_cast<std::size_t>(c.shape), c.scale);
    return reach;
}

/// Ids and centres of mass of the inserted clumps
std::vector<Particle> World::clump_places() const
{
    std::vector<Particle> all(engine->arrays().clump.size());
    for (std::uint32_t k = 0; k < all.size(); ++k) all[k] = clump_state(k).body;
    return all;
}

/// Adds the pending clumps, whose particles have been written to the arrays, and places the particles of all
/// clumps. `moved`: places of the earlier clumps, if the cells have changed; otherwise empty.
void World::insert_clumps(const std::vector<Particle>& moved)
{
    Arrays<par::Cpu>& a = engine->arrays();
    if (pending_clumps.empty() && a.clump.size() == 0) return;
    std::vector<ClumpBody> all(a.clump.data(), a.clump.data() + a.clump.size());
    const auto put = [](ClumpBody& b, const CellPosition& at) {
        const SplitDisplacement<float> split = split_displacement(at.remainder, 0);
        b.position = {at.position.cell, wrapped_sum(at.position.x, split.x),
                      wrapped_sum(at.position.y, split.y), wrapped_sum(at.position.z, split.z)};
        b.compensation.displacement = split.remainder;
    };
    const std::vector<CellPosition> places = cell_positions(domain, moved, moved.size());
    for (std::size_t k = 0; k < places.size(); ++k) put(all[k], places[k]);

    std::vector<Particle> bodies;
    for (const Clump& c : pending_clumps) bodies.push_back(clump_state(c).body);
    const std::vector<CellPosition> at = cell_positions(domain, bodies, 0);
    for (std::size_t k = 0; k < bodies.size(); ++k) {
        const Clump& c = pending_clumps[k];
        const ClumpState s = clump_state(c);
        const EulerParameters<double> e{c.e[0], {c.e[1], c.e[2], c.e[3]}};
        ClumpBody b{.velocity = to_float4(s.body.v, s.body.radius),
                    .momentum = to_float4(s.w, 1 / s.body.mass),
                    .acc = to_float4(options.gravity, 0),
                    .p = product(e, clump_axes[static_cast<std::size_t>(c.shape)]),
                    .scale = c.scale,
                    .first_id = c.id,
                    .shape = static_cast<std::uint16_t>(c.shape),
                    .replica = c.replica};
        put(b, at[k]);
        store_bfloat16(b.compensation.v, rounding_error(s.body.v), dither_to_nearest);
        store_bfloat16(b.compensation.omega, rounding_error(s.w), dither_to_nearest);
        all.push_back(b);
    }
    pending_clumps.clear();
    a.clump.resize(all.size());
    std::copy(all.begin(), all.end(), a.clump.data());

    Particles<par::Cpu>& p = a.particle;
    std::uint32_t ids = 0;
    for (std::uint32_t k = 0; k < p.count; ++k) ids = std::max(ids, p.id.data()[k] + 1);
    std::vector<std::uint32_t> index(ids);
    for (std::uint32_t k = 0; k < p.count; ++k) index[p.id.data()[k]] = k;
    const MemberView members{.grid = domain.grid,
                             .shape = clump_tables.shape.data(),
                             .sphere = clump_tables.sphere.data(),
                             .index = index.data(),
                             .position = p.position.data(),
                             .velocity = p.velocity.data(),
                             .omega = p.omega.data(),
                             .compensation = p.compensation.data(),
                             .orientation = p.orientation.data(),
                             .orientation_compensation = p.orientation_compensation.data()};
    for (const ClumpBody& b : all) {
        // Places the masses as well; the particles of clumps have the mass of the clump.
        for (std::uint32_t m = 0; m < members.shape[b.shape].count; ++m)
            p.omega.data()[index[b.first_id + m]].w = b.momentum.w;
        members.place(b);
    }
}

/// Sets the clumps of the particles after the list of clumps has changed.
void World::update_clump_tables()
{
    if (templates.empty()) return;
    const par::Array<par::Cpu, ClumpBody>& all = engine->arrays().clump;
    clump_tables.of.assign(next_id, no_clump);
    for (std::uint32_t k = 0; k < all.size(); ++k) {
        const ClumpBody& b = all.data()[k];
        std::fill_n(clump_tables.of.begin() + b.first_id, clump_tables.shape[b.shape].count, k);
    }
    if (all.size() == 0) clump_tables.of.clear();
    clump_tables.reach = reach_of_clumps();
    clumps_changed = true;
}

/// Passes the tables of the clumps to the engine.
void World::send_clumps() const
{
    if (std::exchange(clumps_changed, false)) engine->set_clumps(domain, clump_tables);
}

void World::check_clumps() const
{
    for (const Clump& c : clumps())
        if (!granular::finite(c.v) || !granular::finite(c.omega) || !std::isfinite(length(c.e)))
            throw NotFiniteState(clump_name(c.id) + ": the motion is not finite at t = " + shown(time) +
                                 " s, got " + shown(not_finite({c.v, c.omega})));
}

/// Throws io::NumericalFailure for a clump that turns too far in one step.
void World::throw_turns_too_far() const
{
    const std::vector<Clump> all = clumps();
    const auto fastest = std::max_element(all.begin(), all.end(), [](const Clump& a, const Clump& b) {
        return a.omega.norm() < b.omega.norm();
    });
    std::ostringstream text;
    text.precision(9);
    text << "the " << clump_name(fastest->id) << " turns by " << options.h * fastest->omega.norm()
         << " rad in one step, more than the integration allows, at t = " << time << " s; reduce the step";
    throw io::NumericalFailure("rotation_too_large", text.str());
}

void World::transfer_clumps(io::Archive& a)
{
    if (templates.empty() && !a.reads()) {
        std::size_t none_of_them = 0;
        return a.count(none_of_them, sizeof(ClumpBody));
    }
    par::Array<par::Cpu, ClumpBody>& all = engine->arrays().clump;
    const Particles<par::Cpu>& p = engine->arrays().particle;
    a.list(all);
    if (!a.reads()) return;
    std::vector<std::uint32_t> ids(p.id.data(), p.id.data() + p.count);
    std::sort(ids.begin(), ids.end());
    std::uint32_t next = 0;  // the lowest id of the next clump
    const auto is_valid = [&](const ClumpBody& b) {
        if (b.shape >= templates.size() || b.first_id < next) return false;
        const std::uint32_t count = clump_tables.shape[b.shape].count;
        const auto first = std::lower_bound(ids.begin(), ids.end(), b.first_id);
        if (ids.end() - first < count || *first != b.first_id || first[count - 1] != b.first_id + count - 1)
            return false;
        next = b.first_id + count;
        const double length = b.p.e0 * b.p.e0 + b.p.e.dot(b.p.e);
        return finite(b.velocity) && finite(b.momentum) && finite(b.omega_before) && finite(b.acc) &&
               finite(b.alpha) && b.velocity.w > 0 && b.momentum.w > 0 && b.scale > 0 &&
               std::isfinite(b.scale) && std::abs(length - 1) < 1e-6 && b.replica < domain.replicas &&
               granular::finite(with_error(b.velocity, b.compensation.v)) &&
               granular::finite(with_error(b.momentum, b.compensation.omega)) &&
               is_near_domain(domain.grid, b.position);
    };
    a.check_each(all, "invalid state of a clump", is_valid, [](const ClumpBody& b) {
        return "that of particle " + std::to_string(b.first_id) + ", shape " + std::to_string(b.shape) +
               ", v " + shown(b.velocity) + ", w " + shown(b.momentum);
    });
    update_clump_tables();
}

}  // namespace hilda::granular
