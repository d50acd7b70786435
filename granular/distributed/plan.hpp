// SPDX-License-Identifier: GPL-3.0-or-later
/// A plan of messages between processes, by Zoltan: which values go to which process.

#pragma once

#include "granular/distributed/communicator.hpp"

#include <zoltan_comm.h>

#include <type_traits>
#include <vector>

namespace hilda::granular {

class Plan {
public:
    /// Messages to or from one process
    struct Group {
        int process, values;
    };

    /// `to`: the process to which each value goes, in ascending order
    Plan(const Communicator& all, std::vector<int> to);
    ~Plan();
    Plan(const Plan&) = delete;
    Plan& operator=(const Plan&) = delete;

    /// Sends the values, one for each element of `to`, and returns those of the other processes. Their order
    /// is the same in each exchange.
    template <class T>
    std::vector<T> exchange(const std::vector<T>& values) const
    {
        static_assert(std::is_trivially_copyable_v<T>);
        std::vector<T> received(static_cast<std::size_t>(number_received));
        exchange(reinterpret_cast<const char*>(values.data()), sizeof(T),
                 reinterpret_cast<char*>(received.data()));
        return received;
    }
    /// The groups in the order of the values
    const std::vector<Group>& sent() const { return groups_sent; }
    const std::vector<Group>& received() const { return groups_received; }

private:
    void exchange(const char* values, int bytes, char* received) const;

    const Communicator& all;
    ZOLTAN_COMM_OBJ* plan = nullptr;
    int number_received = 0;
    std::vector<Group> groups_sent, groups_received;
};

}  // namespace hilda::granular
