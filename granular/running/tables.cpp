// SPDX-License-Identifier: GPL-3.0-or-later
/// particles.csv, clumps.csv of a case with clumps, and with --contacts contacts.csv: the particles, clumps
/// and contacts at the end of the run.

#include "granular/running/sink.hpp"
#include "granular/world/output.hpp"
#include "io/files.hpp"

#include <limits>

namespace hilda::granular {

namespace {

class Tables final : public Sink {
public:
    explicit Tables(const CaseSetup& run)
        : c(run.c), world(*run.c.world), directory(run.directory),
          with_contacts(run.options.contains("--contacts"))
    {}

    long interval() const override { return std::numeric_limits<long>::max(); }
    void node(const World&) override {}
    void close() override
    {
        io::write_file(directory + "/particles.csv",
                       [&](const io::Append& append) { particles_csv(world, append, c.groups.get()); });
        if (has_clumps())
            io::write_file(directory + "/clumps.csv",
                           [&](const io::Append& append) { clumps_csv(world, append); });
        if (with_contacts)
            io::write_file(directory + "/contacts.csv",
                           [&](const io::Append& append) { contacts_csv(world, append); });
    }
    std::vector<std::string> files() const override
    {
        std::vector<std::string> all = {"particles.csv"};
        if (has_clumps()) all.emplace_back("clumps.csv");
        if (with_contacts) all.emplace_back("contacts.csv");
        return all;
    }

private:
    bool has_clumps() const { return !world.clump_templates().empty(); }

    const Case& c;
    const World& world;
    const std::string& directory;
    const bool with_contacts;
};

const bool registered_tables = io::Registry<SinkType>::add(
    {.name = "tables",
     .options = {{.name = "--contacts",
                  .help = "write contacts.csv as well: all contacts at the end of the run"}},
     .make = [](const CaseSetup& run) -> std::unique_ptr<Sink> { return std::make_unique<Tables>(run); },
     .files = {"particles.csv", "clumps.csv", "contacts.csv"}});

}  // namespace

}  // namespace hilda::granular
