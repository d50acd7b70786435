// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/case_file.hpp"

#include "granular/case/boundary_keys.hpp"
#include "granular/case/fill.hpp"
#include "granular/case/pair_keys.hpp"
#include "io/error.hpp"

#include <algorithm>

namespace hilda::granular {

namespace {

using Json = Keys::Json;

/// Calls f and prefixes the message of an io::InvalidInput with the JSON pointer of the entry.
template <class F>
auto with_place(const std::string& place, const F& f)
{
    try {
        return f();
    } catch (const io::InvalidInput& e) {
        throw io::InvalidInput(place + ": " + e.what());
    }
}

Scheme read_scheme(Keys& keys)
{
    const std::pair<const char*, Scheme> all[] = {{"symplectic-euler", Scheme::symplectic_euler},
                                                  {"velocity-verlet", Scheme::velocity_verlet},
                                                  {"forward-euler", Scheme::forward_euler},
                                                  {"extended-taylor", Scheme::extended_taylor},
                                                  {"chung", Scheme::chung}};
    const std::string name = keys.text("integrator", all[0].first);
    std::string names;
    for (const auto& [known, scheme] : all) {
        if (name == known) return scheme;
        names += (names.empty() ? "" : ", ") + std::string(known);
    }
    keys.refuse("integrator", "must be one of " + names, name);
}

std::uint16_t read_replica(Keys& keys)
{
    const long replica = keys.count("replica", 0);
    if (replica > 0xffff) keys.refuse("replica", "must be below 65536", replica);
    return static_cast<std::uint16_t>(replica);
}

Material read_material(Keys& m)
{
    Material material{
        .name = m.text("name"), .density = m.positive("density"), .E = m.positive("E"), .nu = m.number("nu")};
    if (!(material.nu > -1 && material.nu < 0.5)) m.refuse("nu", "must be between -1 and 0.5", material.nu);
    m.end();
    return material;
}

void read_domain(Keys domain, WorldOptions& o)
{
    o.low = domain.vector("low"), o.high = domain.vector("high");
    for (const auto& [low, high, axis] :
         {std::tuple{o.low.x, o.high.x, 0}, {o.low.y, o.high.y, 1}, {o.low.z, o.high.z, 2}})
        if (!(low < high)) domain.refuse("high/" + std::to_string(axis), "must be above the low end", high);
    o.periodic = domain.flags("periodic", o.periodic);
    domain.end();
}

/// Compares an estimate of the required memory with the available memory. Throws io::InvalidInput.
///
/// The peak occurs while contacts.csv is written. It was measured on a close-packed crystal with six contacts
/// per particle and rolling and spin laws: 3460 bytes per particle.
void check_memory(double particles, double largest, const WorldOptions& o, const std::vector<FillSpec>& fills,
                  const Environment& available)
{
    constexpr double gigabyte = 1e9, of_output = 2560, of_cell = 4;
    std::uint16_t replicas = 0;
    for (const FillSpec& f : fills) {
        particles += estimated_count(f);
        largest = std::max(largest, 2 * f.radius);
        replicas = std::max(replicas, f.replica);
    }
    const Vec3 size = o.high - o.low;
    const double edge = largest * (1 + o.skin),
                 cells = (size.x / edge + 1) * (size.y / edge + 1) * (size.z / edge + 1) * (replicas + 1.);
    const double in_world = 1e-3 * static_cast<double>(World::bytes_needed(1000, o.orientation));
    const auto check = [&](const char* place, double many, const char* of, double each, std::size_t have,
                           const char* where) {
        if (many * each <= static_cast<double>(have)) return;
        char what[200];
        std::snprintf(what, sizeof what, "%s: %.3g %s need about %.3g GB of memory%s; %.3g GB are available",
                      place, many, of, many * each / gigabyte, where, static_cast<double>(have) / gigabyte);
        throw io::InvalidInput(what);
    };
    check("/fill", particles, "particles", of_output + in_world, available.memory, "");
    check("/fill", particles, "particles", in_world, available.device_memory, " of the GPU");
    if (particles > 0)
        check("/domain", cells, "cells", of_cell, std::min(available.memory, available.device_memory), "");
}

void seed_fills(Case& c, std::uint64_t seed)
{
    const Json& all = c.source.json();
    const std::size_t fills = all.is_object() && all.contains("fill") ? all.at("fill").size() : 0;
    if (fills == 0) c.notices.emplace_back("--seed has no effect: the case has no fill");
    for (std::size_t k = 0; k < fills; ++k) {
        const Json& one = all.at("fill").at(k);
        if (one.is_object() && one.contains("file")) continue;
        c.source.set({.pointer = "/fill/" + std::to_string(k) + "/seed",
                      .value = std::to_string(seed + k),
                      .origin = "--seed " + std::to_string(seed)});
    }
}

void read(Case& out, const Environment& environment)
{
    Keys keys(out.source.json(), "");
    if (keys.count("hilda_case", -1) != 1) throw io::InvalidInput("/hilda_case: must be 1");
    out.name = keys.text("name", "case");
    keys.text("note", "");

    WorldOptions o;
    read_domain(keys.object("domain"), o);
    o.device = environment.device;
    o.gravity = keys.vector("gravity", {0, 0, -9.81});
    out.h = o.h = keys.positive("step");
    out.end = keys.positive("end");
    if (constexpr double max_steps = 9e15; out.end / out.h > max_steps)
        keys.refuse("end", "must be at most 9e15 steps", out.end);
    out.interval = keys.has("interval") ? keys.positive("interval") : out.end / 1000;
    // a whole number of rows, which are a whole number of steps apart
    const double row = out.h * std::max(1., std::round(out.interval / out.h)),
                 long_interval = row * std::max(1., std::round(out.end / 100 / row));
    out.frame_interval = keys.has("frame_interval") ? keys.positive("frame_interval") : long_interval;
    out.checkpoint_interval =
        keys.has("checkpoint_interval") ? keys.positive("checkpoint_interval") : long_interval;
    o.skin = keys.number("skin", o.skin);
    if (!(o.skin > 0 && o.skin <= 1)) keys.refuse("skin", "must be in (0, 1] diameters", o.skin);
    o.scheme = read_scheme(keys);
    o.orientation = keys.flag("orientation");

    std::vector<Material> materials;
    for (const auto& [object, place] : keys.list("materials")) {
        Keys m(*object, place);
        materials.push_back(read_material(m));
    }
    if (materials.empty()) throw io::InvalidInput("/materials: must have at least one entry");
    const auto material = [&](Keys& k, const std::string& key) {
        const std::string name = k.text(key, materials.size() == 1 ? materials[0].name : "");
        for (std::size_t n = 0; n < materials.size(); ++n)
            if (materials[n].name == name) return static_cast<int>(n);
        k.refuse(key, "no material has this name", name);
    };
    out.world = std::make_unique<World>(o, materials);
    for (const auto& entry : keys.list("laws")) {
        Keys pair(*entry.first, entry.second);
        const auto ij = read_between(pair, materials);
        const PairLaw law = read_pair(pair, materials[ij[0]], materials[ij[1]], out.notices);
        with_place(pair.place,
                   [&] { out.world->set_law(static_cast<int>(ij[0]), static_cast<int>(ij[1]), law); });
        pair.end();
    }
    std::vector<std::pair<BoundaryMotion, std::string>> motions;
    std::string free;  // place of the first boundary with a mass
    for (const auto& entry : keys.list("boundaries")) {
        Keys b(*entry.first, entry.second);
        const int boundary_material = material(b, "material");
        const std::string name = b.text("name", "boundary " + std::to_string(out.boundaries.size()));
        if (name.find_first_of(",\"\n\r") != std::string::npos)
            b.refuse("name",
                     "must not contain commas, quotes or line ends, because it is part of column names",
                     name);
        for (NamedBoundary& n : read_boundary(b, name)) {
            if (std::find(out.boundaries.begin(), out.boundaries.end(), n.name) != out.boundaries.end())
                b.refuse("name", "another boundary has this name", n.name);
            n.boundary.material = boundary_material;
            n.motion.boundary = with_place(b.place, [&] { return out.world->add(n.boundary); });
            if (n.motion.is_prescribed()) motions.emplace_back(n.motion, b.place);
            if (n.boundary.mass > 0 && free.empty()) free = b.place;
            out.boundaries.push_back(n.name);
        }
        b.end();
    }
    double largest = 0;
    const auto replica = [&](Keys& k) {
        const std::uint16_t number = read_replica(k);
        if (number > 0 && !free.empty())
            k.refuse("replica", "must be 0 if a boundary has a mass, as " + free + " has", number);
        return number;
    };
    for (const auto& entry : keys.list("particles")) {
        Keys p(*entry.first, entry.second);
        if (p.has("orientation") && !o.orientation)
            p.refuse("orientation", "requires /orientation to be true", p.raw("orientation"));
        const Particle particle{.r = p.vector("r"),
                                .radius = p.positive("radius"),
                                .material = material(p, "material"),
                                .v = p.vector("v", {0, 0, 0}),
                                .omega = p.vector("omega", {0, 0, 0}),
                                .fixed = p.flag("fixed"),
                                .replica = replica(p),
                                .e = p.four("orientation", Particle().e)};
        largest = std::max(largest, 2 * particle.radius);
        const std::uint32_t id = with_place(p.place, [&] { return out.world->add(particle); });
        out.entries.emplace_back(id, p.place);
        if (p.has("force")) {
            const Vec3 F = p.vector("force");
            with_place(p.place, [&] { out.world->set_force(id, F); });
        }
        p.end();
    }
    std::vector<FillSpec> fills;
    for (const auto& entry : keys.list("fill")) {
        Keys f(*entry.first, entry.second);
        fills.push_back(read_fill(f));
        FillSpec& spec = fills.back();
        const bool from_csv = spec.type == FillSpec::Type::csv;
        spec.material = from_csv && !f.has("material") ? -1 : material(f, "material");
        spec.replica = replica(f);
        if (!o.orientation)
            for (Particle& p : spec.particles) p.e = Particle().e;
        if (from_csv) out.files_read += "\n" + f.place_of("file") + ' ' + std::to_string(spec.checksum);
        f.end();
    }
    keys.end();
    check_memory(static_cast<double>(out.world->count()), largest, o, fills, environment);
    for (std::size_t k = 0; k < fills.size(); ++k) {
        const std::string place = "/fill/" + std::to_string(k);
        out.entries.emplace_back(static_cast<std::uint32_t>(out.world->count()), place);
        with_place(place, [&] {
            for (const Particle& p : fill(fills[k])) out.world->add(p);
        });
    }
    if (motions.empty()) return;
    std::vector<BoundaryMotion> all;
    for (const auto& [motion, place] : motions) {
        all.push_back(motion);
        try {
            apply_motions(*out.world, {motion}, out.h);
        } catch (const NotFinite& e) {
            throw io::InvalidInput(place + ": " + e.what());
        }
    }
    out.world->before_each_step([all, h = out.h](World& w) { apply_motions(w, all, h); });
}

}  // namespace

Case read_case(const std::string& text, const std::string& file, const Environment& environment)
{
    Case out{.source = CaseText(text, file)};
    for (const Setting& setting : environment.settings) out.source.set(setting);
    try {
        out.notices = out.source.notices();
        if (environment.seed) seed_fills(out, *environment.seed);
        read(out, environment);
    } catch (const io::InvalidInput& e) {
        throw io::InvalidInput(out.source.with_location(e.what()));
    } catch (const Json::exception& e) {
        throw io::InvalidInput(out.source.with_location(e.what()));
    }
    return out;
}

void insert_particles(const Case& c)
{
    try {
        c.world->step(0);
    } catch (const io::InvalidInput& e) {
        // Messages of the world refer to particles by their ids.
        const std::string what = e.what();
        std::string place;
        unsigned id = 0;
        if (std::sscanf(what.c_str(), "particle %u", &id) == 1) {
            for (const auto& [first, entry] : c.entries)
                if (first <= id) place = entry;
        } else if (what.starts_with("laws: ") || what.starts_with("world: ")) {
            place = "/laws";
        } else if (what.starts_with("domain: ")) {
            place = "/domain";
        }
        throw io::InvalidInput(c.source.with_location(place.empty() ? what : place + ": " + what));
    }
}

}  // namespace hilda::granular
