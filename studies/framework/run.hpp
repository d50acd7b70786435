// SPDX-License-Identifier: GPL-3.0-or-later
/// A run of a study: benchmark, integrator and step or tolerance, with its cost and status.

#pragma once

#include "io/archive.hpp"
#include "io/json.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/statistics.hpp"
#include "studies/framework/benchmark.hpp"

#include <span>

namespace hilda::studies {

struct Run {
    const Benchmark* c = nullptr;
    const lie::Scheme* scheme = nullptr;
    double h = 0;     ///< time between nodes [s]
    double rtol = 0;  ///< relative tolerance of an adaptive scheme; 0: fixed step

    lie::Statistics statistics;
    double seconds = 0;  ///< thread CPU time of the integration [s]
    std::string status = "ok", message;
    std::string findings;  ///< of the Watch: lines "NAME: TEXT"

    /// Writes or reads the results. A derived type adds its own: see Sweep.
    void transfer(io::Archive& a)
    {
        a.value(statistics), a.value(seconds), a.list(status), a.list(message), a.list(findings);
    }

    bool failed() const { return status != "ok"; }
    /// "h = 1e-3 s" or "rtol = 1e-6"
    std::string resolution() const;
    /// "rA-half-1 on double_pendulum at h = 1e-3 s"
    std::string name() const;
};

/// The settings of a study, with the rtol of this run if it has one
lie::Settings settings_of(const Run& run, const lie::Settings& of_study);

/// Integrates the benchmark from the start to the end. A failure is recorded as status and message of the
/// run, so that the other runs of the study continue.
void march(Run& run, const lie::Settings& of_study, std::span<lie::Observer* const> observers = {});

/// Pointers to the elements of a vector, as pointers to their base class
template <class Pointer, class Runs>
std::vector<Pointer> pointers(Runs& runs)
{
    std::vector<Pointer> all;
    all.reserve(runs.size());
    for (auto& run : runs) all.push_back(&run);
    return all;
}
/// Pointers to the Run part of the runs of any study
template <class AnyRun>
std::vector<const Run*> run_pointers(const std::vector<AnyRun>& runs)
{
    return pointers<const Run*>(runs);
}

/// One line for each failed run with its reason; one line for all runs that stopped at singular Euler angles;
/// one line with the number of runs for each kind of finding
std::string failures(const std::vector<const Run*>& run_pointers);

/// problem, integrator, h or rtol, status and message of a run, for study.json
io::Json as_json(const Run& run);

}  // namespace hilda::studies
