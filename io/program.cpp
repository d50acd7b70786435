// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/program.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/message.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <iostream>
#include <iterator>
#include <utility>

namespace hilda::io {

namespace {

volatile std::sig_atomic_t signal_caught = 0;

timespec time_of_signal{};

/// A second signal ends the program, unless it is the same one again at once: timeout(1) sends its signal to
/// the process and then to the group of the process.
extern "C" void record_signal(int signal)
{
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    const double since = static_cast<double>(now.tv_sec - time_of_signal.tv_sec) +
                         1e-9 * static_cast<double>(now.tv_nsec - time_of_signal.tv_nsec);
    if (signal_caught == signal && since < 0.2) return;
    if (signal_caught != 0) _exit(128 + signal);
    time_of_signal = now;
    signal_caught = signal;
}

// Text of EndOnSignal. A signal handler must not allocate.
char last_message[4096];
std::size_t last_message_length = 0;

extern "C" void end_with_message(int signal)
{
    if (last_message_length > 0 && ::write(STDERR_FILENO, last_message, last_message_length) < 0) {
    }
    _exit(128 + signal);
}

constexpr int interrupts[] = {SIGINT, SIGTERM, SIGHUP};

void handle(void (*handler)(int))
{
    struct sigaction action {};
    action.sa_handler = handler;
    action.sa_flags = SA_RESTART;
    for (const int signal : interrupts) {
        struct sigaction present {};
        // nohup ignores SIGHUP: the program then survives the end of its terminal
        if (signal == SIGHUP && sigaction(signal, nullptr, &present) == 0 && present.sa_handler == SIG_IGN)
            continue;
        sigaction(signal, &action, nullptr);
    }
}

/// Opens the standard descriptors that are closed. Otherwise a file or a pipe would have the number of one of
/// them, and receive the messages. Output to them fails as before.
void open_standard_descriptors()
{
    for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (fcntl(standard, F_GETFD) < 0 && ::open("/dev/null", O_RDONLY) < 0) return;
}

}  // namespace

int run_program(const std::function<int()>& program)
{
    open_standard_descriptors();
    std::signal(SIGXFSZ, SIG_IGN);  // write() then fails with EFBIG, and the message names the file
    try {
        const int code = program();
        if (!std::cout.flush() || std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
            throw IoError("standard output: cannot be written");
        return code;
    } catch (const std::exception& error) {
        std::cout.flush();
        return report(error);
    }
}

void check_output_directory(const std::string& directory, bool accepted, const std::string& remedies)
{
    if (!is_missing_or_empty(directory) && !accepted)
        throw UsageError(directory + ": is not empty; " + remedies);
}

OutputLock::OutputLock(std::string directory, bool accepted, std::string remedies)
    : directory(std::move(directory)), accepted(accepted), remedies(std::move(remedies))
{
    acquire();
}

OutputLock::~OutputLock()
{
    if (descriptor >= 0) close(descriptor);
}

void OutputLock::create()
{
    if (descriptor >= 0) return;
    make_directory(directory);
    acquire();
}

void OutputLock::acquire()
{
    descriptor = open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return;
    // The grains of a co-simulation that has been killed complete their checkpoint before they end.
    constexpr int trials = 20;
    constexpr useconds_t between = 50000;  // [us]
    for (int trial = 1; trial <= trials; ++trial) {
        if (flock(descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return refuse_files();
        if (trial < trials) usleep(between);
    }
    close(descriptor);
    descriptor = -1;
    throw IoError(directory + ": another process writes to it; wait for its end, or give another --output");
}

void OutputLock::refuse_files()
{
    try {
        check_output_directory(directory, accepted, remedies);
    } catch (...) {
        close(descriptor);
        descriptor = -1;
        throw;
    }
}

void Verbosity::warn(const std::string& what) const
{
    if (!quiet) warning(what);
}

void Verbosity::log(const std::string& what) const
{
    if (verbose && !quiet) message("hilda: " + what + '\n');
}

Interrupt::Interrupt()
{
    static_assert(std::size(decltype(before){}) == std::size(interrupts));
    for (size_t k = 0; k < std::size(interrupts); ++k) sigaction(interrupts[k], nullptr, &before[k]);
    handle(record_signal);
}
Interrupt::~Interrupt()
{
    for (size_t k = 0; k < std::size(interrupts); ++k) sigaction(interrupts[k], &before[k], nullptr);
}
EndOnSignal::EndOnSignal(const std::string& message)
{
    const std::string line = "hilda: " + message + '\n';
    last_message_length = message.empty() ? 0 : line.copy(last_message, sizeof last_message);
    handle(end_with_message);
}
EndOnSignal::~EndOnSignal() { handle(SIG_DFL); }
void EndOnSignal::ignore() { handle(SIG_IGN); }

int Interrupt::caught() { return signal_caught; }
void Interrupt::forget() { signal_caught = 0; }

}  // namespace hilda::io
