// SPDX-License-Identifier: GPL-3.0-or-later
/// What came of a run: summary.json for programs, a short table for people.

#pragma once

#include "dae/start.hpp"
#include "studies/running/csv_trajectory.hpp"

#include <nlohmann/json_fwd.hpp>

#include <iosfwd>
#include <string>
#include <vector>

namespace hilda::studies {

struct Result {
    std::string status = "ok", message;
    int exit_code = 0;

    std::string model, integrator;
    double step = 0, end = 0, interval = 0, tolerance = 0;  ///< every: between rows as they lie on the grid
    double rtol = 0,
           atol = 0;  ///< of a scheme that chooses its own steps: it has no step, and a row is a node
    double t = 0;     ///< reached [s]

    int bodies = 0, constraints = 0;
    std::vector<std::string> contacts;  ///< those that evolve
    /// What happened to those that open, since the run began or went on
    struct Event {
        double t;  ///< [s]
        std::string contact, what;
        double speed;  ///< of approach [m/s]
    };
    std::vector<Event> events;
    dae::StartReport start;
    std::vector<std::string> warnings, set;

    lie::Statistics statistics;
    Invariants invariants;
    double setup_seconds = 0, wall_seconds = 0;
    long resumed_at = -1;  ///< step number; -1: not resumed
    std::string command_line;
    int threads = 1;

    std::string directory;
    std::vector<std::string> files;  ///< written into the directory
};

nlohmann::ordered_json summary(const Result& result);

void print(const Result& result, std::ostream& out);

}  // namespace hilda::studies
