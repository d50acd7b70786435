// SPDX-License-Identifier: GPL-3.0-or-later
/// A run of a model in Python: the simulation with the objects that it refers to.

#pragma once

#include "lie/schemes.hpp"
#include "python/bindings/events.hpp"
#include "python/bindings/model.hpp"
#include "run/recording/run_settings.hpp"
#include "run/simulation.hpp"

#include <map>
#include <memory>
#include <optional>
#include <string>

namespace hilda::python {

struct RunArguments {
    py::object integrator;  ///< the name of a scheme, or an object of hilda.Integrator
    std::optional<double> end, step, interval;
    std::map<std::string, std::string> settings;  ///< values of run::setting_options(), without the dashes
    bool force;                                   ///< accept a step above the stability limit of a force
    py::object warn;                              ///< called with the text of each warning before the run
};

/// A run, ready for its first step. Its simulation checks the run at construction.
class ModelRun {
public:
    /// `command`: name in messages. Throws io::UsageError and lie::InvalidInput as run::Simulation, and the
    /// exceptions of `warn`.
    ModelRun(const ModelPointer& model, const RunArguments& arguments, const char* command);

    /// What a checkpoint and the run that continues from it have in common: the text of the model and the
    /// names of its functions, the integrator, its settings and the distance of the nodes
    run::RunSettings identity() const;
    /// What the run has found: by its watch, and of its events when it has ended
    std::vector<run::Finding> findings() const;
    /// The warnings before the run, then the findings
    std::vector<std::string> warnings() const;

    const ModelPointer model;
    const dae::Description& description;
    EventTables event_tables;
    std::unique_ptr<run::Simulation> simulation;

    const lie::Scheme& scheme() const { return *used; }

private:
    lie::Scheme own;  ///< of an integrator in Python
    const lie::Scheme* used;
    lie::Settings settings;
};

/// Steps, iterations and factorisations
py::dict counters(const lie::Statistics& of);
/// Names of the events of a model
std::vector<std::string> event_names(const dae::Description& of);

}  // namespace hilda::python
