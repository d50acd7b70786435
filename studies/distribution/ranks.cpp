// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/distribution/ranks.hpp"

#include "io/archive.hpp"
#include "io/message.hpp"

#include <fmt/format.h>

#include <thread>

namespace hilda::studies {

namespace {

// Pauses between two looks at the messages [µs]. Each look costs about 20 µs of the time of a run. The end of
// an own run ends a pause.
constexpr long pause = 300;         // of a rank that waits for a run
constexpr long pause_first = 1000;  // of rank 0
constexpr long pause_busy = 50000;  // of another rank that can start no run
constexpr auto interval_of_signs = std::chrono::seconds(1);
/// A rank on another machine that computes a job and sends nothing for this time counts as lost.
constexpr auto longest_silence = std::chrono::seconds(60);
constexpr auto interval_of_looks = std::chrono::milliseconds(100);

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
{}

Ranks::~Ranks()
{
    if (is_first()) {
        for (int r = 1; r < count(); ++r) all->send(r, std::string(1, stop));
        return;
    }
    while (!stopped && !all->is_gone(0)) {
        if (const auto received = all->receive())
            stopped = received->message.front() == stop;
        else
            std::this_thread::sleep_for(std::chrono::microseconds(pause));
    }
}

void Ranks::distribute(std::deque<long> jobs, int processes, const Compute& compute,
                       const std::function<void(const JobEnd&)>& ended)
{
    JobProcesses own(processes, compute);
    size_t left = jobs.size();
    const auto count_and_report = [&](const JobEnd& end) {
        --left;
        ended(end);
    };
    const auto next = [&] {
        const long k = jobs.front();
        jobs.pop_front();
        return k;
    };
    Clock::time_point looked = Clock::now();
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
        if (const auto now = Clock::now(); now - looked > interval_of_looks) {
            looked = now;
            look_for_lost(count_and_report);
        }
    }
}

void Ranks::receive_from(Other& other, const Communicator::Received& received,
                         const std::function<void(const JobEnd&)>& ended)
{
    if (other.is_gone) return;  // its jobs are reported as lost
    other.heard = Clock::now();
    const std::string content = received.message.substr(1);
    switch (received.message.front()) {
        case ready:
            ++other.free;
            break;
        case result: {
            const JobEnd end = end_in(content);
            ++other.free;
            other.jobs.erase(end.job);
            ended(end);
            break;
        }
        case failed:
            io::warning(fmt::format("rank {} computes no runs: {}", received.from, content));
            break;
        default:
            break;
    }
}

/// Reports the jobs of ranks that have ended.
void Ranks::look_for_lost(const std::function<void(const JobEnd&)>& ended)
{
    for (int r = 1; r < count(); ++r) {
        Other& other = others[r];
        const bool is_silent = !other.jobs.empty() && Clock::now() - other.heard > longest_silence;
        if (other.is_gone || !(all->is_gone(r) || is_silent)) continue;
        other.is_gone = true;
        for (const long k : std::exchange(other.jobs, {}))
            ended({.job = k, .kind = JobEnd::killed, .text = fmt::format("rank {} of mpirun has ended", r)});
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
        if (const auto now = Clock::now(); now - sent > interval_of_signs) {
            sent = now;
            all->send(0, std::string(1, alive));
        }
    }
}

}  // namespace hilda::studies
