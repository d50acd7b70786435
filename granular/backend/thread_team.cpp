// SPDX-License-Identifier: GPL-3.0-or-later
// The threads of the loops on the CPU.
//
// A loop is divided into one part per thread. The calling thread executes the first part, and then every part
// that no other thread has begun. It waits only for threads that are within their parts. A thread that the
// operating system does not run, because other programs use the cores, therefore does not delay a loop. At
// the end of a parallel region of OpenMP all threads wait for each other, whether they have work or not.
#include "granular/backend/par.hpp"

#include <array>
#include <atomic>
#include <mutex>
#include <thread>
#include <vector>

#ifdef __x86_64__
#include <emmintrin.h>
#endif

#include <omp.h>

namespace hilda::granular::par {

namespace {

/// A loop: its number in the upper 24 bits, modulo 2^24, and the number of its parts in the lower 8
using Loop = std::uint32_t;
constexpr Loop one_loop = 256;
constexpr Loop number_of(Loop loop) { return loop & ~(one_loop - 1); }
constexpr int parts_of(Loop loop) { return static_cast<int>(loop & (one_loop - 1)); }
static_assert(most_parts < one_loop);

/// A thread that waits looks this many times, about 10 us, before it sleeps.
constexpr int looks = 500;

void pause()
{
#ifdef __x86_64__
    _mm_pause();
#endif
}

/// Waits until the value differs from `old`. Returns the new value.
Loop wait_for_change(const std::atomic<Loop>& value, Loop old)
{
    for (int k = 0; k < looks; ++k) {
        const Loop now = value.load(std::memory_order_acquire);
        if (now != old) return now;
        pause();
    }
    value.wait(old, std::memory_order_acquire);
    return value.load(std::memory_order_acquire);
}

class Team {
public:
    ~Team()
    {
        ends = true;
        announce(0);
        for (std::thread& t : threads) t.join();
    }

    void run(int parts, void (*f)(const void*, int), const void* with)
    {
        // A loop within a loop, and one of another thread meanwhile, are executed serially.
        const std::unique_lock<std::mutex> lock(in_use, std::try_to_lock);
        if (!lock.owns_lock()) {
            for (int p = 0; p < parts; ++p) f(with, p);
            return;
        }
        while (static_cast<int>(threads.size()) < parts - 1)
            threads.emplace_back(
                [this, p = static_cast<int>(threads.size()) + 1, now = loop.load()] { work(p, now); });
        part = f, context = with;
        const Loop now = announce(parts);
        f(with, 0);
        std::array<bool, most_parts> by_others{};
        for (int p = 1; p < parts; ++p) {
            by_others[p] = !begin(p, now);
            if (!by_others[p]) f(with, p);
        }
        for (int p = 1; p < parts; ++p) {
            const std::atomic<Loop>& done = state[p].done;
            for (Loop last = done.load(std::memory_order_acquire); by_others[p] && last != now;)
                last = wait_for_change(done, last);
        }
    }

private:
    /// Publishes a loop to the threads.
    Loop announce(int parts)
    {
        const Loop last = loop.load(std::memory_order_relaxed),
                   now = (number_of(last) + one_loop) | static_cast<Loop>(parts);
        loop.store(now, std::memory_order_release);
        loop.notify_all();
        return now;
    }

    /// Takes part p of a loop; false if it has been taken. All parts are taken before the next loop begins,
    /// so that a thread that was not run for some time cannot take a part of a loop that has ended.
    bool begin(int p, Loop now)
    {
        Loop last = state[p].begun.load(std::memory_order_relaxed);
        const bool is_newer = static_cast<std::int32_t>(number_of(now) - number_of(last)) > 0;
        return is_newer && state[p].begun.compare_exchange_strong(last, now, std::memory_order_acq_rel);
    }

    void work(int p, Loop last)
    {
        for (;;) {
            last = wait_for_change(loop, last);
            if (ends) return;
            if (p >= parts_of(last) || !begin(p, last)) continue;
            part(context, p);
            state[p].done.store(last, std::memory_order_release);
            state[p].done.notify_one();
        }
    }

    /// The last loops of which the part was begun, and was done by the thread of the team
    struct alignas(64) PartState {
        std::atomic<Loop> begun{0}, done{0};
    };

    std::mutex in_use;
    std::vector<std::thread> threads;
    std::array<PartState, most_parts> state{};
    alignas(64) std::atomic<Loop> loop{0};  ///< the present one
    std::atomic<bool> ends{false};
    // of the present loop
    void (*part)(const void*, int) = nullptr;
    const void* context = nullptr;
};

}  // namespace

int threads_of_loops()
{
    const int threads = omp_get_max_threads();
    return threads < most_parts ? threads : most_parts;
}

void run_parts(int parts, void (*part)(const void*, int), const void* context)
{
    static Team team;
    team.run(parts, part, context);
}

}  // namespace hilda::granular::par
