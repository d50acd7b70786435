// SPDX-License-Identifier: GPL-3.0-or-later
/// Concurrent execution of independent jobs.

#pragma once

#include <functional>
#include <string>
#include <utility>

namespace hilda::io {
class Archive;
}

namespace hilda::studies {

class FinishedJobs;

class Pool {
public:
    /// `count` jobs on at most `threads` threads. On a terminal a progress line with this label is shown on
    /// stderr; none for "". `finished` keeps the results of jobs for a resumed study; nullptr: they are not
    /// kept.
    Pool(int threads, std::string label, long count, FinishedJobs* finished = nullptr)
        : threads(threads), label(std::move(label)), count(count), finished(finished)
    {}

    /// Calls job(0) … job(count - 1), each once, started in this order. After all jobs have ended, rethrows
    /// the exception of the lowest job number.
    void run(const std::function<void(long)>& job) const;
    /// The same for jobs whose results transfer(archive, k) writes or reads. A job that finished before the
    /// study was interrupted is not called again: its result is read.
    void run(const std::function<void(long)>& job,
             const std::function<void(io::Archive&, long)>& transfer) const;

private:
    int threads;
    std::string label;
    long count;
    FinishedJobs* finished;
};

}  // namespace hilda::studies
