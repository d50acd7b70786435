// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/kinematics/kinematics.hpp"

#include "dae/kinematics.hpp"
#include "dae/model_file.hpp"
#include "io/archive.hpp"
#include "io/files.hpp"
#include "io/json.hpp"
#include "io/message.hpp"
#include "io/program.hpp"
#include "io/provenance.hpp"
#include "run/figures.hpp"
#include "run/kinematics/drives.hpp"
#include "run/kinematics/prescribed_motion.hpp"
#include "run/named_model.hpp"
#include "run/provenance.hpp"
#include "run/tables/run_table.hpp"
#include "run/tables/sink.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>

namespace hilda::run {

namespace {

const char* name_of(const KinematicsOptions& options) { return options.inverse ? "inverse" : "kinematics"; }

/// What the analysis has reached
struct Reached {
    struct Drive {
        std::string name;
        double load = 0, power = 0;  ///< largest magnitudes
    };
    std::vector<Drive> drives;
    long rows = 0;
    double t = 0, constraint_norm = 0;  ///< [s], [m or rad]
    dae::Reaction largest;              ///< with the largest force and the largest torque on a body
    std::string status = "ok", message;
    int exit_code = io::exit_code::done;
};

/// The table drives of hilda inverse
class DriveTable {
public:
    DriveTable(const dae::Model& model, RunTables& tables) : columns(model), row(1 + columns.columns.size())
    {
        std::vector<TableColumn> all = {{{"t", "s", "time"}}};
        for (const dae::Quantity& q : columns.columns) all.push_back({q});
        table = tables.table("drives", all);
    }

    void node(const lie::State& x, bool is_row, std::vector<Reached::Drive>& largest)
    {
        row[0] = x.t;
        columns.values(x, row.data() + 1);
        for (size_t k = 0; k < largest.size(); ++k) {
            largest[k].load = std::max(largest[k].load, std::abs(row[5 * k + 4]));
            largest[k].power = std::max(largest[k].power, std::abs(row[5 * k + 5]));
        }
        if (is_row) table->row(row);
    }
    /// The drivers, with loads of zero
    std::vector<Reached::Drive> drivers() const
    {
        std::vector<Reached::Drive> all;
        for (size_t k = 0; k < columns.columns.size(); k += 5)
            all.push_back({.name = columns.columns[k].name.substr(0, columns.columns[k].name.rfind('.'))});
        return all;
    }

    std::unique_ptr<RunTable> table;

private:
    DriveColumns columns;
    std::vector<double> row;
};

void analyse(const dae::Model& model, lie::State x, const lie::TimeGrid& grid, io::Sinks<RunSetup>& sinks,
             DriveTable* drives, Reached& reached)
{
    dae::Kinematics kinematics(model);
    lie::Rows C = model.pattern();
    std::vector<dae::Reaction> loads;
    for (long n = 0; n <= grid.steps && io::Interrupt::caught() == 0; ++n) {
        kinematics.move_to(x, static_cast<double>(n) * grid.h);
        const double constraint_norm = model.largest_residual(x).value;
        sinks.node(n, {.x = x,
                       .n = n,
                       .is_row = grid.is_row(n),
                       .energy = lie::energy(model, x),
                       .constraint_norm = constraint_norm,
                       .iterations = 0,
                       .cost = {}});
        if (drives != nullptr) drives->node(x, grid.is_row(n), reached.drives);
        dae::reactions(model, x, C, loads);
        for (const dae::Reaction& on : loads) {
            if (on.F.norm() > reached.largest.F.norm()) reached.largest.F = on.F;
            if (on.T.norm() > reached.largest.T.norm()) reached.largest.T = on.T;
        }
        reached.rows += grid.is_row(n), reached.t = x.t;
        reached.constraint_norm = std::max(reached.constraint_norm, constraint_norm);
    }
}

/// The contents of summary.json
io::Json summary_of(const KinematicsOptions& options, const dae::Description& d,
                    const dae::StartReport& start, double end, double interval, const Reached& reached,
                    const std::vector<std::string>& files)
{
    io::Json summary = {{"status", reached.status},
                        {"exit_code", reached.exit_code},
                        {"message", reached.message},
                        {"model", d.name},
                        {"analysis", name_of(options)},
                        {"dropped_rows", start.dropped},
                        {"end", end},
                        {"interval", interval},
                        {"rows", reached.rows},
                        {"t", reached.t},
                        {"constraint_norm", reached.constraint_norm},
                        {"largest_force", reached.largest.F.norm()},
                        {"largest_torque", reached.largest.T.norm()},
                        {"files", files},
                        {"provenance", provenance(options.command_line, 1)}};
    summary["provenance"]["inputs"] = io::inputs(d.files);
    for (const Reached::Drive& drive : reached.drives)
        summary["drives"].push_back(
            {{"name", drive.name}, {"largest_load", drive.load}, {"largest_power", drive.power}});
    return summary;
}

void print(const dae::Description& d, const dae::StartReport& start, const Reached& reached,
           const std::string& directory, const std::vector<std::string>& files)
{
    const auto line = [](const char* what, const std::string& text) {
        std::cout << fmt::format("{:<14}{}\n", what, text);
    };
    line("model", fmt::format("{}: {}, {}, 0 degrees of freedom", d.name,
                              io::counted(d.model->bodies(), "body", "bodies"),
                              io::counted(start.rows, "constraint row")));
    line("reached", fmt::format("t = {:.6g} s, {}", reached.t, io::counted(reached.rows, "row")));
    line("residual", fmt::format("{:.1e} m or rad", reached.constraint_norm));
    line("largest load",
         fmt::format("{:.4g} N, {:.4g} N m on a body", reached.largest.F.norm(), reached.largest.T.norm()));
    for (const Reached::Drive& drive : reached.drives)
        line(&drive == reached.drives.data() ? "drivers" : "",
             fmt::format("{}: load up to {:.4g}, power up to {:.4g} W", drive.name, drive.load, drive.power));
    line("written", fmt::format("{}: {}", directory, fmt::join(files, ", ")));
}

}  // namespace

int run_kinematics(const KinematicsOptions& options)
{
    const std::string command = name_of(options);
    dae::Description d = named_model(options.model, options.set, "", options.allow_paths);
    if (!options.motion.empty()) d = with_motion(d, options.motion);
    // The velocities of the model do not belong to a motion of a file.
    const dae::StartReport start =
        dae::start(d, {.fix_initial = options.fix_initial || !options.motion.empty()});
    const double end = options.end.value_or(d.end);
    const double interval = options.interval.value_or(end / 1000);
    if (!(interval > 0))
        throw io::UsageError(command + ": --interval must be positive, and --end for its default");
    // The nodes are at most 5 ms apart and divide the interval, so that angles are counted through whole
    // turns.
    constexpr double longest = 5e-3;
    const lie::TimeGrid grid = lie::TimeGrid::over(end, interval / std::ceil(interval / longest), interval);
    if (d.model->has_cones())
        throw lie::InvalidInput(
            fmt::format("{}: {} is for models without rigid contacts, whose forces do not "
                        "follow from the motion",
                        d.name, command));
    if (start.degrees_of_freedom != 0)
        throw lie::InvalidInput(
            fmt::format("{}: {} needs a model without degrees of freedom, got {}; {}, or integrate it by "
                        "hilda run",
                        d.name, command, start.degrees_of_freedom,
                        options.inverse ? "prescribe more motions by drivers or --motion" : "add drivers"));
    if (const dae::Model::MotionEnd motion = d.model->motion_end(); motion.t < end * (1 - 1e-12))
        throw io::UsageError(
            fmt::format("{}: --end must be at most {} s, the last sample of the motion of '{}', got {}",
                        command, motion.t, d.model->constraint_name(motion.constraint), end));
    const std::string directory =
        options.output.empty() ? "out/" + short_name(options.model) : options.output;
    io::check_output_directory(directory, options.force, io::force_overwrites);
    const dae::Kinematics check_degrees_of_freedom(*d.model);
    const std::string model_text = start.projected ? dae::text_at(d, d.x) : d.text;
    const std::shared_ptr<RunTables> tables = run_tables(options.outputs, directory,
                                                         {{"program", version_line()},
                                                          {"command_line", options.command_line},
                                                          {"integrator", command},
                                                          {"model", d.name},
                                                          {"model_text", model_text}});
    std::optional<DriveTable> drives;
    if (options.inverse) {
        drives.emplace(*d.model, *tables);
        if (drives->drivers().empty())
            throw lie::InvalidInput(d.name +
                                    ": inverse needs a driver, and the model has none; --motion FILE "
                                    "prescribes the motion of joints");
    }
    io::Sinks<RunSetup> sinks(RunSetup{.model = *d.model,
                                       .outputs = d.outputs,
                                       .model_name = d.name,
                                       .grid = grid,
                                       .end = end,
                                       .directory = directory,
                                       .options = options.outputs,
                                       .warn =
                                           [&](const std::string& what) {
                                               if (!options.quiet) io::warning(what);
                                           },
                                       .command = name_of(options),
                                       .tables = tables});
    if (!options.quiet)
        for (const std::string& w : d.warnings) io::warning(w);
    if (!options.quiet && !d.events.empty())
        io::warning(d.events.front().value->name_place + ": events are found by hilda run only");

    io::OutputLock lock(directory, options.force, io::force_overwrites);
    lock.create();
    io::Sinks<RunSetup>::remove(directory);
    io::CheckpointFiles(directory).remove();
    for (const char* file : {"/summary.json", "/events.csv", "/drives.csv"})
        std::remove((directory + file).c_str());
    for (const char* figure : {"trajectory.png", "drives.png"}) remove_figure(directory, figure);
    io::write_file(directory + "/model.json", model_text);
    const io::Interrupt interrupt;
    Reached reached;
    sinks.open();
    if (drives) {
        drives->table->open();
        reached.drives = drives->drivers();
    }
    try {
        analyse(*d.model, d.x, grid, sinks, drives ? &*drives : nullptr, reached);
    } catch (const lie::NumericalFailure& failure) {
        reached.status = failure.status, reached.message = failure.what();
        reached.exit_code = io::exit_code::numerical_failure;
        io::message(
            fmt::format("hilda: error[{}]: t={:.6g}: {}\n", failure.status, reached.t, failure.what()));
    }
    if (io::Interrupt::caught() != 0) {
        reached.status = "interrupted";
        reached.exit_code = io::exit_code::signal + io::Interrupt::caught();
    }
    sinks.close();

    std::vector<std::string> files = sinks.files();
    if (drives) {
        drives->table->close();
        for (const std::string& file : drives->table->files()) files.push_back(file);
        if (options.plot && options.draw && files.back() == "drives.csv" && reached.rows > 1)
            for (const std::string& file : options.draw("drives.py", directory, options.figure_formats))
                files.push_back(file);
    }
    files.insert(files.begin(), "model.json");
    files.emplace_back("summary.json");
    const io::Json summary = summary_of(options, d, start, end, interval, reached, files);
    io::write_file(directory + "/summary.json", summary.text());
    if (options.json) std::cout << summary.text();
    if (!options.json && !options.quiet) print(d, start, reached, directory, files);
    return reached.exit_code;
}

}  // namespace hilda::run
