// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/distributed/plan.hpp"

#include <limits>
#include <stdexcept>
#include <string>

namespace hilda::granular {

namespace {

constexpr int tag = 11;

void check_transfer(int code, const char* function)
{
    if (code < 0) throw std::runtime_error(std::string(function) + " of Zoltan has failed");
}

}  // namespace

Plan::Plan(const Communicator& all, std::vector<int> to) : all(all)
{
    check_transfer(Zoltan_Comm_Create(&plan, static_cast<int>(to.size()), to.data(), all.handle(), tag,
                                      &number_received),
                   "Zoltan_Comm_Create");
    int sends = 0, receives = 0, values = 0, total = 0, own = 0, most = 0;
    check_transfer(Zoltan_Comm_Info(plan, &sends, nullptr, nullptr, &values, &most, nullptr, &receives,
                                    nullptr, nullptr, &total, nullptr, nullptr, &own),
                   "Zoltan_Comm_Info");
    std::vector<int> to_process(static_cast<std::size_t>(sends) + 1), to_count(to_process.size()),
        from_process(static_cast<std::size_t>(receives) + 1), from_count(from_process.size());
    check_transfer(
        Zoltan_Comm_Info(plan, &sends, to_process.data(), to_count.data(), &values, &most, nullptr, &receives,
                         from_process.data(), from_count.data(), &total, nullptr, nullptr, &own),
        "Zoltan_Comm_Info");
    for (int k = 0; k < sends; ++k) groups_sent.push_back({to_process[k], to_count[k]});
    for (int k = 0; k < receives; ++k) groups_received.push_back({from_process[k], from_count[k]});
}

Plan::~Plan() { Zoltan_Comm_Destroy(&plan); }

void Plan::exchange(const char* values, int bytes, char* received) const
{
    // Zoltan and MPI count the bytes of a message by an int.
    for (const auto* groups : {&groups_sent, &groups_received})
        for (const Group& g : *groups)
            if (static_cast<double>(g.values) * bytes > std::numeric_limits<int>::max())
                throw std::runtime_error(
                    "a message of a run on several processes would be longer than 2 GiB; use more "
                    "processes");
    // Zoltan does not change the values.
    check_transfer(Zoltan_Comm_Do(plan, tag, const_cast<char*>(values), bytes, received), "Zoltan_Comm_Do");
}

}  // namespace hilda::granular
