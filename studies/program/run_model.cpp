// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/run_model.hpp"

#include "io/json.hpp"
#include "io/message.hpp"
#include "io/program.hpp"
#include "lie/schemes.hpp"
#include "run/earlier_run.hpp"
#include "run/named_model.hpp"
#include "run/recording/setting_options.hpp"
#include "run/single_run.hpp"
#include "run/watch/run_check.hpp"

#include <fmt/format.h>

#include <iostream>

namespace hilda::studies {

namespace {

/// Output directory of each integrator. Directories that are not empty are rejected before the first run
/// starts.
std::vector<std::string> directories(const run::RunOptions& options)
{
    const std::string output =
        options.output.empty() ? "out/" + run::short_name(options.model) : options.output;
    std::vector<std::string> all;
    for (const std::string& name : options.integrators) {
        all.push_back(options.integrators.size() == 1 ? output : output + '/' + name);
        io::check_output_directory(all.back(), options.force || options.resume, io::force_or_resume);
    }
    return all;
}

/// The scheme with this name. If it has both forms, --step selects that with a fixed step.
const lie::Scheme& scheme_of(const std::string& name, const run::RunOptions& options)
{
    const lie::Scheme& scheme = lie::scheme(name);
    return options.step ? scheme : scheme.with_adaptive_steps();
}

/// Rejects options that do not apply to an integrator with adaptive steps, or to one that could have them
void refuse_for_adaptive(const run::RunOptions& options)
{
    for (const std::string& name : options.integrators) {
        const lie::Scheme& scheme = scheme_of(name, options);
        const auto refuse = [&](const std::string& why) { throw io::UsageError("run: " + name + " " + why); };
        run::check_step_options(scheme, options.given_settings, options.step.has_value(), options.interval);
        if (!scheme.adaptive) continue;
        if (!scheme.resumes && (options.resume || options.checkpoint > 0))
            refuse(
                "stores past steps outside the state; --checkpoint and --resume are for fixed-step schemes");
        if (options.error) refuse("chooses its own steps; --error is for fixed-step schemes");
    }
}

}  // namespace

int run_model(const run::RunOptions& options)
{
    refuse_for_adaptive(options);
    std::vector<const lie::Scheme*> schemes;
    for (const std::string& name : options.integrators) schemes.push_back(&scheme_of(name, options));
    run::refuse_unused_settings("run", options.given_settings, schemes);
    const std::vector<std::string> directory = directories(options);
    const io::Interrupt interrupt;
    int code = io::exit_code::done;
    io::Json all = io::Json::array();
    for (size_t k = 0; k < directory.size(); ++k) {
        if (io::Interrupt::caught() != 0) {
            code = io::exit_code::signal + io::Interrupt::caught();
            break;
        }
        run::RunResult result;
        try {
            result = run::SingleRun(options, *schemes[k], directory[k]).execute();
        } catch (const run::RunIsComplete& complete) {
            if (!options.quiet) io::message(fmt::format("hilda: {}\n", complete.what()));
            if (options.json) all.push_back(run::earlier_summary(directory[k]));
            continue;
        } catch (const run::RunHasEnded& ended) {
            if (directory.size() == 1) throw;
            if (!options.quiet) io::warning(ended.what() + std::string("; skipped"));
            continue;
        }
        if (code == io::exit_code::done) code = result.exit_code;
        if (options.json) all.push_back(summary(result));
        if (options.json || options.quiet) continue;
        if (k > 0) std::cout << '\n';
        print(result, std::cout);
    }
    if (options.json) std::cout << (directory.size() == 1 ? all.at(0) : io::Json{{"runs", all}}).text();
    return code;
}

}  // namespace hilda::studies
