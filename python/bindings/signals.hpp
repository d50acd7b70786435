// SPDX-License-Identifier: GPL-3.0-or-later
/// Signals of Python during a run, such as that of Ctrl-C.

#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <optional>

namespace hilda::python {

namespace py = pybind11;

/// Calls the signal handlers of Python every tenth of a second while a run of this thread has released the
/// GIL.
class Signals {
public:
    Signals();
    ~Signals();
    Signals(const Signals&) = delete;
    Signals& operator=(const Signals&) = delete;

    /// Whether a signal handler has raised an exception. Called for each step.
    bool raised();
    /// The same for the run of this thread: lie::Settings::stop
    static bool raised_in_run();
    /// The exception of the signal handler
    const std::optional<py::error_already_set>& error() const { return exception; }

private:
    using Clock = std::chrono::steady_clock;
    static thread_local Signals* of_run;

    Signals* const before;
    std::optional<py::error_already_set> exception;
    Clock::time_point last = Clock::now(), read = last;  ///< of the handlers, and of the clock
    unsigned calls = 0, steps = 1;                       ///< since the clock was read; until it is read
};

}  // namespace hilda::python
