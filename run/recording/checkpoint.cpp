// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/recording/checkpoint.hpp"

#include "io/archive.hpp"

#include <algorithm>

namespace hilda::run {

namespace {

constexpr io::Archive::Format format = {.letters = "HILDACKP", .version = 11};

void transfer(io::Archive& a, contact::ContactEvent& e)
{
    using Type = contact::ContactEvent::Type;
    auto type = static_cast<int>(e.type);
    a.value(type);
    a.check(type >= 0 && type <= static_cast<int>(Type::fallback_active), "unknown type of contact event");
    e.type = static_cast<Type>(type);
    a.value(e.t), a.value(e.contact), a.value(e.speed);
}

/// Writes or reads the content of a checkpoint
void transfer(io::Archive& a, Checkpoint& c)
{
    a.map(c.settings);
    a.value(c.end), a.value(c.interval);
    a.check(c.end >= 0 && c.interval > 0, "invalid end or interval of the rows");
    transfer_state(a, c.node);
    a.value(c.number), a.value(c.iterations);
    transfer_state(a, c.pivots);
    a.value(c.statistics);
    Invariants& i = c.invariants;
    a.value(i.nodes), a.value(i.rows), a.value(i.energy_start), a.value(i.energy_end),
        a.value(i.energy_drift);
    a.value(i.constraint_norm), a.value(i.orthogonality), a.list(i.contact);
    transfer(a, c.watch);
    constexpr size_t bytes_of_event = 2 * sizeof(int) + 2 * sizeof(double);
    size_t events = c.contacts.events.size();
    a.count(events, bytes_of_event);
    c.contacts.events.resize(events);
    for (contact::ContactEvent& e : c.contacts.events) transfer(a, e);
    a.list(c.contacts.node_forces);
    a.value(c.last_step), a.map(c.sinks), a.value(c.wall_seconds);
}

}  // namespace

void transfer_state(io::Archive& a, lie::State& x)
{
    static_assert(sizeof(lie::Motion) == 24 * sizeof(double),
                  "a motion must consist of 24 numbers without padding");
    a.value(x.t);
    a.list(x.body), a.list(x.alpha), a.list(x.lambda);
    a.list(x.discrete_state), a.list(x.internal_state), a.list(x.history);
}

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
    const auto check = [&](bool fits, const char* what) {
        if (!fits) throw io::IoError(file + ": the checkpoint does not fit the model: " + what);
    };
    const auto same_lengths = [&](const lie::State& a) {
        return a.body.size() == x.body.size() && a.alpha.size() == x.alpha.size() &&
               a.lambda.size() == x.lambda.size() && a.discrete_state.size() == x.discrete_state.size() &&
               a.internal_state.size() == x.internal_state.size();
    };
    const size_t constraints = model.general_constraints().size();
    check(same_lengths(c.node), "wrong length of the state");
    check(c.pivots.body.empty() || same_lengths(c.pivots), "wrong length of the state of the pivots");
    check(c.number >= 0 && c.iterations >= 0, "negative number of the node");
    check(c.invariants.contact.empty() || c.invariants.contact.size() == evolving_contacts(model).size(),
          "wrong number of contacts");
    const auto compliant = std::count_if(model.forces().begin(), model.forces().end(), [](const auto& force) {
        return dynamic_cast<const contact::ContactForce*>(force.get()) != nullptr;
    });
    const auto in = [](const Extreme& e, size_t count) {
        return e.place >= -1 && e.place < static_cast<long>(count);
    };
    check(in(c.watch.turn, x.body.size()) && in(c.watch.overlap, model.forces().size()) &&
              in(c.watch.unstable, model.forces().size()) &&
              static_cast<long>(c.watch.deepest.size()) == compliant,
          "unknown body or force");
    for (const contact::ContactEvent& e : c.contacts.events)
        check(e.contact >= 0 && static_cast<size_t>(e.contact) < constraints, "unknown contact of an event");
}

}  // namespace hilda::run
