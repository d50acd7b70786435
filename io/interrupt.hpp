// SPDX-License-Identifier: GPL-3.0-or-later
/// Handling of SIGINT (Ctrl-C) and SIGTERM: the first signal requests the end of the run, the second
/// terminates the process.

#pragma once

namespace hilda::io {

/// During the lifetime of an object of this class, the first SIGINT or SIGTERM is recorded and does not end
/// the program.
class Interrupt {
public:
    Interrupt();
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    /// Number of the recorded signal, or 0
    static int caught();
};

}  // namespace hilda::io
