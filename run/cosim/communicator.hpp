// SPDX-License-Identifier: GPL-3.0-or-later
/// Messages between the processes (ranks) that mpirun has started, for co-simulations.

#pragma once

#include <memory>
#include <optional>
#include <string>

namespace hilda::run {

class Communicator {
public:
    virtual ~Communicator() = default;
    virtual int rank() const = 0;
    virtual int size() const = 0;
    /// Returns when the message is on its way. A message to a rank that is gone is dropped.
    virtual void send(int to, const std::string& message) = 0;

    struct Received {
        int from = 0;
        std::string message;
    };
    /// The next message that has arrived; does not wait
    virtual std::optional<Received> receive() = 0;
    /// Whether the process of a rank has ended. Known for ranks on the same machine only; false for others.
    virtual bool is_gone(int rank) const = 0;
    virtual bool is_on_this_machine(int rank) const = 0;
};

/// Number of ranks and number of this rank according to the environment of Open MPI; 1 and 0 without mpirun
int ranks_of_environment();
int rank_of_environment();

/// Loads hilda-mpi.so and initialises MPI. io::NotAvailable if the program was built without MPI.
std::unique_ptr<Communicator> make_communicator();

}  // namespace hilda::run
