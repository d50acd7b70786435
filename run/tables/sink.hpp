// SPDX-License-Identifier: GPL-3.0-or-later
/// Sinks of a run of a model. A new output format is one file in run/sinks.

#pragma once

#include "io/sink.hpp"
#include "lie/trajectory.hpp"

#include <functional>
#include <memory>

namespace hilda::dae {
class Model;
class Output;
}  // namespace hilda::dae

namespace hilda::run {

class Coupling;
class RunTables;

/// Cost of a step
struct StepCost {
    long factorizations = 0, wall_ns = 0;
    double correction = 0;  ///< norm of the last Newton correction
};

/// A complete node of a run
struct RunNode {
    const lie::State& x;
    long n;                          ///< number of the node
    bool is_row;                     ///< the node is an output row of the time grid
    double energy, constraint_norm;  ///< [J]; largest scaled residual, also of dropped rows [m or rad]
    int iterations;                  ///< of the step that ends there
    StepCost cost;                   ///< of that step
};

/// What the sinks of a run are made from. The references outlive the sinks.
struct RunSetup {
    using Node = RunNode;

    const dae::Model& model;
    const std::vector<std::unique_ptr<dae::Output>>& outputs;  ///< of the model file
    const std::string& model_name;
    const lie::TimeGrid& grid;
    double end;  ///< [s]
    std::string directory;
    const io::SinkOptions& options;
    std::function<void(const std::string&)> warn;
    const char* command = "run";                  ///< of hilda, for messages
    std::shared_ptr<RunTables> tables = nullptr;  ///< format of the tables; nullptr: CSV
    Coupling* coupling = nullptr;                 ///< of a co-simulation
};

using RowsSink = io::RowsSink<RunNode>;
using SinkType = io::SinkType<RunSetup>;

}  // namespace hilda::run
