// SPDX-License-Identifier: GPL-3.0-or-later
/// One run of a study: a problem, a scheme, and a step or a tolerance; what it cost and how it ended.

#pragma once

#include "studies/framework/benchmark.hpp"

#include <nlohmann/json_fwd.hpp>

#include <span>

namespace hilda::studies {

struct Run {
    const Benchmark* c = nullptr;
    const lie::Scheme* scheme = nullptr;
    double h = 0;     ///< between nodes [s]
    double rtol = 0;  ///< of a scheme that chooses its own steps; 0: this one does not

    lie::Statistics statistics;
    double seconds = 0;  ///< thread CPU time of the march
    std::string status = "ok", message;

    bool failed() const { return status != "ok"; }
    /// "h = 1e-3 s" or "rtol = 1e-6"
    std::string grain() const;
    /// "rA-half-1 on double_pendulum at h = 1e-3 s"
    std::string name() const;
};

/// CPU time of the calling thread [s]
double thread_seconds();

/// The settings of a study, with the tolerance of this member
lie::Settings settings_of(const Run& member, const lie::Settings& of_study);

/// Marches from the start to the end of the member's case. A failure becomes its status: the other members of
/// the study go on.
void march(Run& member, const lie::Settings& of_study, std::span<lie::Observer* const> observers = {});

/// Members of any study, for what looks only at how they ended
template <class AnyRun>
std::vector<const Run*> run_pointers(const std::vector<AnyRun>& runs)
{
    std::vector<const Run*> all;
    for (const AnyRun& run : runs) all.push_back(&run);
    return all;
}

/// A line for each member that failed, with why
std::string failures(const std::vector<const Run*>& run_pointers);

/// problem, integrator, h or rtol, status and message: what study.json says of every member
nlohmann::ordered_json as_json(const Run& member);

}  // namespace hilda::studies
