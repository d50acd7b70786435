// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case_file.hpp"

#include "granular/boundary_keys.hpp"
#include "granular/fill.hpp"
#include "granular/text_place.hpp"

#include <algorithm>

namespace hilda::granular {

namespace {

using Json = Keys::Json;

/// Nothing deeper than this is a case, and a key that stands twice is a mistake.
constexpr int deepest = 64;

struct NoJson : std::runtime_error {
    using std::runtime_error::runtime_error;
};

Json parse(const std::string& text)
{
    std::vector<std::set<std::string>> open;
    std::string twice;
    const auto watch = [&](int depth, Json::parse_event_t event, Json& parsed) {
        if (depth > deepest) throw InvalidCase("is nested deeper than " + std::to_string(deepest));
        if (event == Json::parse_event_t::object_start) open.emplace_back();
        if (event == Json::parse_event_t::object_end && !open.empty()) open.pop_back();
        if (event == Json::parse_event_t::key && !open.back().insert(parsed.get<std::string>()).second)
            twice = parsed.get<std::string>();
        return true;
    };
    try {
        Json all = Json::parse(text, watch);
        if (!twice.empty()) throw InvalidCase("the key \"" + twice + "\" stands twice in one object");
        return all;
    } catch (const Json::parse_error& e) {
        throw NoJson(text_place(text, std::max<std::size_t>(e.byte, 1) - 1) + ": is no JSON");
    }
}

template <class Laws>
Laws read_law(Keys& pair, const std::string& kind, const std::string& otherwise, const Material& i,
              const Material& j, bool material_normal)
{
    static const Json none = Json::object();
    const bool given = pair.has(kind);
    Keys own(given ? pair.raw(kind) : none, pair.place_of(kind));
    const std::string name = own.text("law", otherwise);
    LawKeys keys(own, pair, i, j, material_normal);
    Laws law;
    if (!law.read(name, keys)) own.refuse("law", "must be one of " + Laws::names(), name);
    own.end();
    return law;
}

PairLaw read_pair(Keys& pair, const Material& i, const Material& j, std::vector<std::string>& notices)
{
    PairLaw law;
    if (pair.has("restitution") && pair.number("restitution") == 0)
        notices.push_back(pair.place_of("restitution") + ": 0 is taken as 1e-7, whose damping is finite");
    law.normal = read_law<NormalLaws>(pair, "normal", "hertz", i, j, true);
    const bool by_material = law.normal.is<Hertz>();
    law.tangential = read_law<TangentialLaws>(pair, "tangential", "none", i, j, by_material);
    law.rolling = read_law<RollingLaws>(pair, "rolling", "none", i, j, by_material);
    law.spin = read_law<SpinLaws>(pair, "spin", "none", i, j, by_material);
    law.cohesion = read_law<CohesionLaws>(pair, "cohesion", "none", i, j, by_material);
    for (const char* key : {"mu", "mu_s", "restitution"}) pair.has(key);  // may stand there for nobody
    return law;
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

/// Against the memory that there is. A close-packed crystal, with three contacts a particle, takes most when its contacts
/// are written.
void check_memory(double particles, const std::vector<Filling>& fillings, std::size_t memory)
{
    constexpr double gigabyte = 1e9, of_output = 2200;
    for (const Filling& f : fillings) particles += estimate(f);
    const double of_a_particle = of_output + 1e-3 * static_cast<double>(World::bytes_needed(1000));
    if (of_a_particle * particles <= static_cast<double>(memory)) return;
    char what[160];
    std::snprintf(what, sizeof what,
                  "/fill: %.3g particles need about %.3g GB of memory, and there are %.3g GB", particles,
                  of_a_particle * particles / gigabyte, static_cast<double>(memory) / gigabyte);
    throw InvalidCase(what);
}

}  // namespace

Case read_case(const std::string& text, const std::string& file, const Surroundings& surroundings)
{
    try {
        const Json all = parse(text);
        Keys keys(all, "");
        if (keys.count("hilda_case", -1) != 1) throw InvalidCase("/hilda_case: must be 1");
        Case out;
        out.text = text;
        out.name = keys.text("name", "case");
        keys.text("note", "");

        WorldOptions o;
        Keys domain = keys.object("domain");
        o.low = domain.vector("low"), o.high = domain.vector("high");
        o.periodic = domain.flags("periodic", o.periodic);
        domain.end();
        o.device = surroundings.device;
        o.gravity = keys.vector("gravity", {0, 0, -9.81});
        out.h = o.h = keys.positive("step");
        out.end = keys.positive("end");
        out.every = keys.has("every") ? keys.positive("every") : out.end / 100;
        out.anew = keys.has("checkpoint_every") ? keys.positive("checkpoint_every") : out.every;
        o.skin = keys.number("skin", o.skin);
        o.scheme = read_scheme(keys);

        std::vector<Material> materials;
        for (const auto& [object, place] : keys.list("materials")) {
            Keys m(*object, place);
            materials.push_back({.name = m.text("name"),
                                 .density = m.number("density"),
                                 .E = m.number("E"),
                                 .nu = m.number("nu")});
            m.end();
        }
        if (materials.empty()) throw InvalidCase("/materials: must name at least one");
        const auto material = [&](Keys& k, const std::string& key) {
            const std::string name = k.text(key, materials.size() == 1 ? materials[0].name : "");
            for (std::size_t n = 0; n < materials.size(); ++n)
                if (materials[n].name == name) return static_cast<int>(n);
            k.refuse(key, "no material has this name", name);
        };
        out.world = std::make_unique<World>(o, materials);
        for (const auto& [object, place] : keys.list("laws")) {
            Keys pair(*object, place);
            int of[2] = {0, 0};
            if (materials.size() > 1 || pair.has("between")) {
                const Json& names = pair.raw("between");
                if (!names.is_array() || names.size() != 2)
                    pair.refuse("between", "must be two names", names);
                for (int k = 0; k < 2; ++k) {
                    const auto found =
                        std::find_if(materials.begin(), materials.end(), [&](const Material& m) {
                            return names[k].is_string() && m.name == names[k].get<std::string>();
                        });
                    if (found == materials.end())
                        pair.refuse("between/" + std::to_string(k), "no material has this name", names[k]);
                    of[k] = static_cast<int>(found - materials.begin());
                }
            }
            out.world->set_law(of[0], of[1],
                               read_pair(pair, materials[of[0]], materials[of[1]], out.notices));
            pair.end();
        }
        std::vector<Motion> motions;
        for (const auto& [object, place] : keys.list("boundaries")) {
            Keys b(*object, place);
            const int made_of = material(b, "material");
            for (NamedBoundary& n :
                 read_boundary(b, b.text("name", "boundary " + std::to_string(out.boundaries.size())),
                               surroundings.compile)) {
                n.boundary.material = made_of;
                n.motion.boundary = out.world->add(n.boundary);
                if (n.motion.moves()) motions.push_back(n.motion);
                out.boundaries.push_back(n.name);
            }
            b.end();
        }
        for (const auto& [object, place] : keys.list("particles")) {
            Keys p(*object, place);
            const std::uint32_t id = out.world->add({.r = p.vector("r"),
                                                     .radius = p.positive("radius"),
                                                     .material = material(p, "material"),
                                                     .v = p.vector("v", {0, 0, 0}),
                                                     .omega = p.vector("omega", {0, 0, 0}),
                                                     .fixed = p.flag("fixed"),
                                                     .replica = read_replica(p)});
            if (p.has("force")) out.world->set_force(id, p.vector("force"));
            p.end();
        }
        std::vector<Filling> fillings;
        for (const auto& [object, place] : keys.list("fill")) {
            Keys f(*object, place);
            fillings.push_back(read_filling(f));
            fillings.back().material = material(f, "material");
            fillings.back().replica = read_replica(f);
            f.end();
        }
        keys.end();
        check_memory(static_cast<double>(out.world->count()), fillings, surroundings.memory);
        for (const Filling& f : fillings)
            for (const Particle& p : fill(f)) out.world->add(p);
        if (!motions.empty()) {
            try {
                drive(*out.world, motions, out.h);
            } catch (const NotFinite& e) {
                throw InvalidCase(e.what());
            }
            out.world->before_each_step([motions, h = out.h](World& w) { drive(w, motions, h); });
        }
        return out;
    } catch (const NoJson& e) {
        throw InvalidCase(file + ':' + e.what());
    } catch (const InvalidCase& e) {
        const std::string what = e.what();
        if (what[0] != '/') throw InvalidCase(file + ": " + what);
        const std::string pointer = what.substr(0, what.find(": "));
        throw InvalidCase(file + ':' + text_place(text, pointer) + " (" + pointer + ')' +
                          what.substr(pointer.size()));
    } catch (const Json::exception& e) {  // a number beyond all numbers, say
        throw InvalidCase(file + ": " + e.what());
    }
}

}  // namespace hilda::granular
