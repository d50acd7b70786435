// SPDX-License-Identifier: GPL-3.0-or-later
/// Messages between the two ranks of a co-simulation under mpirun.

#pragma once

#include "granular/cosim/channel.hpp"
#include "run/cosim/communicator.hpp"

#include <memory>

namespace hilda::run {

/// The other rank has closed its channel.
class RankClosed final : public granular::ExchangeLost {
public:
    using ExchangeLost::ExchangeLost;
};

/// A channel to another rank. It waits actively, because an exchange takes microseconds. Its destructor
/// notifies the other side, whose receive() throws RankClosed then.
class RankChannel final : public granular::Channel {
public:
    RankChannel(std::unique_ptr<Communicator> communicator, int peer)
        : all(std::move(communicator)), peer(peer)
    {}

    ~RankChannel() override;

    void send(const std::string& message) override;
    std::string receive() override;

private:
    std::string lost() const;

    std::unique_ptr<Communicator> all;
    int peer;
};

}  // namespace hilda::run
