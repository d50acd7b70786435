// SPDX-License-Identifier: GPL-3.0-or-later
/// particles.csv and contacts.csv: the particles and contacts at the end of the run.

#include "granular/program/sink.hpp"
#include "granular/world/output.hpp"
#include "io/files.hpp"

#include <limits>

namespace hilda::granular {

namespace {

class Tables final : public Sink {
public:
    explicit Tables(const CaseSetup& run) : world(*run.c.world), directory(run.directory) {}

    long interval() const override { return std::numeric_limits<long>::max(); }
    void node(const World&) override {}
    void close() override
    {
        io::write_file(directory + "/particles.csv", particles_csv(world));
        io::write_file(directory + "/contacts.csv", contacts_csv(world));
    }
    std::vector<std::string> files() const override { return {"particles.csv", "contacts.csv"}; }

private:
    const World& world;
    const std::string& directory;
};

const bool registered = io::Registry<SinkType>::add(
    {.name = "tables",
     .make = [](const CaseSetup& run) -> std::unique_ptr<Sink> { return std::make_unique<Tables>(run); },
     .files = {"particles.csv", "contacts.csv"}});

}  // namespace

}  // namespace hilda::granular
