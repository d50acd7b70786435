// SPDX-License-Identifier: GPL-3.0-or-later
/// Messages between two processes.

#pragma once

#include "io/error.hpp"

#include <string>

namespace hilda::granular {

/// The other process has ended or has sent something else than a message.
class ExchangeLost : public io::NumericalFailure {
public:
    explicit ExchangeLost(const std::string& what) : NumericalFailure("exchange_lost", what) {}
};

/// Sends and receives messages. The functions throw ExchangeLost.
class Channel {
public:
    Channel() = default;
    Channel(const Channel&) = delete;
    Channel& operator=(const Channel&) = delete;
    virtual ~Channel() = default;

    virtual void send(const std::string& message) = 0;
    virtual std::string receive() = 0;
};

/// A channel over two file descriptors, which it closes. A message is its length in eight bytes, little
/// endian, and its content.
class PipeChannel final : public Channel {
public:
    /// `peer`: name of the other side in messages
    PipeChannel(int in, int out, std::string peer);
    ~PipeChannel() override;

    void send(const std::string& message) override;
    std::string receive() override;

private:
    void read(void* to, std::size_t count);

    const int in, out;
    const std::string peer;
};

}  // namespace hilda::granular
