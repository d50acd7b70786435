// SPDX-License-Identifier: GPL-3.0-or-later
// The threads of the loops on the CPU.
//
// A loop is divided into one part per thread. The calling thread executes the first part, and then every part
// that no other thread has begun. It waits only for threads that are within their parts. A thread that the
// operating system does not run, because other programs use the cores, delays a loop only if it is stopped
// within its part. At the end of a parallel region of OpenMP all threads wait for each other, whether they
// have work or not.
#include "granular/backend/par.hpp"

#include <array>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#ifdef __x86_64__
#include <emmintrin.h>
#endif

#include <omp.h>

namespace hilda::granular::par {

namespace {

/// A loop: its number, which does not repeat, in the upper 56 bits, and the number of its parts in the others
using Loop = std::uint64_t;
constexpr Loop one_loop = 256;
constexpr Loop number_of(Loop loop) { return loop / one_loop; }
constexpr int parts_of(Loop loop) { return static_cast<int>(loop % one_loop); }
static_assert(most_parts < one_loop);

/// A thread that waits reads the value so many times, about 60 us on x86, before it sleeps. The serial parts
/// of a step of 10 000 particles are shorter; a thread that sleeps in them starts its next part late.
constexpr int polls = 3000;

void pause()
{
#ifdef __x86_64__
    _mm_pause();
#endif
}

/// Waits until the value differs from `old`. Returns the new value.
Loop wait_for_change(const std::atomic<Loop>& value, Loop old)
{
    for (int k = 0; k < polls; ++k) {
        const Loop now = value.load(std::memory_order_acquire);
        if (now != old) return now;
        pause();
    }
    value.wait(old, std::memory_order_seq_cst);
    return value.load(std::memory_order_acquire);
}
/// Stores the value and wakes the threads that wait for its change. The store must be visible before the
/// number of waiting threads is read.
void publish(std::atomic<Loop>& value, Loop now)
{
    value.store(now, std::memory_order_seq_cst);
    value.notify_all();
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
        if (in_use.test_and_set(std::memory_order_acquire)) {
            for (int p = 0; p < parts; ++p) f(with, p);
            return;
        }
        add_threads(parts - 1);
        part = f, context = with, failure = nullptr;
        const Loop now = announce(parts);
        execute(0);
        std::array<bool, most_parts> by_others{};
        for (int p = 1; p < parts; ++p) {
            by_others[p] = !begin(p, now);
            if (!by_others[p]) execute(p);
        }
        for (int p = 1; p < parts; ++p) {
            const std::atomic<Loop>& done = state[p].done;
            for (Loop last = done.load(std::memory_order_acquire); by_others[p] && last != now;)
                last = wait_for_change(done, last);
        }
        const std::exception_ptr thrown = failure;
        in_use.clear(std::memory_order_release);
        if (thrown) std::rethrow_exception(thrown);
    }

private:
    /// Starts threads until there are so many, or the system refuses one.
    void add_threads(int many)
    {
        while (!refused && static_cast<int>(threads.size()) < many) {
            const int p = static_cast<int>(threads.size()) + 1;
            try {
                threads.emplace_back([this, p, now = loop.load()] { work(p, now); });
            } catch (const std::system_error&) {
                refused = true;
            }
        }
    }

    /// Publishes a loop to the threads.
    Loop announce(int parts)
    {
        const Loop now =
            (number_of(loop.load(std::memory_order_relaxed)) + 1) * one_loop + static_cast<Loop>(parts);
        publish(loop, now);
        return now;
    }

    /// Takes part p of a loop; false if it has been taken. All parts are taken before the next loop begins,
    /// so that a thread that was not run for some time cannot take a part of a loop that has ended.
    bool begin(int p, Loop now)
    {
        Loop last = state[p].begun.load(std::memory_order_relaxed);
        return number_of(now) > number_of(last) &&
               state[p].begun.compare_exchange_strong(last, now, std::memory_order_acq_rel);
    }

    /// Executes a part of the present loop. The first exception is thrown by run() when all parts are done.
    void execute(int p)
    {
        try {
            part(context, p);
        } catch (...) {
            const std::lock_guard<std::mutex> lock(failure_in_use);
            if (!failure) failure = std::current_exception();
        }
    }

    void work(int p, Loop last)
    {
        for (;;) {
            last = wait_for_change(loop, last);
            if (ends) return;
            if (p >= parts_of(last) || !begin(p, last)) continue;
            execute(p);
            publish(state[p].done, last);
        }
    }

    /// The last loops of which the part was begun, and was done by the thread of the team
    struct alignas(64) PartState {
        std::atomic<Loop> begun{0}, done{0};
    };

    std::atomic_flag in_use;
    bool refused = false;  ///< the system has refused a thread
    std::vector<std::thread> threads;
    std::array<PartState, most_parts> state{};
    alignas(64) std::atomic<Loop> loop{0};  ///< the present one
    std::atomic<bool> ends{false};
    // of the present loop
    void (*part)(const void*, int) = nullptr;
    const void* context = nullptr;
    std::exception_ptr failure;
    std::mutex failure_in_use;
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
