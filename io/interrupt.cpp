// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/interrupt.hpp"

#include <unistd.h>

#include <csignal>
#include <initializer_list>

namespace hilda::io {

namespace {

volatile std::sig_atomic_t signal_caught = 0;

extern "C" void record_signal(int signal)
{
    if (signal_caught != 0) _exit(128 + signal);
    signal_caught = signal;
}

void handle(void (*handler)(int))
{
    struct sigaction action {};
    action.sa_handler = handler;
    action.sa_flags = SA_RESTART;
    for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
}

}  // namespace

Interrupt::Interrupt() { handle(record_signal); }
Interrupt::~Interrupt() { handle(SIG_DFL); }
int Interrupt::caught() { return signal_caught; }

}  // namespace hilda::io
