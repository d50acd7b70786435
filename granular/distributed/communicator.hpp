// SPDX-License-Identifier: GPL-3.0-or-later
/// Messages between the processes of a run. All functions are called by all processes in the same order.

#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

namespace hilda::granular {

/// Work of the busiest process over the mean, minus 1: as predicted when the domain was divided last, and as
/// measured in periods of at least 1000 steps
struct Imbalance {
    double predicted = 0;  ///< by the last division of the domain
    double busiest = 0;    ///< CPU time of the busiest process of each period, summed over the periods [s]
    double mean = 0;       ///< of the mean over the processes [s]
    long divisions = 0;    ///< of the domain during the run

    double measured() const { return mean > 0 ? busiest / mean - 1 : 0; }
};

class Communicator {
public:
    explicit Communicator(MPI_Comm communicator);

    MPI_Comm handle() const { return communicator; }
    int rank() const { return own_rank; }
    int size() const { return processes; }
    bool is_first() const { return own_rank == 0; }

    /// Waits for messages. A process that waits for long sleeps, so that others can use its core.
    void wait(MPI_Request* requests, int count) const;

    /// From the first process to all
    void broadcast(void* bytes, std::size_t count) const;

    /// The sums of the elements of `parts` over the processes by +=, which must not depend on the order; in
    /// the first process
    template <class Part>
    void reduce(Part* parts, std::size_t count) const
    {
        const Reduction<Part>& r = Reduction<Part>::get();
        std::vector<Part> sums(is_first() ? count : 0, Part{});
        MPI_Request request = MPI_REQUEST_NULL;
        MPI_Ireduce(parts, sums.data(), static_cast<int>(count), r.type, r.operation, 0, communicator,
                    &request);
        wait(&request, 1);
        for (std::size_t k = 0; k < sums.size(); ++k) parts[k] = sums[k];
    }
    template <class Part>
    Part reduced(Part part) const
    {
        reduce(&part, 1);
        return part;
    }
    /// The same in all processes
    template <class Part>
    Part reduced_for_all(const Part& part) const
    {
        const Reduction<Part>& r = Reduction<Part>::get();
        Part sum = part;
        MPI_Request request = MPI_REQUEST_NULL;
        MPI_Iallreduce(&part, &sum, 1, r.type, r.operation, communicator, &request);
        wait(&request, 1);
        return sum;
    }

    /// Messages from one process to another, which receives them in the order in which they were sent
    void send(int to, const void* bytes, std::size_t count) const;
    void receive(int from, void* bytes, std::size_t count) const;
    /// `values`: a vector or string
    template <class List>
    void send(int to, const List& values) const
    {
        const std::uint64_t count = values.size();
        send(to, &count, sizeof count);
        send(to, values.data(), count * sizeof(typename List::value_type));
    }
    template <class List>
    void receive(int from, List& values) const
    {
        std::uint64_t count = 0;
        receive(from, &count, sizeof count);
        values.resize(count);
        receive(from, values.data(), count * sizeof(typename List::value_type));
    }

    /// Whether the processes are in a call of the first one: an exception there leaves them out of step.
    mutable bool in_call = false;
    mutable Imbalance imbalance;  ///< of the last engine

private:
    /// MPI's names of a type and of its +=; they are never freed.
    template <class Part>
    struct Reduction {
        static_assert(std::is_trivially_copyable_v<Part>);
        MPI_Datatype type;
        MPI_Op operation;

        static const Reduction& get()
        {
            static const Reduction of_part;
            return of_part;
        }

    private:
        Reduction()
        {
            MPI_Type_contiguous(sizeof(Part), MPI_BYTE, &type);
            MPI_Type_commit(&type);
            MPI_Op_create(add, 1, &operation);
        }
        static void add(void* from, void* to, int* count, MPI_Datatype*)
        {
            for (int k = 0; k < *count; ++k) static_cast<Part*>(to)[k] += static_cast<const Part*>(from)[k];
        }
    };

    MPI_Comm communicator;
    int own_rank = 0, processes = 1;
    double longest_spin = 0;  ///< time for which a process waits without sleep [s]
};

}  // namespace hilda::granular
