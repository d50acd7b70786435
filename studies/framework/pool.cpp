// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/pool.hpp"

#include "io/progress.hpp"
#include "studies/running/finished_jobs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
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

void Pool::run(const std::function<void(long)>& job,
               const std::function<void(io::Archive&, long)>& transfer) const
{
    if (finished == nullptr) {
        run(job);
        return;
    }
    const long pool = finished->next_pool();
    run([&](long k) {
        const auto result = [&](io::Archive& a) { transfer(a, k); };
        if (finished->restore({pool, k}, result)) return;
        job(k);
        finished->keep({pool, k}, result);
    });
}

}  // namespace hilda::studies
