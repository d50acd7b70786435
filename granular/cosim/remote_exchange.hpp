// SPDX-License-Identifier: GPL-3.0-or-later
/// An exchange with grains in another process: the messages of both sides.

#pragma once

#include "granular/cosim/channel.hpp"
#include "granular/cosim/exchange.hpp"

#include <functional>
#include <memory>

namespace hilda::granular {

/// Version of the messages. Both programs must have the same.
inline constexpr std::uint64_t exchange_version = 2;

/// The grains of the process at the other end of a channel. Exceptions there are thrown here.
class RemoteExchange final : public Exchange {
public:
    /// The grains with the boundaries of these names as tools. Throws io::UsageError if the other program has
    /// another version.
    RemoteExchange(std::unique_ptr<Channel> channel, const std::vector<std::string>& names);

    double h() const override { return step; }
    const std::vector<Tool>& tools() const override { return all; }
    void open(const std::vector<ToolBody>& bodies, long steps) override;
    std::vector<ToolImpulse> loads(const std::vector<ToolMotion>& motions) override;
    void advance(const std::vector<ToolMotion>& motions, long number, std::vector<ToolImpulse>& to) override;
    void stiffness(std::vector<ToolStiffness>& to) override;
    void save() override;
    void close(int code) override;

private:
    std::string call(const std::string& request);

    std::unique_ptr<Channel> channel;
    double step = 0;  ///< [s]
    std::vector<Tool> all;
};

/// Answers the messages of a RemoteExchange until it closes the run. `make` makes the grains with the
/// boundaries of these names as tools.
void serve(Channel& channel,
           const std::function<std::unique_ptr<Exchange>(const std::vector<std::string>& names)>& make);

}  // namespace hilda::granular
