// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/particles/fill_list.hpp"

#include "io/error.hpp"

namespace hilda::granular {

namespace {

/// Adds the particles of a fill. A message about a particle of a table has its line.
void add_filled(const FillSpec& spec, World& world)
{
    std::size_t number = 0;
    // of their own, so that places and velocities are those of particles
    Random turns(SplitMix::mixed(spec.seed));
    fill(spec, [&](const Particle& p) {
        try {
            spec.clumps ? world.add_clump(spec.clumps.at(p, turns)) : world.add(p);
        } catch (const io::InvalidInput& e) {
            if (spec.file.empty()) throw;
            throw io::InvalidInput(place_in_table(spec.file, number) + ": " + e.what());
        }
        ++number;
    });
}

}  // namespace

void FillList::read(ObjectReader& o, Case& c, EntryKeys& keys, const WorldOptions& options)
{
    const PlacedClumps clumps = read_placed_clumps(o, *c.world);
    FillSpec spec = read_fill(o, clumps ? std::optional(clumps.radius) : std::nullopt);
    spec.clumps = clumps;
    const bool from_csv = !spec.particles.empty();
    if (from_csv && clumps) o.fail("clump", "clump must not be given together with a table");
    if (!clumps)
        spec.material = from_csv && !o.has("material")
                            ? -1
                            : keys.material(o, " With csv it replaces the materials of the table.");
    spec.replica = keys.replica(o);
    spec.attached_to = EntryKeys::attached_to(o, c);
    if (!options.orientation)
        for (Particle& p : spec.particles) p.e = Particle().e;
    const int group = keys.group(o);
    c.notices.insert(c.notices.end(), spec.unknown.begin(), spec.unknown.end());
    c.doubtful.insert(c.doubtful.end(), spec.unknown.begin(), spec.unknown.end());
    if (from_csv) c.files_read += "\n" + o.pointer("file") + ' ' + std::to_string(spec.checksum);
    o.finish();
    groups.push_back(group);
    fills.push_back(std::move(spec));
    places.push_back(o);
}

void FillList::add_to(Case& c, EntryKeys& keys)
{
    double all = 0;
    for (const FillSpec& f : fills) all += estimated_count(f);
    c.world->reserve(static_cast<std::size_t>(all));
    for (std::size_t k = 0; k < fills.size(); ++k) {
        const auto first = static_cast<std::uint32_t>(c.world->count());
        c.entries.emplace_back(first, places[k].pointer());
        keys.groups.add(first, groups[k]);
        places[k].located([&] { add_filled(fills[k], *c.world); });
        if (!fills[k].file.empty()) c.tables[places[k].pointer()] = fills[k].file;
        std::vector<Particle>().swap(fills[k].particles);
    }
}

}  // namespace hilda::granular
