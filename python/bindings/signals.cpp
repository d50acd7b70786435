// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bindings/signals.hpp"

namespace hilda::python {

namespace {

// The clock is read every few steps: that takes 20 ns, and a short step 500 ns. Steps of more than 10 ms read
// it each time.
constexpr unsigned most_steps = 8;
constexpr std::chrono::milliseconds long_steps{80};
constexpr std::chrono::milliseconds interval{100};

}  // namespace

thread_local Signals* Signals::of_run = nullptr;

Signals::Signals() : before(of_run) { of_run = this; }
Signals::~Signals() { of_run = before; }

bool Signals::raised()
{
    if (exception) return true;
    if (++calls < steps) return false;
    calls = 0;
    const Clock::time_point now = Clock::now();
    steps = now - read > long_steps ? 1 : most_steps;
    read = now;
    if (now - last < interval) return false;
    last = now;
    const py::gil_scoped_acquire gil;
    if (PyErr_CheckSignals() == 0) return false;
    exception.emplace();
    return true;
}

bool Signals::raised_in_run() { return of_run != nullptr && of_run->raised(); }

}  // namespace hilda::python
