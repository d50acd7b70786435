// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/recording/simulation_record.hpp"

#include "contact/compliant/compliant_force.hpp"
#include "io/archive.hpp"

#include <algorithm>

namespace hilda::run {

namespace {

void transfer(io::Archive& a, contact::ContactEvent& e)
{
    using Type = contact::ContactEvent::Type;
    auto type = static_cast<int>(e.type);
    a.value(type);
    a.check(type >= 0 && type <= static_cast<int>(Type::fallback_active), "unknown type of contact event");
    e.type = static_cast<Type>(type);
    a.value(e.t), a.value(e.contact), a.value(e.speed);
}

}  // namespace

void transfer_state(io::Archive& a, lie::State& x)
{
    static_assert(sizeof(lie::ConeForce) == 5 * sizeof(double), "a ConeForce must not have padding");
    static_assert(sizeof(lie::Motion) == 24 * sizeof(double),
                  "a motion must consist of 24 numbers without padding");
    a.value(x.t);
    a.list(x.body), a.list(x.alpha), a.list(x.lambda);
    a.list(x.discrete_state), a.list(x.internal_state), a.list(x.history), a.list(x.applied_loads),
        a.list(x.cone_forces);
}

void transfer(io::Archive& a, SimulationRecord& r)
{
    transfer_state(a, r.node);
    a.value(r.number), a.value(r.iterations);
    transfer_state(a, r.pivots);
    a.value(r.statistics);
    transfer(a, r.watch);
    constexpr size_t bytes_of_event = 2 * sizeof(int) + 2 * sizeof(double);
    size_t events = r.contacts.events.size();
    a.count(events, bytes_of_event);
    r.contacts.events.resize(events);
    for (contact::ContactEvent& e : r.contacts.events) transfer(a, e);
    a.list(r.contacts.node_forces);
    a.list(r.events);
}

void check_fits(const SimulationRecord& r, const dae::Model& model, const lie::State& x,
                const std::string& file)
{
    const auto check = [&](bool fits, const char* what) {
        if (!fits) throw io::IoError(file + ": the checkpoint does not fit the model: " + what);
    };
    const auto same_lengths = [&](const lie::State& a) {
        return a.body.size() == x.body.size() && a.alpha.size() == x.alpha.size() &&
               a.lambda.size() == x.lambda.size() && model.fits(a) &&
               (a.applied_loads.empty() || a.applied_loads.size() == 6 * a.body.size());
    };
    const size_t constraints = model.general_constraints().size();
    check(same_lengths(r.node), "wrong length of the state");
    check(r.pivots.body.empty() || same_lengths(r.pivots), "wrong length of the state of the pivots");
    check(r.number >= 0 && r.iterations >= 0, "negative number of the node");
    const auto compliant = std::count_if(model.forces().begin(), model.forces().end(), [](const auto& force) {
        return dynamic_cast<const contact::CompliantForce*>(force.get()) != nullptr;
    });
    const auto in = [](const Extreme& e, size_t count) {
        return e.place >= -1 && e.place < static_cast<long>(count);
    };
    const size_t forces = model.forces().size() + static_cast<size_t>(model.near_forces().numbers());
    check(in(r.watch.turn, x.body.size()) && in(r.watch.motion, x.body.size()) &&
              in(r.watch.overlap, forces) && in(r.watch.unstable, forces) &&
              static_cast<long>(r.watch.deepest.size()) == compliant,
          "unknown body or force");
    for (const contact::ContactEvent& e : r.contacts.events)
        check(e.contact >= 0 && static_cast<size_t>(e.contact) < constraints, "unknown contact of an event");
}

}  // namespace hilda::run
