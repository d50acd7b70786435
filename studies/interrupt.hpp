// SPDX-License-Identifier: GPL-3.0-or-later
/// Ctrl-C and SIGTERM ask a run to stop after the step it is in; a second one stops it at once.

#pragma once

namespace hilda::studies {

/// While one of these lives, SIGINT and SIGTERM are noted instead of ending the program.
class Interrupt {
public:
    Interrupt();
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    /// The signal that came, or 0
    static int caught();
};

}  // namespace hilda::studies
