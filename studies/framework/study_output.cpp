// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/study_output.hpp"

#include "io/files.hpp"
#include "io/message.hpp"
#include "lie/settings.hpp"
#include "studies/program/plot.hpp"
#include "studies/running/provenance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <iostream>

namespace hilda::studies {

namespace {

io::Json whole(const StudyOptions& options, const StudyOutput& output)
{
    const lie::Settings& s = options.settings;
    constexpr const char* solvers[] = {"auto", "klu", "condensed"};
    io::Json json = {{"study", output.kind},
                     {"tolerance", s.tolerance},
                     {"settings",
                      {{"tolerance", s.tolerance},
                       {"linear_solver", solvers[static_cast<int>(s.linear_solver)]},
                       {"rho_infinity", s.rho_infinity},
                       {"reparametrise", s.reparametrise},
                       {"rtol", s.rtol},
                       {"atol", s.atol > 0 ? io::Json(s.atol) : io::Json("as rtol")}}},
                     {"seed", options.seed},
                     {"set", options.set},
                     {"provenance", provenance(options.command_line, options.jobs)}};
    if (options.repeats > 0) json["repeats"] = options.repeats;
    json.update(output.json);
    return json;
}

void write(const StudyOptions& options, const StudyOutput& output, const io::Json& json)
{
    const std::string in = options.output + "/";
    std::vector<std::string> written = {"study.csv", "study.json"};
    io::write_file(in + "study.csv", output.table);
    io::write_file(in + "study.json", json.text());
    for (const auto& [name, content] : output.files) {
        io::write_file(in + name, content);
        written.push_back(name);
    }
    for (const std::string& figure : output.figures)
        std::remove((in + figure).c_str());  // those of an earlier run
    if (options.plot && plot(output.kind + ".py", options.output))
        written.insert(written.end(), output.figures.begin(), output.figures.end());
    if (options.json || options.quiet) return;
    std::cout << "\nwritten to " << options.output << ":";
    for (const std::string& file : written) std::cout << ' ' << file;
    std::cout << '\n';
}

}  // namespace

int finish(const StudyOptions& options, const StudyOutput& output,
           const std::vector<const Run*>& run_pointers, const std::vector<Measured>& measured)
{
    const io::Json json = whole(options, output);
    if (options.json)
        std::cout << json.text();
    else if (!options.quiet)
        std::cout << output.text.str() << failures(run_pointers);
    if (!options.output.empty()) write(options, output, json);
    if (!run_pointers.empty() &&
        std::all_of(run_pointers.begin(), run_pointers.end(), [](const Run* m) { return m->failed(); })) {
        io::message(fmt::format("hilda: error[{}]: study {}: all {} runs failed; {}: {}\n",
                                run_pointers.front()->status, output.kind, run_pointers.size(),
                                run_pointers.front()->name(), run_pointers.front()->message));
        return io::exit_code::numerical_failure;
    }
    return as_expected(options.expect, measured) ? io::exit_code::done : io::exit_code::expectation_failed;
}

}  // namespace hilda::studies
