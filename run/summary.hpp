// SPDX-License-Identifier: GPL-3.0-or-later
/// The result of a run, as summary.json and as a short table on the terminal.

#pragma once

#include "dae/start.hpp"
#include "io/json.hpp"
#include "lie/statistics.hpp"
#include "lie/trajectory.hpp"
#include "run/columns/invariants.hpp"
#include "run/error_estimate.hpp"
#include "run/events/run_events.hpp"

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace hilda::dae {
struct Description;
}
namespace hilda::lie {
struct Scheme;
}

namespace hilda::run {

struct RunOptions;

struct RunResult {
    std::string status = "ok", message;
    int exit_code = 0;

    std::string model, integrator;
    double step = 0, end = 0, interval = 0;  ///< [s]; interval: between output rows, on the time grid
    io::Json settings;                       ///< of the integrator, see settings_json()
    double rtol = 0, atol = 0;  ///< of an adaptive scheme, whose nodes are the output rows; 0: fixed step
    double t = 0;               ///< time reached [s]

    int bodies = 0, constraints = 0, rigid_contacts = 0;
    std::vector<std::string> contacts;  ///< names of the contact constraints
    /// Event of a unilateral contact: closing, impact, lift-off or switch to the fallback
    struct Event {
        double t;  ///< [s]
        std::string contact, what;
        double speed;  ///< approach velocity [m/s]
    };
    std::vector<Event> events;
    std::vector<EventCount> located;  ///< the events of the model file
    std::string stopped_by;           ///< name of the event that ended the run
    dae::StartReport start;
    std::vector<std::string> warnings, set;
    std::vector<std::pair<std::string, double>> parameters;  ///< of the model

    lie::Statistics statistics;
    Invariants invariants;
    io::Json watch;                      ///< see Watch::json()
    std::optional<ErrorEstimate> error;  ///< of --error
    double setup_seconds = 0, wall_seconds = 0;
    long resumed_at = -1;                 ///< number of the step; -1: not resumed
    io::Json inputs = io::Json::array();  ///< io::inputs() of the files that were read
    std::string command_line;
    int threads = 1;

    std::string directory;
    std::vector<std::string> files;  ///< written into the directory
};

/// Sets what is known before the steps: the model, the integrator and its settings, the time grid, the input
/// files.
void describe(RunResult& result, const RunOptions& options, const lie::Scheme& scheme,
              const dae::Description& description, const lie::TimeGrid& grid);

/// The events of the unilateral contacts up to the time t [s], without those of the additional step beyond
/// the end that completes the last node
std::vector<RunResult::Event> contact_events(const lie::Integrator& integrator, const dae::Model& model,
                                             double t);

/// The contents of summary.json
io::Json summary(const RunResult& result);

/// Prints the result as a short table.
void print(const RunResult& result, std::ostream& out);

}  // namespace hilda::run
