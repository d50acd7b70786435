// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/distributed/communicator.hpp"

#include <sys/prctl.h>

#include <omp.h>

#include <algorithm>
#include <ctime>

namespace hilda::granular {

namespace {

constexpr std::size_t most_bytes = std::size_t{1} << 30;  ///< of a message: MPI counts them by an int

/// Calls f(begin, count) for the pieces of a message.
template <class F>
void each_piece(std::size_t count, const F& f)
{
    for (std::size_t begin = 0; begin < count; begin += most_bytes)
        f(begin, static_cast<int>(std::min(most_bytes, count - begin)));
}

}  // namespace

Communicator::Communicator(MPI_Comm communicator) : communicator(communicator)
{
    MPI_Comm_rank(communicator, &own_rank);
    MPI_Comm_size(communicator, &processes);
    MPI_Comm here = MPI_COMM_NULL;
    MPI_Comm_split_type(communicator, MPI_COMM_TYPE_SHARED, own_rank, MPI_INFO_NULL, &here);
    int processes_here = 1;
    MPI_Comm_size(here, &processes_here);
    MPI_Comm_free(&here);
    // Where there are more processes than cores, the one that is awaited may need this core.
    const bool shares_cores = processes_here > omp_get_num_procs();
    longest_spin = shares_cores ? 0 : 0.002;
    prctl(PR_SET_TIMERSLACK, 1000);  // [ns], of the sleep below; the default is 50 us
}

void Communicator::wait(MPI_Request* requests, int count) const
{
    constexpr int tests = 16;          // between two looks at the clock
    constexpr long longest = 200'000;  // [ns]
    long sleep = 2'000;
    double begin = 0;
    for (;;) {
        for (int k = 0; k < tests; ++k) {
            int done = 0;
            MPI_Testall(count, requests, &done, MPI_STATUSES_IGNORE);
            if (done != 0) return;
        }
        const double now = MPI_Wtime();
        if (begin == 0) begin = now;
        if (now - begin < longest_spin) continue;
        const timespec pause{.tv_sec = 0, .tv_nsec = sleep};
        nanosleep(&pause, nullptr);
        sleep = std::min(longest, 2 * sleep);
    }
}

void Communicator::broadcast(void* bytes, std::size_t count) const
{
    each_piece(count, [&](std::size_t begin, int piece) {
        MPI_Request request = MPI_REQUEST_NULL;
        MPI_Ibcast(static_cast<char*>(bytes) + begin, piece, MPI_BYTE, 0, communicator, &request);
        wait(&request, 1);
    });
}

void Communicator::send(int to, const void* bytes, std::size_t count) const
{
    each_piece(count, [&](std::size_t begin, int piece) {
        MPI_Request request = MPI_REQUEST_NULL;
        MPI_Isend(static_cast<const char*>(bytes) + begin, piece, MPI_BYTE, to, 0, communicator, &request);
        wait(&request, 1);
    });
}

void Communicator::receive(int from, void* bytes, std::size_t count) const
{
    each_piece(count, [&](std::size_t begin, int piece) {
        MPI_Request request = MPI_REQUEST_NULL;
        MPI_Irecv(static_cast<char*>(bytes) + begin, piece, MPI_BYTE, from, 0, communicator, &request);
        wait(&request, 1);
    });
}

}  // namespace hilda::granular
