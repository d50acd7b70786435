// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/distribution/ranks.hpp"

#include "io/archive.hpp"
#include "io/message.hpp"

#include <fmt/format.h>

#include <omp.h>

#include <thread>

namespace hilda::studies {

namespace {

// Pauses between two polls of the messages [µs]. Each poll costs about 20 µs of the time of a run. The end of
// an own run ends a pause.
constexpr long pause = 300;         // of a rank that waits for a run
constexpr long pause_first = 5000;  // of rank 0
constexpr long pause_busy = 50000;  // of another rank that can start no run
constexpr auto interval_of_alive = std::chrono::seconds(1);
/// A rank on another machine that computes a job and sends nothing for this time counts as lost.
constexpr auto longest_silence = std::chrono::seconds(60);
constexpr auto interval_of_tests = std::chrono::milliseconds(100);
constexpr auto longest_pause = std::chrono::seconds(5);

std::string bytes_of(const JobEnd& end)
{
    JobEnd copy = end;
    io::Archive a;
    a.value(copy.job), a.value(copy.kind), a.list(copy.text);
    return a.bytes();
}

JobEnd end_in(const std::string& bytes)
{
    JobEnd end;
    io::Archive a(bytes, "the message of a rank");
    a.value(end.job), a.value(end.kind), a.list(end.text);
    return end;
}

}  // namespace

std::unique_ptr<Ranks> Ranks::start()
{
    if (ranks_of_environment() < 2) return nullptr;
    return std::make_unique<Ranks>(make_communicator());
}

Ranks::Ranks(std::unique_ptr<Communicator> communicator)
    : all(std::move(communicator)), others(static_cast<size_t>(all->size()))
{
    // A process that has used several threads of OpenMP cannot be copied for jobs that use them. Jobs run
    // side by side instead (--jobs).
    omp_set_num_threads(1);
}

Ranks::~Ranks()
{
    if (is_first()) {
        for (int r = 1; r < count(); ++r) all->send(r, std::string(1, stop));
        // A rank that sends a large result waits until it is received.
        std::set<int> open;
        for (int r = 1; r < count(); ++r) open.insert(r);
        const Clock::time_point begin = Clock::now();
        while (!open.empty() && Clock::now() - begin < longest_silence) {
            if (const auto received = all->receive()) {
                if (received->message.front() == ended) open.erase(received->from);
            } else {
                std::erase_if(open, [&](int r) { return all->is_gone(r); });
                std::this_thread::sleep_for(std::chrono::microseconds(pause));
            }
        }
        return;
    }
    while (!stopped && !all->is_gone(0)) {
        if (const auto received = all->receive())
            stopped = received->message.front() == stop;
        else
            std::this_thread::sleep_for(std::chrono::microseconds(pause));
    }
    all->send(0, std::string(1, ended));
}

void Ranks::distribute(std::deque<long> jobs, int processes, const Compute& compute,
                       const std::function<void(const JobEnd&)>& report, const std::function<void()>& wait)
{
    JobProcesses own(processes, compute);
    size_t left = jobs.size();
    const auto count_and_report = [&](const JobEnd& end) {
        --left;
        report(end);
    };
    const auto next = [&] {
        const long k = jobs.front();
        jobs.pop_front();
        return k;
    };
    Clock::time_point tested = Clock::now();
    while (left > 0) {
        while (!jobs.empty() && own.has_free()) own.start(next());
        for (int r = 1; r < count() && !jobs.empty(); ++r)
            for (Other& other = others[r]; other.free > 0 && !other.is_gone && !jobs.empty(); --other.free) {
                const long k = next();
                other.jobs.insert(k);
                all->send(r, job + std::to_string(k));
            }
        if (const auto received = all->receive())
            receive_from(others[received->from], *received, count_and_report);
        else if (const auto end = own.wait(pause_first))
            count_and_report(*end);
        else
            wait();
        if (const auto now = Clock::now(); now - tested > interval_of_tests) {
            // After a pause of this process, as of a suspended one, the others have sent messages.
            const bool paused = now - tested > longest_pause;
            tested = now;
            if (!paused) report_lost_ranks(count_and_report);
        }
    }
}

void Ranks::receive_from(Other& other, const Communicator::Received& received,
                         const std::function<void(const JobEnd&)>& report)
{
    if (other.is_gone) return;  // its jobs are reported as lost
    other.last_message = Clock::now();
    const std::string content = received.message.substr(1);
    switch (received.message.front()) {
        case ready:
            ++other.free;
            break;
        case result: {
            const JobEnd end = end_in(content);
            ++other.free;
            other.jobs.erase(end.job);
            report(end);
            break;
        }
        case failed:
            io::warning(fmt::format("rank {} computes no runs: {}", received.from, content));
            lose(received.from, fmt::format("rank {} of mpirun has failed: {}", received.from, content),
                 report);
            break;
        default:
            break;
    }
}

/// Reports the jobs of a rank as lost. It receives no further ones.
void Ranks::lose(int rank, const std::string& reason, const std::function<void(const JobEnd&)>& report)
{
    Other& other = others[static_cast<size_t>(rank)];
    other.is_gone = true;
    for (const long k : std::exchange(other.jobs, {}))
        report({.job = k, .kind = JobEnd::killed, .text = reason});
}

/// Reports the jobs of ranks that have ended.
void Ranks::report_lost_ranks(const std::function<void(const JobEnd&)>& report)
{
    for (int r = 1; r < count(); ++r) {
        const Other& other = others[static_cast<size_t>(r)];
        const bool is_silent = !all->is_on_this_machine(r) && !other.jobs.empty() &&
                               Clock::now() - other.last_message > longest_silence;
        if (!other.is_gone && (all->is_gone(r) || is_silent))
            lose(r, fmt::format("rank {} of mpirun has ended", r), report);
    }
}

void Ranks::work(int processes, const Compute& compute)
{
    JobProcesses own(processes, compute);
    for (int k = 0; k < processes; ++k) all->send(0, std::string(1, ready));
    Clock::time_point sent = Clock::now();
    while (!stopped && !all->is_gone(0)) {
        if (const auto received = all->receive()) {
            if (received->message.front() == stop)
                stopped = true;
            else
                own.start(std::stol(received->message.substr(1)));
        } else if (const auto end = own.wait(own.has_free() ? pause : pause_busy)) {
            all->send(0, result + bytes_of(*end));
        }
        if (const auto now = Clock::now(); now - sent > interval_of_alive) {
            sent = now;
            all->send(0, std::string(1, alive));
        }
    }
}

}  // namespace hilda::studies
