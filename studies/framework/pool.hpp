// SPDX-License-Identifier: GPL-3.0-or-later
/// Independent jobs, side by side.

#pragma once

#include <functional>
#include <string>

namespace hilda::studies {

class Pool {
public:
    /// `count` jobs on up to `threads` threads. On a terminal a progress line with this label is kept on
    /// stderr; none for "".
    Pool(int threads, std::string label, long count) : threads(threads), label(std::move(label)), count(count)
    {}

    /// Runs job(0) … job(count - 1), each once, begun in this order. Rethrows the first exception, by job
    /// number, once all jobs have ended.
    void run(const std::function<void(long)>& job) const;

private:
    int threads;
    std::string label;
    long count;
};

}  // namespace hilda::studies
