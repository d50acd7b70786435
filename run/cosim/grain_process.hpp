// SPDX-License-Identifier: GPL-3.0-or-later
/// hilda-granular as the grains of a co-simulation, in a process of its own.

#pragma once

#include "granular/cosim/remote_exchange.hpp"

#include <memory>
#include <string>
#include <vector>

namespace hilda::run {

/// Starts hilda-granular with these arguments and --exchange, and connects to it, with the
/// boundaries of these names as tools. It ends with this process.
/// Throws io::NotAvailable if the program cannot be started, and io::Failure with its exit code if it ends at
/// once, which has reported its error then.
std::unique_ptr<granular::RemoteExchange> start_grains(const std::vector<std::string>& arguments,
                                                       const std::vector<std::string>& names);

}  // namespace hilda::run
