// SPDX-License-Identifier: GPL-3.0-or-later
/// Table contacts: forces and motion of all contacts at the output rows.

#include "run/columns/contact_outputs.hpp"
#include "run/columns/state_columns.hpp"

#include <fmt/format.h>

namespace hilda::run {

namespace {

const bool registered_contacts = io::Registry<SinkType>::add(
    {.name = "contacts",
     .options = {{.name = "--contacts",
                  .help = "write contacts.csv as well: normal force, gap, contact point, friction, slip"}},
     .make = [](const RunSetup& run) -> std::unique_ptr<io::Sink<RunNode>> {
         if (!run.options.contains("--contacts")) return nullptr;
         if (const long pairs = run.model.near_forces().pairs();
             pairs > ContactOutputs::most_pairs_with_columns)
             throw io::UsageError(
                 fmt::format("{}: --contacts writes columns for each pair of bodies, at most {} pairs of "
                             "groups; {} has {}; "
                             "--vtk DT writes the contacts of each frame",
                             run.command, ContactOutputs::most_pairs_with_columns, run.model_name, pairs));
         auto columns = contact_columns(run.model);
         if (columns->columns.empty())
             throw io::UsageError(std::string(run.command) + ": --contacts writes the contacts of a model; " +
                                  run.model_name + " has no contacts");
         return std::make_unique<ColumnsSink>(run, "contacts", std::move(columns));
     },
     .files = {"contacts.csv"}});

}  // namespace

}  // namespace hilda::run
