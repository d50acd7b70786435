// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/pool.hpp"

#include "studies/message.hpp"

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace hilda::studies {

void Pool::run(const std::function<void(long)>& job) const
{
    std::atomic<long> next{0}, done{0};
    std::vector<std::exception_ptr> thrown(count);
    std::mutex line;
    const bool show = !label.empty() && isatty(STDERR_FILENO) != 0;
    const auto begin = std::chrono::steady_clock::now();
    auto shown = begin;

    const auto work = [&] {
        for (long k = next++; k < count; k = next++) {
            try {
                job(k);
            } catch (...) {
                thrown[k] = std::current_exception();
            }
            const long n = ++done;
            const std::lock_guard lock(line);
            const auto now = std::chrono::steady_clock::now();
            if (!show || (n < count && now - shown < std::chrono::milliseconds(200))) continue;
            shown = now;
            const double seconds = std::chrono::duration<double>(now - begin).count();
            message(fmt::format("\r{} {}/{}, {:.1f} s\033[K{}", label, n, count, seconds,
                                n == count ? "\r\033[K" : ""));
        }
    };
    std::vector<std::jthread> team;
    for (long k = 1; k < std::min<long>(threads, count); ++k) team.emplace_back(work);
    work();
    team.clear();  // joins
    for (const std::exception_ptr& e : thrown)
        if (e) std::rethrow_exception(e);
}

}  // namespace hilda::studies
