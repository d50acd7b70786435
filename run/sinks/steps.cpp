// SPDX-License-Identifier: GPL-3.0-or-later
/// Table steps: Newton iterations, residuals, energy and cost of each step.

#include "run/tables/table_sink.hpp"

namespace hilda::run {

namespace {

class Steps final : public TableSink {
public:
    explicit Steps(const RunSetup& run) : TableSink(run, "steps"), h(run.grid.h) {}

private:
    std::vector<TableColumn> columns() const override
    {
        return {
            {"t", "s", "end of the step"},
            {"h", "s", "step size"},
            {"newton_iterations", "1", "Newton iterations", true},
            {"correction", "m, rad or kg m", "norm of the last Newton correction"},
            {"constraint_norm", "m or rad", "largest scaled residual of the position constraints"},
            {"energy", "J", "kinetic energy plus potential energy of gravity, springs and contact springs"},
            {"factorizations", "1", "LU factorisations with a new pivot selection", true},
            {"wall_ns", "ns", "wall time of the step", true}};
    }

    void append(std::vector<double>& row, const RunNode& node) override
    {
        if (node.n == 0) return;
        row = {node.x.t,
               h,
               static_cast<double>(node.iterations),
               node.cost.correction,
               node.constraint_norm,
               node.energy,
               static_cast<double>(node.cost.factorizations),
               static_cast<double>(node.cost.wall_ns)};
    }

    const double h;
};

const bool registered_steps = io::Registry<SinkType>::add(
    {.name = "steps",
     .options = {{.name = "--log-steps", .help = "write steps.csv as well, a row for each step"}},
     .make = [](const RunSetup& run) -> std::unique_ptr<io::Sink<RunNode>> {
         if (!run.options.contains("--log-steps")) return nullptr;
         if (run.command == std::string("kinematics"))
             throw io::UsageError(
                 "kinematics: --log-steps is for the steps of an integrator; hilda run has them");
         return std::make_unique<Steps>(run);
     },
     .files = {"steps.csv"}});

}  // namespace

}  // namespace hilda::run
