// SPDX-License-Identifier: GPL-3.0-or-later
/// run.csv: energy, contacts, stress and the loads on the boundaries over time.

#include "granular/program/sink.hpp"
#include "io/message.hpp"

namespace hilda::granular {

namespace {

class Rows final : public io::RowsSink<World> {
public:
    explicit Rows(const CaseSetup& run)
        : RowsSink(run.directory, "run.csv"), c(run.c), steps(run.steps_in(c.interval))
    {}

    long interval() const override { return steps; }

private:
    std::string header() const override
    {
        std::string names = "t,kinetic_energy,contacts,pairs";
        for (const char a : {'x', 'y', 'z'})
            for (const char b : {'x', 'y', 'z'}) names += std::string(",stress_") + a + b;
        for (const std::string& b : c.boundaries)
            for (const char* of : {"_Fx", "_Fy", "_Fz", "_Tx", "_Ty", "_Tz"}) names += ',' + b + of;
        return names + '\n';
    }

    void append(std::string& text, const World& w) override
    {
        const World::Totals totals = w.totals();
        text +=
            io::formatted("%.12g,%.9g,%zu,%zu", w.t(), w.kinetic_energy(), totals.contacts, w.candidates());
        for (const double part : totals.stress) text += io::formatted(",%.9g", part);
        for (const Wrench& on : totals.on_boundary)
            for (const Vec3& part : {on.F, on.T})
                text += io::formatted(",%.9g,%.9g,%.9g", part.x, part.y, part.z);
        text += '\n';
    }

    const Case& c;
    const long steps;
};

const bool registered = io::Registry<SinkType>::add(
    {.name = "rows",
     .make = [](const CaseSetup& run) -> std::unique_ptr<Sink> { return std::make_unique<Rows>(run); },
     .files = {"run.csv"}});

}  // namespace

}  // namespace hilda::granular
