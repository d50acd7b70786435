// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/jobs/pool.hpp"

#include "io/progress.hpp"
#include "run/jobs/finished_jobs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace hilda::run {

namespace {

/// The progress line of a pool, which several threads use
class PoolLine {
public:
    PoolLine(const std::string& label, long count, const std::function<double(long)>& cost)
        : label(label), count(count), cost(cost), line(label.empty())
    {
        for (long k = 0; k < count; ++k) total += cost(k);
    }

    bool is_shown() const { return line.is_shown(); }
    /// Job k has ended. `computed`: not read from a file
    void ended(long k, bool computed)
    {
        const std::lock_guard lock(in_use);
        ++number;
        completed += cost(k);
        if (!computed) read += cost(k);
        if (total > 0) line.completed(completed / total, read / total);
        write();
    }
    void update()
    {
        const std::lock_guard lock(in_use);
        write();
    }
    void clear() { line.clear(); }

private:
    void write()
    {
        if (line.is_due()) line.show(fmt::format("{} {}/{}, {:.0f} s", label, number, count, line.seconds()));
    }

    const std::string& label;
    const long count;
    const std::function<double(long)>& cost;
    double total = 0, completed = 0, read = 0;  ///< sums of the costs
    long number = 0;                            ///< of the jobs that have ended
    std::mutex in_use;
    io::ProgressLine line;
};

/// Updates the line each second during the jobs, until the end of its life.
class PoolClock {
public:
    explicit PoolClock(PoolLine& line)
    {
        if (!line.is_shown()) return;
        thread = std::jthread([&line](const std::stop_token& stop) {
            std::mutex mutex;
            std::condition_variable_any never;
            std::unique_lock lock(mutex);
            while (!stop.stop_requested()) {
                never.wait_for(lock, stop, std::chrono::seconds(1), [] { return false; });
                if (!stop.stop_requested()) line.update();
            }
        });
    }

private:
    std::jthread thread;
};

}  // namespace

void Pool::run(const std::function<void(long)>& job) const
{
    run_here([&](long k) {
        job(k);
        return true;
    });
}

void Pool::run_here(const std::function<bool(long)>& job) const
{
    std::atomic<long> next{0};
    std::vector<std::exception_ptr> thrown(count);
    const std::function<double(long)> cost_here = [&](long k) {
        return sharing == nullptr || sharing->shard.has(k) ? cost(k) : 0;
    };
    PoolLine line(label, count, cost_here);
    const auto work = [&] {
        for (long k = next++; k < count; k = next++) {
            bool computed = true;
            try {
                computed = job(k);
            } catch (...) {
                thrown[k] = std::current_exception();
            }
            line.ended(k, computed);
        }
    };
    {
        const PoolClock clock(line);
        std::vector<std::jthread> team;
        for (long k = 1; k < std::min<long>(threads, count); ++k) team.emplace_back(work);
        work();
    }  // joins
    line.clear();
    for (const std::exception_ptr& e : thrown)
        if (e) std::rethrow_exception(e);
}

void Pool::run(const std::function<void(long)>& job, const Transfer& transfer) const
{
    if (sharing == nullptr) {
        run(job);
        return;
    }
    FinishedJobs* const finished = sharing->finished;
    const long pool = finished == nullptr ? 0 : finished->next_pool();
    run_here([&](long k) {
        if (!sharing->shard.has(k)) return false;
        const auto result = [&](io::Archive& a) { transfer(a, k); };
        if (finished != nullptr && finished->restore({pool, k}, result)) return false;
        job(k);
        if (finished != nullptr) finished->keep({pool, k}, result);
        return true;
    });
    if (sharing->shard.is_part()) throw PartDone{};
}

}  // namespace hilda::run
