// SPDX-License-Identifier: GPL-3.0-or-later
/// Table outputs: the outputs that the model file lists, at the output rows.

#include "run/columns/output_columns.hpp"

namespace hilda::run {

namespace {

const bool registered_outputs = io::Registry<SinkType>::add(
    {.name = "outputs",
     .make = [](const RunSetup& run) -> std::unique_ptr<io::Sink<RunNode>> {
         if (run.outputs.empty()) return nullptr;
         return std::make_unique<ColumnsSink>(run, "outputs",
                                              std::make_unique<OutputColumns>(run.model, run.outputs));
     },
     .files = {"outputs.csv"}});

}  // namespace

}  // namespace hilda::run
