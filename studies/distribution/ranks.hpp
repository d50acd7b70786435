// SPDX-License-Identifier: GPL-3.0-or-later
/// Distribution of jobs over the ranks that mpirun has started.

#pragma once

#include "studies/distribution/communicator.hpp"
#include "studies/distribution/job_processes.hpp"

#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace hilda::studies {

/// Rank 0 distributes the jobs, one at a time, and computes jobs as well. Each rank computes its jobs in
/// processes of their own (JobProcesses). The end of such a process costs its job. The end of a rank costs
/// the jobs that it computes, if mpirun lets the other ranks continue (mpirun --enable-recovery).
class Ranks {
public:
    /// nullptr if mpirun has not started several ranks
    static std::unique_ptr<Ranks> start();
    explicit Ranks(std::unique_ptr<Communicator> communicator);
    /// Rank 0 ends the others; these wait for it.
    ~Ranks();
    Ranks(const Ranks&) = delete;
    Ranks& operator=(const Ranks&) = delete;

    bool is_first() const { return all->rank() == 0; }
    int count() const { return all->size(); }
    /// On another rank than 0: reports that it cannot compute jobs.
    void report_failure(const std::string& what) { all->send(0, failed + what); }

    using Compute = std::function<std::string(long)>;
    /// On rank 0: calls report(end) for the end of each job, in the order of the ends, and wait() while it
    /// waits for them.
    void distribute(std::deque<long> jobs, int processes, const Compute& compute,
                    const std::function<void(const JobEnd&)>& report, const std::function<void()>& wait);
    /// On the other ranks: computes jobs until rank 0 ends this rank.
    void work(int processes, const Compute& compute);

private:
    // First letters of messages
    static constexpr char ready = 'r', result = 'e', alive = 'a', failed = 'f', ended = 'q',  // to rank 0
        job = 'j', stop = 's';                                                                // from rank 0

    using Clock = std::chrono::steady_clock;
    struct Other {
        std::set<long> jobs;  ///< that it computes
        int free = 0;         ///< jobs that it can start
        bool is_gone = false;
        Clock::time_point last_message = {};
    };

    void receive_from(Other& other, const Communicator::Received& received,
                      const std::function<void(const JobEnd&)>& report);
    void lose(int rank, const std::string& reason, const std::function<void(const JobEnd&)>& report);
    void report_lost_ranks(const std::function<void(const JobEnd&)>& report);

    std::unique_ptr<Communicator> all;
    std::vector<Other> others;  ///< on rank 0, by rank
    bool stopped = false;       ///< on the other ranks
};

}  // namespace hilda::studies
