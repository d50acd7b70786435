// SPDX-License-Identifier: GPL-3.0-or-later
/// Table forces: lengths, angles and forces of springs, dampers, limits and bushings at the output rows.

#include "run/columns/state_columns.hpp"

namespace hilda::run {

namespace {

const bool registered_forces = io::Registry<SinkType>::add(
    {.name = "forces",
     .options = {{.name = "--forces",
                  .help = "write forces.csv as well: lengths, angles and forces of springs and limits"}},
     .make = [](const RunSetup& run) -> std::unique_ptr<io::Sink<RunNode>> {
         if (!run.options.contains("--forces")) return nullptr;
         auto columns = force_columns(run.model);
         if (columns->columns.empty())
             throw io::UsageError(std::string(run.command) +
                                  ": --forces writes springs, limits and bushings; " + run.model_name +
                                  " has none");
         return std::make_unique<ColumnsSink>(run, "forces", std::move(columns));
     },
     .files = {"forces.csv"}});

}  // namespace

}  // namespace hilda::run
