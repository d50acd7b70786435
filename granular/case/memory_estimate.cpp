// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/memory_estimate.hpp"

#include "granular/fields/field_sums.hpp"

#include <algorithm>
#include <cstdio>

namespace hilda::granular {

// Particles are inserted and outputs are written in pieces, so that the host needs little more than the
// arrays of the world. A table of contacts is sorted in memory; a settled bed has 2.3 contacts per particle.
void check_memory(const io::JsonSource& source, const CaseSize& size, const WorldOptions& o,
                  const std::vector<FillSpec>& fills, const OutputSpecs& outputs,
                  const Environment& available)
{
    double particles = size.particles, largest = size.diameter;
    constexpr double gigabyte = 1e9, of_output = 8, of_contacts = 2 * 2.3 * sizeof(ContactRecord),
                     of_cell = 4;
    double of_fields = 0;  // cells
    for (const FieldSpec& f : outputs.fields) of_fields += static_cast<double>(f.grid.count());
    std::uint16_t replicas = 0;
    double of_clumps = 0;  // bytes: tables by particle and load of each particle, and the bodies
    const auto add_clumps = [&](double many, const PlacedClumps& clumps) {
        constexpr double of_particle = 2 * sizeof(std::uint32_t) + sizeof(Load),
                         of_body = sizeof(ClumpBody) + sizeof(Clump);
        if (clumps) of_clumps += many * (of_particle + of_body / clumps.spheres());
    };
    for (const FillSpec& f : fills) {
        particles += estimated_count(f);
        add_clumps(estimated_count(f), f.clumps);
        largest = std::max(largest, 2 * f.radius);
        replicas = std::max(replicas, f.replica);
    }
    // An inserted particle is in the arrays, and in a copy while others are inserted.
    constexpr double of_copy = 2 * sizeof(Particle);
    const double own = particles;
    double inserted = 0;
    if (size.insertions != nullptr)
        for (const Insertion& i : size.insertions->all) {
            const InsertionSpec& s = i.what();
            const double many = s.largest_count(size.end) * (s.clumps ? s.clumps.spheres() : 1);
            add_clumps(many, s.clumps);
            inserted += many;
        }
    particles += inserted;
    const Vec3 edges = o.high - o.low;
    const double edge = largest * (1 + o.skin),
                 cells = (edges.x / edge + 1) * (edges.y / edge + 1) * (edges.z / edge + 1) * (replicas + 1.);
    const auto in_world = [&](Device::Kind device) {
        return 1e-3 *
                   static_cast<double>(World::bytes_needed(1000, size.rotation_laws, o.orientation, device)) +
               (of_clumps > 0 ? of_clumps / particles : 0);
    };
    const auto check = [&](const char* place, double many, const char* of, double each, std::size_t have,
                           const char* where) {
        if (many * each <= static_cast<double>(have)) return;
        char what[200];
        std::snprintf(what, sizeof what, "%.3g %s need about %.3g GB of memory%s; %.3g GB are available",
                      many, of, many * each / gigabyte, where, static_cast<double>(have) / gigabyte);
        source.fail(place, what);
    };
    const char* const place = inserted > own ? "/insert" : "/fill";
    check(place, particles, "particles",
          in_world(Device::cpu) + of_output + (available.lists_contacts ? of_contacts : 0) +
              (inserted > 0 ? of_copy : 0),
          available.memory, "");
    check(place, particles, "particles", in_world(Device::cuda), available.device_memory, " of the GPU");
    check("/fields", of_fields, "cells", FieldSums::bytes_of_cell(), available.memory, "");
    if (particles > 0)
        check("/domain", cells, "cells", of_cell, std::min(available.memory, available.device_memory), "");
}

}  // namespace hilda::granular
