// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/cosim/channel.hpp"

#include "io/descriptor.hpp"

#include <bit>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>

#include <unistd.h>

namespace hilda::granular {

static_assert(std::endian::native == std::endian::little);

PipeChannel::PipeChannel(int in, int out, std::string peer) : in(in), out(out), peer(std::move(peer))
{
    // A write to a process that has ended is an error, not a signal.
    std::signal(SIGPIPE, SIG_IGN);
}

PipeChannel::~PipeChannel()
{
    close(in);
    if (out != in) close(out);
}

void PipeChannel::send(const std::string& message)
{
    const std::uint64_t length = message.size();
    std::string all(sizeof length, '\0');
    std::memcpy(all.data(), &length, sizeof length);
    all += message;
    if (io::write_all(out, all.data(), all.size()) < all.size())
        throw ExchangeLost(peer + " has ended during an exchange: " + std::strerror(errno));
}

std::string PipeChannel::receive()
{
    constexpr std::uint64_t most = std::uint64_t{1} << 30;
    std::uint64_t length = 0;
    read(&length, sizeof length);
    if (length > most)
        throw ExchangeLost(peer + ": the length of a message must be at most 2^30 bytes, got " +
                           std::to_string(length));
    std::string message(length, '\0');
    read(message.data(), length);
    return message;
}

void PipeChannel::read(void* to, std::size_t count)
{
    if (io::read_all(in, to, count) == count) return;
    throw ExchangeLost(peer + (errno == 0 ? " has ended during an exchange"
                                          : std::string(" cannot be read: ") + std::strerror(errno)));
}

}  // namespace hilda::granular
