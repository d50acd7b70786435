// SPDX-License-Identifier: GPL-3.0-or-later
/// What the main functions of the programs have in common.

#pragma once

#include <csignal>
#include <functional>
#include <string>

namespace hilda::io {

/// Runs the program and returns its exit code. Reports an exception on stderr. IoError if standard output
/// cannot be written. A file above the size limit of the process is an IoError as well, not a signal.
int run_program(const std::function<int()>& program);

/// Rejects an output directory that is not empty: UsageError unless `accepted`; IoError if it is not a
/// directory. `remedies` is the end of the message.
void check_output_directory(const std::string& directory, bool accepted, const std::string& remedies);
inline constexpr const char* force_overwrites = "--force overwrites it";
inline constexpr const char* force_or_resume = "--force overwrites it, --resume continues its run";

/// Excludes a second process that writes to the same output directory: an advisory lock (flock) of the
/// directory, without a file, until the end of this object or of the process. File systems without such
/// locks, for example some network file systems, exclude nothing.
class OutputLock {
public:
    /// Locks the directory if it exists. IoError if another process or object holds the lock for a second.
    /// UsageError as of check_output_directory(), with `accepted` and `remedies`, if it contains files once
    /// it is locked: another process may have written them since the directory was checked.
    explicit OutputLock(std::string directory, bool accepted = true, std::string remedies = "");
    ~OutputLock();
    OutputLock(const OutputLock&) = delete;
    OutputLock& operator=(const OutputLock&) = delete;

    /// Creates the directory and its parents if it does not exist, and locks it. Errors as above.
    void create();

private:
    void acquire();
    void refuse_files();

    std::string directory;
    bool accepted;
    std::string remedies;
    int descriptor = -1;
};

/// Messages on stderr that --quiet and --verbose select
struct Verbosity {
    bool quiet = false, verbose = false;

    void warn(const std::string& what) const;
    /// Writes "hilda: WHAT" if `verbose`.
    void log(const std::string& what) const;
};

/// Handling of SIGINT (Ctrl-C), SIGTERM and SIGHUP (end of the terminal): the first signal requests the end
/// of the run, the second terminates the process.
///
/// During the lifetime of an object of this class, the first of these signals is recorded and does not end
/// the program. The handlers of before are restored at its end. Objects may be nested; they share the record.
class Interrupt {
public:
    Interrupt();
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    /// Number of the recorded signal, or 0
    static int caught();
    /// Forgets the recorded signal, in a program that continues after it.
    static void forget();

private:
    struct sigaction before[3] = {};  // of SIGINT, SIGTERM, SIGHUP
};

/// During the lifetime of an object of this class, SIGINT, SIGTERM and SIGHUP end the process at once, with
/// the line "hilda: MESSAGE" on stderr and the exit code 128 + signal. For programs whose files are complete
/// at any time.
class EndOnSignal {
public:
    /// "": no message
    explicit EndOnSignal(const std::string& message);
    ~EndOnSignal();
    /// The signals have no effect from here on, for the last lines of a program whose results are complete.
    static void ignore();
    EndOnSignal(const EndOnSignal&) = delete;
    EndOnSignal& operator=(const EndOnSignal&) = delete;
};

}  // namespace hilda::io
