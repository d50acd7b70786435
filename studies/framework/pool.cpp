// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/pool.hpp"

#include "io/progress.hpp"
#include "studies/distribution/ranks.hpp"
#include "studies/running/finished_jobs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace hilda::studies {

void Pool::run(const std::function<void(long)>& job) const
{
    std::atomic<long> next{0}, done{0};
    std::vector<std::exception_ptr> thrown(count);
    std::mutex line_in_use;
    io::ProgressLine line(label.empty());

    const auto work = [&] {
        for (long k = next++; k < count; k = next++) {
            try {
                job(k);
            } catch (...) {
                thrown[k] = std::current_exception();
            }
            const long n = ++done;
            const std::lock_guard lock(line_in_use);
            if (line.is_due()) line.show(fmt::format("{} {}/{}, {:.1f} s", label, n, count, line.seconds()));
        }
    };
    std::vector<std::jthread> team;
    for (long k = 1; k < std::min<long>(threads, count); ++k) team.emplace_back(work);
    work();
    team.clear();  // joins
    line.clear();
    for (const std::exception_ptr& e : thrown)
        if (e) std::rethrow_exception(e);
}

void Pool::run(const std::function<void(long)>& job, const Transfer& transfer, const Lost& lost) const
{
    if (sharing == nullptr) {
        run(job);
        return;
    }
    FinishedJobs* const finished = sharing->finished;
    const long pool = finished == nullptr ? 0 : finished->next_pool();
    if (sharing->ranks != nullptr) {
        run_on_ranks(pool, job, transfer, lost);
    } else {
        run([&](long k) {
            if (!sharing->shard.has(k)) return;
            const auto result = [&](io::Archive& a) { transfer(a, k); };
            if (finished != nullptr && finished->restore({pool, k}, result)) return;
            job(k);
            if (finished != nullptr) finished->keep({pool, k}, result);
        });
    }
    if (sharing->shard.is_part()) throw PartDone{};
}

void Pool::run_on_ranks(long pool, const std::function<void(long)>& job, const Transfer& transfer,
                        const Lost& lost) const
{
    Ranks& ranks = *sharing->ranks;
    const auto compute = [&](long k) {
        job(k);
        io::Archive a;
        transfer(a, k);
        return a.bytes();
    };
    if (!ranks.is_first()) {
        ranks.work(threads, compute);
        throw PartDone{};
    }
    FinishedJobs* const finished = sharing->finished;
    std::deque<long> jobs;
    for (long k = 0; k < count; ++k) {
        const auto result = [&](io::Archive& a) { transfer(a, k); };
        if (!sharing->shard.has(k) || (finished != nullptr && finished->restore({pool, k}, result))) continue;
        jobs.push_back(k);
    }
    std::optional<JobEnd> thrown;  // with the lowest number
    long done = count - static_cast<long>(jobs.size());
    io::ProgressLine line(label.empty());
    ranks.distribute(std::move(jobs), threads, compute, [&](const JobEnd& end) {
        const auto result = [&](io::Archive& a) { transfer(a, end.job); };
        if (end.kind == JobEnd::computed) {
            io::Archive a(end.text, "the result of a run");
            result(a);
            a.end();
            if (finished != nullptr) finished->keep({pool, end.job}, result);
        } else if (end.kind == JobEnd::threw) {
            if (!thrown || end.job < thrown->job) thrown = end;
        } else {
            sharing->lost.push_back(end.text);
            if (lost) lost(end.job, end.text);
        }
        ++done;
        if (line.is_due()) line.show(fmt::format("{} {}/{}, {:.1f} s", label, done, count, line.seconds()));
    });
    line.clear();
    if (thrown) thrown->rethrow();
}

}  // namespace hilda::studies
