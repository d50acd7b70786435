// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/cosim/rank_channel.hpp"

#include <string>

#include <sched.h>

namespace hilda::run {

RankChannel::~RankChannel()
{
    try {
        all->send(peer, "");
    } catch (const io::Failure&) {  // the other side tests whether this process exists
    }
}

std::string RankChannel::lost() const
{
    return "rank " + std::to_string(peer) + " has ended during an exchange";
}

void RankChannel::send(const std::string& message)
{
    if (all->is_gone(peer)) throw granular::ExchangeLost(lost());
    all->send(peer, message);
}

std::string RankChannel::receive()
{
    constexpr int polls = 1000;  // between two tests whether the other rank exists
    bool gone = false;
    for (int k = 1;; ++k) {
        if (auto received = all->receive()) {
            if (received->message.empty()) throw RankClosed(lost());
            return std::move(received->message);
        }
        if (gone) throw granular::ExchangeLost(lost());
        gone = k % polls == 0 && all->is_gone(peer);  // its last message may have arrived
        sched_yield();
    }
}

}  // namespace hilda::run
