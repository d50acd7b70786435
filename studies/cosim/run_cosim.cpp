// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/cosim/run_cosim.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/program.hpp"
#include "lie/schemes.hpp"
#include "studies/cosim/grain_coupling.hpp"
#include "studies/cosim/grain_process.hpp"
#include "studies/cosim/local_grains.hpp"
#include "studies/running/single_run.hpp"

#include <omp.h>
#include <iostream>

namespace hilda::studies {

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
                         .strict = o.strict});
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
                                      {o.resume, "--resume"},
                                      {o.strict, "--strict"}})
        if (given) arguments.emplace_back(name);
    return start_grains(arguments, boundaries(file));
}

}  // namespace

int run_cosim(const CosimOptions& options)
{
    RunOptions o = options.run;
    const CosimFile file = read_cosim(options.file, o.set);
    o.set.clear();
    if (o.output.empty()) o.output = "out/" + file.name;
    io::check_output_directory(o.output, o.force || o.resume, io::force_or_resume);
    const double end = o.end.value_or(file.end);
    GrainCoupling coupling(
        file, options.transport == "pipe" ? grains_of_process(file, end, o) : grains_here(file, end, o));
    o.model = file.model, o.coupling = &coupling;
    o.step = coupling.H(), o.end = end;
    if (file.interval) o.interval = file.interval;
    const io::Interrupt interrupt;
    const RunResult result = SingleRun(o, lie::scheme(file.integrator), o.output).execute();
    if (o.json)
        std::cout << summary(result).text();
    else if (!o.quiet)
        print(result, std::cout);
    return result.exit_code;
}

}  // namespace hilda::studies
