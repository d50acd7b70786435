// SPDX-License-Identifier: GPL-3.0-or-later
/// Concurrent execution of independent jobs.

#pragma once

#include <functional>
#include <string>

namespace hilda::studies {

class Pool {
public:
    /// `count` jobs on at most `threads` threads. On a terminal a progress line with this label is shown on
    /// stderr; none for "".
    Pool(int threads, std::string label, long count) : threads(threads), label(std::move(label)), count(count)
    {}

    /// Calls job(0) … job(count - 1), each once, started in this order. After all jobs have ended, rethrows
    /// the exception of the lowest job number.
    void run(const std::function<void(long)>& job) const;

private:
    int threads;
    std::string label;
    long count;
};

}  // namespace hilda::studies
