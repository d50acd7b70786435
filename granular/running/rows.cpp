// SPDX-License-Identifier: GPL-3.0-or-later
/// run.csv: energies, momentum, contacts, mass flow, stress, the loads on the boundaries and the motion of
/// those that move.

#include "granular/running/sink.hpp"
#include "granular/stages/stages.hpp"
#include "io/message.hpp"

#include <cmath>

namespace hilda::granular {

namespace {

class Rows final : public io::RowsSink<World> {
public:
    explicit Rows(const CaseSetup& run)
        : RowsSink(run.directory, "run.csv"), c(run.c), steps(run.steps_in(c.interval))
    {}

    long interval() const override { return steps; }
    void transfer(io::Archive& a) override
    {
        RowsSink::transfer(a);
        a.value(last);
        a.check(std::isfinite(last.t) && std::isfinite(last.inserted) && std::isfinite(last.removed),
                "the numbers of the last row must be finite, got " +
                    io::formatted("t = %g, %g kg, %g kg", last.t, last.inserted, last.removed));
    }

private:
    /// Time and masses of the last row, for the mass flow of the next one
    struct Flow {
        double t = 0, inserted = 0, removed = 0;  // [s, kg, kg]
    };

    std::string header() const override
    {
        std::string names =
            "t,kinetic_energy,contacts,pairs,particles,rotational_energy,potential_energy,"
            "momentum_x,momentum_y,momentum_z";
        if (c.insertions != nullptr) names += ",inserted,inserted_mass,inserted_mass_rate,due_mass";
        if (c.world->removes()) names += ",removed,removed_mass,removed_mass_rate";
        for (const char a : {'x', 'y', 'z'})
            for (const char b : {'x', 'y', 'z'}) names += std::string(",stress_") + a + b;
        for (const std::string& b : c.boundaries)
            for (const char* of : {"_Fx", "_Fy", "_Fz", "_Tx", "_Ty", "_Tz"}) names += ',' + b + of;
        for (const int b : c.moving) {
            const auto add = [&](std::initializer_list<const char*> columns) {
                for (const char* of : columns) names += ',' + c.boundaries[static_cast<std::size_t>(b)] + of;
            };
            add({"_x", "_y", "_z", "_vx", "_vy", "_vz", "_wx", "_wy", "_wz"});
            if (has_orientation(c.world->all_boundaries()[static_cast<std::size_t>(b)]))
                add({"_e0", "_e1", "_e2", "_e3"});
        }
        if (c.stages != nullptr) names += ",stage";
        return names + '\n';
    }

    void append(std::string& text, const World& w) override
    {
        const World::Totals totals = w.totals();
        w.check_loads(totals);
        const World::Sums sums = w.sums();
        text += io::formatted("%.12g,%.9g,%zu,%zu,%zu,%.9g,%.9g", w.t(), sums.kinetic_energy, totals.contacts,
                              w.candidates(), w.count(), sums.rotational_energy, sums.potential_energy);
        append(text, sums.momentum);
        append_flow(text, w);
        for (const double part : totals.stress) text += io::formatted(",%.9g", part);
        for (const Wrench& on : totals.on_boundary)
            for (const Vec3& part : {on.F, on.T}) append(text, part);
        for (const int b : c.moving) {
            const Boundary& moving = w.all_boundaries()[static_cast<std::size_t>(b)];
            append(text, moving.r), append(text, moving.v), append(text, moving.omega);
            if (!has_orientation(moving)) continue;
            text += io::formatted(",%.9g", moving.p.e0);
            append(text, moving.p.e);
        }
        if (c.stages != nullptr) text += ',' + std::to_string(c.stages->number());
        text += '\n';
    }

    /// Whether Euler parameters are integrated for a moving boundary
    static bool has_orientation(const Boundary& b) { return b.shape == Boundary::Shape::mesh || b.mass > 0; }

    /// Number, mass and mass flow since the last row of the inserted and removed particles, and the due mass
    void append_flow(std::string& text, const World& w)
    {
        const Flow now{w.t(), c.insertions != nullptr ? c.insertions->mass() : 0, w.outflow().mass};
        const auto add = [&](std::int64_t count, double mass, double before) {
            const double rate = now.t > last.t ? (mass - before) / (now.t - last.t) : 0;
            text += io::formatted(",%lld,%.9g,%.9g", static_cast<long long>(count), mass, rate);
        };
        if (c.insertions != nullptr) {
            add(c.insertions->count(), now.inserted, last.inserted);
            text += io::formatted(",%.9g", c.insertions->due_mass(now.t));
        }
        if (w.removes()) add(w.outflow().count, now.removed, last.removed);
        last = now;
    }

    static void append(std::string& text, const Vec3& a)
    {
        text += io::formatted(",%.9g,%.9g,%.9g", a.x, a.y, a.z);
    }

    const Case& c;
    const long steps;
    Flow last;
};

const bool registered_rows = io::Registry<SinkType>::add(
    {.name = "rows",
     .make = [](const CaseSetup& run) -> std::unique_ptr<Sink> { return std::make_unique<Rows>(run); },
     .files = {"run.csv"}});

}  // namespace

}  // namespace hilda::granular
