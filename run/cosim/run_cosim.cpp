// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/cosim/run_cosim.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/message.hpp"
#include "io/program.hpp"
#include "lie/schemes.hpp"
#include "run/cosim/grain_coupling.hpp"
#include "run/cosim/grain_process.hpp"
#include "run/cosim/local_grains.hpp"
#include "run/cosim/rank_channel.hpp"
#include "run/earlier_run.hpp"
#include "run/single_run.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <csignal>
#include <iostream>

namespace hilda::run {

namespace {

constexpr const char* grains_folder = "/grains";

/// The grains in this process
std::unique_ptr<granular::Exchange> grains_here(const CosimFile& file, double end, const RunOptions& o)
{
    omp_set_num_threads(o.threads);
    return local_grains(file, end,
                        {.output = o.output + grains_folder,
                         .checkpoint = 0,
                         .quiet = o.quiet || o.json,
                         .verbose = o.verbose,
                         .force = o.force,
                         .resume = o.resume,
                         .accept_step = o.accept_step,
                         .strict = o.strict},
                        o.allow_paths);
}

/// The grains in a process of hilda-granular
std::unique_ptr<granular::Exchange> grains_of_process(const CosimFile& file, double end, const RunOptions& o)
{
    std::vector<std::string> arguments = {file.granular_case,
                                          "--output",
                                          o.output + grains_folder,
                                          "--end",
                                          io::shortest(end),
                                          "--threads",
                                          std::to_string(o.threads),
                                          "--checkpoint",
                                          "0"};
    for (const auto& [given, name] : {std::pair{o.quiet || o.json, "--quiet"},
                                      {o.verbose, "--verbose"},
                                      {o.force, "--force"},
                                      {o.accept_step, "--accept-step"},
                                      {o.resume, "--resume"},
                                      {o.strict, "--strict"},
                                      {o.allow_paths, "--allow-paths"}})
        if (given) arguments.emplace_back(name);
    return start_grains(arguments, boundaries(file));
}

/// Rank 1: the grains. Rank 0 saves and ends the run after an interruption, and reports errors.
int serve_grains(const CosimFile& file, double end, const RunOptions& o, granular::Channel& channel)
{
    std::signal(SIGINT, SIG_IGN), std::signal(SIGHUP, SIG_IGN), std::signal(SIGTERM, SIG_IGN);
    try {
        granular::serve(channel, [&](const std::vector<std::string>&) { return grains_here(file, end, o); });
    } catch (const RankClosed&) {  // rank 0 reports its error
    }
    return io::exit_code::done;
}

/// The channel of the transport mpi to the other rank. Throws io::UsageError without two ranks.
std::unique_ptr<granular::Channel> channel_of_ranks()
{
    if (const int n = ranks_of_environment(); n != 2)
        throw io::UsageError(
            fmt::format("cosim: --transport mpi needs two ranks, mpirun -n 2 hilda cosim ..., got {}", n));
    return std::make_unique<RankChannel>(make_communicator(), 1 - rank_of_environment());
}

int run_rank(const CosimOptions& options)
{
    RunOptions o = options.run;
    const bool ranks = options.transport == "mpi", first = !ranks || rank_of_environment() == 0;
    // Before anything that can throw: its destructor ends the other rank.
    std::unique_ptr<granular::Channel> channel = ranks ? channel_of_ranks() : nullptr;
    const CosimFile file = read_cosim(options.file, o.set, o.allow_paths);
    o.set.clear();
    if (o.output.empty()) o.output = "out/" + file.name;
    const double end = o.end.value_or(file.end);
    if (!first) return serve_grains(file, end, o, *channel);
    io::check_output_directory(o.output, o.force || o.resume, io::force_or_resume);
    std::unique_ptr<granular::Exchange> grains;
    if (ranks)
        grains = std::make_unique<granular::RemoteExchange>(std::move(channel), boundaries(file));
    else
        grains = options.transport == "pipe" ? grains_of_process(file, end, o) : grains_here(file, end, o);
    GrainCoupling coupling(file, std::move(grains));
    o.model = file.model, o.coupling = &coupling;
    o.inputs = {options.file};
    o.step = coupling.H(), o.end = end;
    if (file.interval) o.interval = file.interval;
    const io::Interrupt interrupt;
    RunResult result;
    try {
        result = SingleRun(o, lie::scheme(file.integrator), o.output).execute();
    } catch (const RunIsComplete& complete) {
        if (!o.quiet) io::message(fmt::format("hilda: {}\n", complete.what()));
        if (o.json) std::cout << earlier_summary(o.output).text();
        return io::exit_code::done;
    }
    if (o.json)
        std::cout << summary(result).text();
    else if (!o.quiet)
        print(result, std::cout);
    return result.exit_code;
}

}  // namespace

int run_cosim(const CosimOptions& options)
{
    if (options.transport != "mpi" || rank_of_environment() == 0) return run_rank(options);
    try {
        return run_rank(options);
    } catch (const io::Failure& e) {  // rank 0 reports the same error of the files
        return e.code;
    } catch (const io::InvalidInput&) {
        return io::exit_code::invalid_input;
    }
}

}  // namespace hilda::run
