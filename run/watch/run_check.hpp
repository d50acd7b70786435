// SPDX-License-Identifier: GPL-3.0-or-later
/// Checks before a run.

#pragma once

#include "lie/trajectory.hpp"

#include <optional>
#include <string>
#include <vector>

namespace hilda::dae {
class Model;
}

namespace hilda::lie {
struct Scheme;
}

namespace hilda::run {

/// The integrator of a run without --integrator: leapfrog in angular momentum, of second order in positions,
/// velocities and constraint forces
inline constexpr const char* default_integrator = "rA-half-1-momentum";
/// The same for this model: rA-moreau-1 if it has rigid contacts
const char* default_integrator_of(const dae::Model& model);
inline constexpr double default_step = 1e-3;  ///< [s], of a run without --step

/// io::UsageError "run: NAME ..." for settings (such as --rtol), a step and an output interval that do not
/// fit the scheme. `scheme` has adaptive steps unless a step is given or it has none.
void check_step_options(const lie::Scheme& scheme, const std::vector<std::string>& settings, bool has_step,
                        std::optional<double> interval);

/// The time grid of a run: for an adaptive scheme each node is an output row. Without a step it is that of
/// default_step, without an interval a row for each 1/1000 of the end. io::UsageError.
lie::TimeGrid time_grid(const lie::Scheme& scheme, double end, std::optional<double> step,
                        std::optional<double> interval);

/// Warnings if the end [s] or the output interval [s] is not a multiple of the step; interval 0: none given
std::vector<std::string> grid_warnings(const lie::TimeGrid& grid, double end, double interval,
                                       const lie::Scheme& scheme);

/// Checks that the model allows a run over this grid with this scheme. `start` is its consistent start.
///
/// Throws io::UsageError if the run ends after the last sample of a prescribed motion, if a force has
/// internal state variables that the scheme does not take, and if the step exceeds the stability limit of a
/// force, unless `accept_unstable` is set. Returns a warning in that case, "" otherwise.
std::string check_run(const dae::Model& model, const lie::State& start, const lie::Scheme& scheme,
                      const lie::TimeGrid& grid, bool accept_unstable);

}  // namespace hilda::run
