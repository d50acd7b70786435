// SPDX-License-Identifier: GPL-3.0-or-later
/// replicas.csv: a row of run.csv for each replica.

#include "granular/running/sink.hpp"
#include "io/message.hpp"

namespace hilda::granular {

namespace {

class ReplicaRows final : public io::RowsSink<World> {
public:
    explicit ReplicaRows(const CaseSetup& run)
        : RowsSink(run.directory, "replicas.csv"), c(run.c), steps(run.steps_in(c.interval))
    {}

    long interval() const override { return steps; }

private:
    std::string header() const override
    {
        std::string names = "t,replica,particles,kinetic_energy,momentum_x,momentum_y,momentum_z,contacts";
        for (const std::string& b : c.boundaries)
            for (const char* of : {"_Fx", "_Fy", "_Fz", "_Tx", "_Ty", "_Tz"}) names += ',' + b + of;
        return names + '\n';
    }

    void append(std::string& text, const World& w) override
    {
        std::size_t number = 0;
        for (const World::ReplicaTotals& replica : w.replica_totals()) {
            w.check_loads(replica);
            text += io::formatted("%.12g,%zu,%zu,%.9g", w.t(), number++, replica.particles,
                                  replica.kinetic_energy);
            append(text, replica.momentum);
            text += io::formatted(",%zu", replica.contacts);
            for (const Wrench& on : replica.on_boundary) append(text, on.F), append(text, on.T);
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

const bool registered_replica_rows = io::Registry<SinkType>::add(
    {.name = "replica_rows",
     .options = {{.name = "--replica-rows",
                  .help =
                      "write replicas.csv as well: energy, momentum, contacts and loads on the boundaries "
                      "of each replica"}},
     .make = [](const CaseSetup& run) -> std::unique_ptr<Sink> {
         if (!run.options.contains("--replica-rows")) return nullptr;
         return std::make_unique<ReplicaRows>(run);
     },
     .files = {"replicas.csv"}});

}  // namespace

}  // namespace hilda::granular
