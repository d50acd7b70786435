// SPDX-License-Identifier: GPL-3.0-or-later
/// The module hilda-mpi.so: a Communicator by MPI.

#include "run/cosim/communicator.hpp"

#include "io/error.hpp"

#include <mpi.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <climits>
#include <csignal>
#include <cstring>
#include <thread>
#include <vector>

namespace hilda::run {

namespace {

constexpr int tag = 1;

/// The process of a rank
struct Place {
    std::array<char, 64> machine{};
    pid_t process = 0;
};

class Mpi final : public Communicator {
public:
    Mpi()
    {
        int provided = 0;
        if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided) != MPI_SUCCESS)
            throw io::NotAvailable("MPI cannot be initialised");
        // The end of another rank must not end this one.
        MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
        MPI_Comm_rank(MPI_COMM_WORLD, &own_rank);
        MPI_Comm_size(MPI_COMM_WORLD, &ranks);
        Place here;
        gethostname(here.machine.data(), here.machine.size() - 1);
        here.process = getpid();
        places.resize(static_cast<size_t>(ranks));
        MPI_Allgather(&here, sizeof here, MPI_BYTE, places.data(), sizeof here, MPI_BYTE, MPI_COMM_WORLD);
    }
    ~Mpi() override
    {
        // MPI_Finalize waits for all ranks. Open MPI does not finalise after the end of one of them.
        for (int r = 0; r < ranks; ++r)
            if (is_gone(r)) return;
        MPI_Finalize();
    }
    Mpi(const Mpi&) = delete;
    Mpi& operator=(const Mpi&) = delete;

    int rank() const override { return own_rank; }
    int size() const override { return ranks; }

    void send(int to, const std::string& message) override
    {
        if (message.size() > INT_MAX) throw io::IoError("MPI: the result of a run has more than 2 GiB");
        if (is_gone(to)) return;
        MPI_Request request = MPI_REQUEST_NULL;
        auto copy = std::make_unique<std::string>(message);
        int sent = 0;
        bool failed = MPI_Isend(copy->data(), static_cast<int>(copy->size()), MPI_BYTE, to, tag,
                                MPI_COMM_WORLD, &request) != MPI_SUCCESS;
        while (!failed) {
            failed = MPI_Test(&request, &sent, MPI_STATUS_IGNORE) != MPI_SUCCESS;
            if (sent != 0) return;
            failed = failed || is_gone(to);
            if (!failed) std::this_thread::sleep_for(std::chrono::microseconds(100));
        }
        if (request != MPI_REQUEST_NULL) MPI_Request_free(&request);
        not_sent.push_back(std::move(copy));  // MPI may still use it
    }

    std::optional<Received> receive() override
    {
        int is_there = 0, bytes = 0;
        MPI_Status status{};
        if (MPI_Iprobe(MPI_ANY_SOURCE, tag, MPI_COMM_WORLD, &is_there, &status) != MPI_SUCCESS ||
            is_there == 0)
            return std::nullopt;
        MPI_Get_count(&status, MPI_BYTE, &bytes);
        Received received{.from = status.MPI_SOURCE,
                          .message = std::string(static_cast<size_t>(bytes), '\0')};
        if (MPI_Recv(received.message.data(), bytes, MPI_BYTE, received.from, tag, MPI_COMM_WORLD,
                     MPI_STATUS_IGNORE) != MPI_SUCCESS)
            return std::nullopt;
        return received;
    }

    bool is_gone(int rank) const override
    {
        return is_on_this_machine(rank) && kill(places[static_cast<size_t>(rank)].process, 0) != 0 &&
               errno == ESRCH;
    }
    bool is_on_this_machine(int rank) const override
    {
        return places[static_cast<size_t>(rank)].machine == places[static_cast<size_t>(own_rank)].machine;
    }

private:
    int own_rank = 0, ranks = 1;
    std::vector<Place> places;
    std::vector<std::unique_ptr<std::string>> not_sent;
};

}  // namespace

}  // namespace hilda::run

extern "C" void hilda_mpi(std::unique_ptr<hilda::run::Communicator>& to)
{
    to = std::make_unique<hilda::run::Mpi>();
}
