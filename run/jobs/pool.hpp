// SPDX-License-Identifier: GPL-3.0-or-later
/// Concurrent execution of independent jobs.

#pragma once

#include "run/jobs/shard.hpp"

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace hilda::io {
class Archive;
}

namespace hilda::run {

class FinishedJobs;

/// What the pools of a study share
struct JobSharing {
    FinishedJobs* finished = nullptr;  ///< keeps the results of jobs for a resumed study; nullptr: none
    Shard shard = {};                  ///< the jobs that are computed
};

class Pool {
public:
    /// `count` jobs on at most `threads` threads. A progress line with this label is shown on stderr; none
    /// for "".
    Pool(int threads, std::string label, long count, JobSharing* sharing = nullptr)
        : threads(threads), label(std::move(label)), count(count), sharing(sharing)
    {}

    /// The cost of job k relative to the others, for the remaining time of the progress line. Without it all
    /// jobs have the same cost.
    Pool& with_cost(std::function<double(long)> of_job)
    {
        cost = std::move(of_job);
        return *this;
    }

    /// Calls job(0) … job(count - 1), each once, started in this order. After all jobs have ended, rethrows
    /// the exception of the lowest job number.
    void run(const std::function<void(long)>& job) const;

    using Transfer = std::function<void(io::Archive&, long)>;
    /// The same for jobs whose results transfer(archive, k) writes or reads. A job that finished before the
    /// study was interrupted is not called again: its result is read.
    ///
    /// The jobs of a study with the option --shard are distributed over shards. A process that has only a
    /// part of them ends with PartDone.
    void run(const std::function<void(long)>& job, const Transfer& transfer) const;

private:
    /// job(k) returns whether the job was computed. Its result may have been read from a file.
    void run_here(const std::function<bool(long)>& job) const;

    int threads;
    std::string label;
    long count;
    JobSharing* sharing;
    std::function<double(long)> cost = [](long) { return 1.0; };
};

}  // namespace hilda::run
