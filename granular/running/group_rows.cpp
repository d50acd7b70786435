// SPDX-License-Identifier: GPL-3.0-or-later
/// groups.csv: number, mass, energy, momentum and centre of mass of each group of particles.

#include "granular/running/sink.hpp"
#include "io/message.hpp"

namespace hilda::granular {

namespace {

class GroupRows final : public io::RowsSink<World> {
public:
    explicit GroupRows(const CaseSetup& run)
        : RowsSink(run.directory, "groups.csv"), c(run.c), steps(run.steps_in(c.interval))
    {}

    long interval() const override { return steps; }

private:
    struct Sums {
        std::size_t particles = 0;
        double mass = 0;  // [kg]
        World::Sums of;
        Vec3 moment = {0, 0, 0};  // Σ m r [kg m]
    };

    std::string header() const override
    {
        return "t,group,name,particles,mass,kinetic_energy,momentum_x,momentum_y,momentum_z,x,y,z\n";
    }

    void append(std::string& text, const World& w) override
    {
        std::vector<Sums> all(c.groups->names.size());
        w.each_particle([&](const Particle& p) {
            const int group = c.groups->of(p.id);
            if (group == Groups::none) return;
            Sums& sums = all[static_cast<std::size_t>(group)];
            ++sums.particles;
            if (p.clump >= 0) return;  // below
            sums.of.add(p, w.gravity());
            if (p.fixed) return;
            sums.mass += p.mass, sums.moment += p.mass * p.r;
        });
        for (const Clump& clump : w.clumps()) {
            const int group = c.groups->of(clump.id);
            if (group == Groups::none) continue;
            Sums& sums = all[static_cast<std::size_t>(group)];
            sums.of.kinetic_energy += 0.5 * (clump.mass * clump.v.dot(clump.v) + clump.L.dot(clump.omega));
            sums.of.momentum += clump.mass * clump.v;
            sums.mass += clump.mass, sums.moment += clump.mass * clump.r;
        }
        for (std::size_t k = 0; k < all.size(); ++k) {
            const Sums& sums = all[k];
            text += io::formatted("%.12g,%zu,%s,%zu,%.9g,%.9g", w.t(), k, c.groups->names[k].c_str(),
                                  sums.particles, sums.mass, sums.of.kinetic_energy);
            append(text, sums.of.momentum);
            append(text, sums.mass > 0 ? (1 / sums.mass) * sums.moment : Vec3{0, 0, 0});
            text += '\n';
        }
    }

    static void append(std::string& text, const Vec3& a)
    {
        text += io::formatted(",%.9g,%.9g,%.9g", a.x, a.y, a.z);
    }

    const Case& c;
    const long steps;
};

const bool registered_group_rows =
    io::Registry<SinkType>::add({.name = "group_rows",
                                 .make = [](const CaseSetup& run) -> std::unique_ptr<Sink> {
                                     if (run.c.groups == nullptr) return nullptr;
                                     return std::make_unique<GroupRows>(run);
                                 },
                                 .files = {"groups.csv"}});

}  // namespace

}  // namespace hilda::granular
