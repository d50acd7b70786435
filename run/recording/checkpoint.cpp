// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/recording/checkpoint.hpp"

#include "io/archive.hpp"

namespace hilda::run {

namespace {

constexpr io::Archive::Format format = {.letters = "HILDACKP", .version = 14};

/// Writes or reads the content of a checkpoint
void transfer(io::Archive& a, Checkpoint& c)
{
    a.map(c.settings);
    a.value(c.end), a.value(c.interval);
    a.check(c.end >= 0 && c.interval > 0, "invalid end or interval of the rows");
    transfer(a, static_cast<SimulationRecord&>(c));
    Invariants& i = c.invariants;
    a.value(i.nodes), a.value(i.rows), a.value(i.energy_start), a.value(i.energy_end),
        a.value(i.energy_drift);
    a.value(i.constraint_norm), a.value(i.orthogonality), a.list(i.contact);
    a.value(c.last_step), a.map(c.sinks), a.value(c.wall_seconds);
}

}  // namespace

std::string to_bytes(Checkpoint checkpoint)
{
    io::Archive a(format);
    transfer(a, checkpoint);
    return a.bytes();
}

Checkpoint from_bytes(const std::string& bytes, const std::string& file)
{
    io::Archive a(format, bytes, file);
    Checkpoint c;
    transfer(a, c);
    a.end();
    return c;
}

void check_fits(const Checkpoint& c, const dae::Model& model, const lie::State& x, const std::string& file)
{
    check_fits(static_cast<const SimulationRecord&>(c), model, x, file);
    if (!c.invariants.contact.empty() && c.invariants.contact.size() != evolving_contacts(model).size())
        throw io::IoError(file + ": the checkpoint does not fit the model: wrong number of contacts");
}

}  // namespace hilda::run
