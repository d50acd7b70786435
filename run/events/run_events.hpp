// SPDX-License-Identifier: GPL-3.0-or-later
/// The events of a model file during a run: table events, and the end of the run.

#pragma once

#include "dae/model_file.hpp"
#include "lie/events.hpp"
#include "lie/trajectory.hpp"
#include "run/columns/output_columns.hpp"
#include "run/tables/run_table.hpp"

#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hilda::lie {
struct Scheme;
}

namespace hilda::run {

/// What a run reports about an event of the model file
struct EventCount {
    std::string name;
    long count = 0;
    double last = 0;  ///< time of the last one [s]
};

/// Thrown by RunEvents::accepted(): an event with the action stop was found before this node.
struct StoppedByEvent : std::exception {
    StoppedByEvent(std::string event, lie::State x) : event(std::move(event)), x(std::move(x)) {}
    const char* what() const noexcept override { return "stopped by an event"; }

    std::string event;
    lie::State x;  ///< at the event
};

/// The outputs of a model and, after them, the formulas of its events, which may use their columns
std::vector<const dae::Output*> outputs_and_events(const dae::Description& description);

/// Why a run has no events; empty if it can have them
std::string why_no_events(const lie::Scheme& scheme, const lie::Integrator& integrator);

/// Writes a row of the table events at each event. It observes the nodes of a run before its sinks, so that
/// these receive no node after the end.
class RunEvents final : public lie::Observer {
public:
    /// `make`: see lie::EventSearch. lie::InvalidInput for an invalid formula. Writes no file. The
    /// description must outlive this object.
    RunEvents(const dae::Description& description, lie::EventSearch::Make make, RunTables& tables);

    /// Creates the table, or continues it from the result of save().
    void open(const std::string& saved, const std::string& file);
    bool is_open() const { return opened; }
    /// Synchronises the table with the disk and returns what a resumed run needs.
    std::string save();
    /// Throws StoppedByEvent.
    void accepted(const lie::State& node, long n, int iterations) override;
    void close() { table->close(); }

    std::vector<std::string> files() const { return table->files(); }
    const std::vector<EventCount>& counts() const { return counted; }
    /// Place and fault of an event whose formula was not finite at any node; empty if there is none
    std::string fault() const;
    /// One for each event whose formula was not a number at some nodes
    std::vector<std::string> warnings() const;

private:
    std::vector<lie::Event> functions();
    void transfer(io::Archive& a);
    void add_row(const lie::EventFound& found);

    const dae::Description& description;
    OutputColumns formulas;      ///< the outputs of the model, then the events
    std::vector<double> values;  ///< of `formulas`
    lie::EventSearch search;
    std::unique_ptr<ColumnGroup> bodies;
    std::unique_ptr<RunTable> table;
    std::vector<double> row;
    std::vector<EventCount> counted;
    bool opened = false;
};

}  // namespace hilda::run
