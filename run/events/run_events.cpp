// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/events/run_events.hpp"

#include "contact/evolving/unilateral.hpp"
#include "io/archive.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "run/recording/simulation_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hilda::run {

namespace {

std::unique_ptr<RunTable> table_of(const ColumnGroup& bodies, RunTables& tables)
{
    std::vector<TableColumn> columns = {
        {{"t", "s", "time"}},
        {{"event", "", "number of the event in the list of the model file, from 0"}, true},
        {{"direction", "", "1: the formula rises, -1: it falls"}, true}};
    for (const dae::Quantity& q : bodies.columns) columns.push_back({q});
    return tables.table("events", columns);
}

}  // namespace

std::vector<const dae::Output*> outputs_and_events(const dae::Description& d)
{
    std::vector<const dae::Output*> all;
    for (const auto& output : d.outputs) all.push_back(output.get());
    for (const dae::Event& event : d.events) all.push_back(event.value.get());
    return all;
}

std::string why_no_events(const lie::Scheme& scheme, const lie::Integrator& integrator)
{
    if (!scheme.resumes)
        return scheme.name + " stores past steps outside the state; events need another integrator";
    if (dynamic_cast<const contact::UnilateralStep*>(&integrator) != nullptr)
        return "a model with unilateral contacts as constraints has no events";
    return {};
}

RunEvents::RunEvents(const dae::Description& description, lie::EventSearch::Make make, RunTables& tables)
    : description(description), formulas(*description.model, outputs_and_events(description)),
      values(formulas.columns.size()),
      search(functions(), std::move(make),
             [this](const lie::State& x, std::vector<double>& g) {
                 formulas.values(x, values.data());
                 std::copy(values.end() - static_cast<std::ptrdiff_t>(g.size()), values.end(), g.begin());
             }),
      bodies(body_columns(*description.model)), table(table_of(*bodies, tables)),
      row(3 + bodies->columns.size())
{
    for (const dae::Event& event : description.events) counted.push_back({.name = event.value->name});
}

/// The functions of the events, which may use the outputs
std::vector<lie::Event> RunEvents::functions()
{
    std::vector<lie::Event> all;
    const size_t outputs = description.outputs.size();
    for (const dae::Event& event : description.events)
        all.push_back({.name = event.value->name,
                       .value = [this, k = outputs + all.size(),
                                 outputs](const lie::State& x) { return formulas.expression(x, k, outputs); },
                       .direction = event.direction,
                       .stops = event.stops});
    return all;
}

void RunEvents::open(const std::string& saved, const std::string& file)
{
    opened = true;
    if (saved.empty()) return table->open();
    io::Archive a(saved, file);
    transfer(a);
    a.end();
}

std::string RunEvents::save()
{
    table->sync();
    io::Archive a;
    transfer(a);
    return a.bytes();
}

void RunEvents::transfer(io::Archive& a)
{
    transfer_state(a, search.saved.node);
    a.list(search.saved.sign);
    a.list(search.saved.undefined);
    a.check(search.saved.sign.size() == counted.size() && search.saved.undefined.size() == counted.size(),
            "wrong number of events");
    for (EventCount& event : counted) a.value(event.count), a.value(event.last);
    table->transfer(a);
}

void RunEvents::accepted(const lie::State& node, long, int)
{
    if (search.node(node, [this](const lie::EventFound& found) { add_row(found); }))
        throw StoppedByEvent{counted[search.stopping()].name, search.stopped()};
}

void RunEvents::add_row(const lie::EventFound& found)
{
    EventCount& event = counted[found.event];
    ++event.count, event.last = found.x.t;
    row[0] = found.x.t, row[1] = static_cast<double>(found.event), row[2] = found.rises ? 1 : -1;
    bodies->values(found.x, row.data() + 3);
    table->row(row);
}

std::string RunEvents::fault() const
{
    for (size_t k = 0; k < counted.size(); ++k)
        if (!search.was_finite(k))
            return description.events[k].value->place + ": the formula of the event '" + counted[k].name +
                   "' is not finite at any node of the run";
    return {};
}

std::vector<std::string> RunEvents::warnings() const
{
    std::vector<std::string> all;
    for (size_t k = 0; k < counted.size(); ++k)
        if (!std::isnan(search.saved.undefined[k]))
            all.push_back(
                fmt::format("{}: the formula of the event '{}' is not a number at t = {:.6g} s; an event "
                            "where it is not is not found",
                            description.events[k].value->place, counted[k].name, search.saved.undefined[k]));
    return all;
}

}  // namespace hilda::run
