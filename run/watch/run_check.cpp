// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/watch/run_check.hpp"

#include "dae/model.hpp"
#include "io/error.hpp"
#include "lie/schemes.hpp"

#include <fmt/format.h>

#include <cmath>

namespace hilda::run {

namespace {

constexpr double rounding = 1e-9;  // relative, of times

/// Four digits, rounded down, so that the printed step satisfies the limit
std::string rounded_down(double positive)
{
    const double unit = std::pow(10.0, std::floor(std::log10(positive)) - 3);
    return fmt::format("{:.4g}", std::floor(positive / unit) * unit);
}

}  // namespace

void check_step_options(const lie::Scheme& scheme, const std::vector<std::string>& settings, bool has_step,
                        std::optional<double> interval)
{
    const auto refuse = [&](const std::string& why) {
        throw io::UsageError("run: " + scheme.name + " " + why);
    };
    for (const std::string& option : settings)
        if (has_step && !scheme.uses_option(option) && scheme.with_adaptive_steps().uses_option(option))
            refuse("has a fixed step with --step, and adaptive steps with " + option + "; give one of them");
    if (!scheme.adaptive) return;
    if (has_step) refuse("chooses its own steps by --rtol and --atol; --step is for fixed-step schemes");
    if (interval && *interval == 0) refuse("chooses its own steps; --interval must be positive, got 0");
}

const char* default_integrator_of(const dae::Model& model)
{
    return model.has_cones() ? "rA-moreau-1" : default_integrator;
}

lie::TimeGrid time_grid(const lie::Scheme& scheme, double end, std::optional<double> step,
                        std::optional<double> interval)
{
    const double spacing = interval.value_or(end / 1000);
    try {
        if (scheme.adaptive) {
            // The rows divide the time up to the end: the run ends there.
            lie::TimeGrid grid = lie::TimeGrid::over(end, interval || spacing > 0 ? spacing : default_step);
            if (grid.steps > 0 && static_cast<double>(grid.steps) * grid.h > end * (1 + rounding))
                grid.h = end / static_cast<double>(grid.steps);
            return grid;
        }
        return lie::TimeGrid::over(end, step.value_or(default_step), spacing);
    } catch (const lie::InvalidInput& error) {
        throw io::UsageError(error.what());
    }
}

std::vector<std::string> grid_warnings(const lie::TimeGrid& grid, double end, double interval,
                                       const lie::Scheme& scheme)
{
    std::vector<std::string> warnings;
    const double reached = static_cast<double>(grid.steps) * grid.h,
                 spacing = static_cast<double>(grid.interval) * grid.h;
    if (reached > end * (1 + rounding))
        warnings.push_back(fmt::format(
            "the end {} s is not a multiple of the step: the run ends at {:.12g} s", end, reached));
    if (scheme.adaptive && interval > 0 && spacing < interval * (1 - rounding))
        warnings.push_back(
            fmt::format("the end {} s is not a multiple of --interval {}: rows are {:.12g} s apart", end,
                        interval, spacing));
    if (interval > 0 && spacing > interval * (1 + rounding))
        warnings.push_back(fmt::format(
            "--interval {} is not a multiple of the step: rows are {:.12g} s apart", interval, spacing));
    return warnings;
}

std::string check_run(const dae::Model& model, const lie::State& start, const lie::Scheme& scheme,
                      const lie::TimeGrid& grid, bool accept_unstable)
{
    const double end = static_cast<double>(grid.steps) * grid.h;
    if (const dae::Model::MotionEnd motion = model.motion_end(); motion.t < end * (1 - 1e-12))
        throw io::UsageError(
            fmt::format("run: --end must be at most {} s, the last sample of the motion of '{}', got {}",
                        motion.t, model.constraint_name(motion.constraint), end));
    for (const auto& force : model.forces())
        if (!scheme.supports.contains(lie::Feature::history) && force->internal_states() > 0)
            throw io::UsageError(
                scheme.adaptive
                    ? fmt::format(
                          "run: {} chooses its own steps; {} has internal state variables and needs a "
                          "fixed-step scheme{}",
                          scheme.name, force->label(), scheme.resumes ? " or --step" : "")
                    : fmt::format(
                          "run: {} does not take loads with a history; {} has internal state variables",
                          scheme.name, force->label()));
    if (!scheme.supports.contains(lie::Feature::history) && !model.near_forces().empty())
        throw io::UsageError(
            fmt::format("run: {} does not take loads with a history; {} has internal state variables",
                        scheme.name, model.near_forces().all_groups()[0]->example().label()));
    if (scheme.adaptive) return "";
    const dae::Model::StableStep stable = model.stable_step(start, scheme);
    if (grid.h <= stable.h) return "";
    const auto of_limit = model.force_of(stable.force);
    const dae::Force& force = *of_limit;
    std::string what =
        fmt::format("the step {} s is above {} s, the stability limit of {} in an explicit step", grid.h,
                    rounded_down(stable.h), force.label());
    if (!accept_unstable)
        throw io::UsageError("run: " + what +
                             (force.may_be_implicit() && scheme.supports.contains(lie::Feature::springs)
                                  ? "; \"implicit\": true in this force removes this limit"
                                  : "") +
                             "; --accept-step accepts it");
    return what;
}

}  // namespace hilda::run
