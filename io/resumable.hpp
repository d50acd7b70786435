// SPDX-License-Identifier: GPL-3.0-or-later
/// A computation in steps with an output directory, which can be interrupted and continued.
///
/// The calls are, in this order:
///
///     lock the directory
///     read()                      the input is read and checked
///     restore()                   with --resume: the last checkpoint, or the one before
///     check()                     no file has been written up to here
///     clear()                     not of a resumed run, after its summary and its checkpoints are removed
///     open()
///     next_step(), ...            checkpoints when they are due, and the progress line
///     end()                       or a last checkpoint of an interrupted run, or failed()
///     close()                     the outputs are complete
///     checkpoint.end              of a complete run, for a later end
///     summary()                   summary.json
///     report()                    after the checkpoints of the unfinished run are removed
///
/// A run that is killed at any of these can be continued, or starts again.

#pragma once

#include "io/archive.hpp"
#include "io/program.hpp"
#include "io/progress.hpp"

#include <chrono>
#include <optional>
#include <string>

namespace hilda::io {

struct ResumableOptions {
    std::string directory;
    double checkpoint = 0;  ///< wall time between two checkpoints [s]; 0: only after an interruption
    bool resume = false, quiet = false, verbose = false;
    bool force = true;  ///< accept files of an earlier run in the directory
};

class Resumable : protected Verbosity {
public:
    virtual ~Resumable() = default;
    Resumable(const Resumable&) = delete;
    Resumable& operator=(const Resumable&) = delete;

protected:
    using Clock = ProgressLine::Clock;

    explicit Resumable(const ResumableOptions& options);

    /// Performs the run and returns the exit code. A numerical failure and an interruption are in
    /// summary.json; other exceptions are thrown on.
    int execute();
    /// The parts of execute(), for a caller that commands the steps. prepare() returns the result of
    /// read().
    bool prepare();
    void march();
    void finish();

    /// Whether there is something to compute. If not, `code` is the exit code.
    virtual bool read() = 0;
    /// Restores a checkpoint. An IoError means that it is damaged.
    virtual void restore(const std::string& bytes, const std::string& file) = 0;
    virtual void check() {}
    /// Removes the files of an earlier run, other than its checkpoints and summary, and writes those of the
    /// input.
    virtual void clear() = 0;
    /// Opens the outputs, and does what precedes the first step.
    virtual void open() = 0;
    virtual bool at_end() const = 0;
    /// Computes a step. Returns false, without a step, at the end or if the step was interrupted.
    virtual bool next_step() = 0;
    /// Is called after the last step.
    virtual void end() = 0;
    /// Is called after a NumericalFailure of open(), next_step() or end(), and reports it.
    virtual void failed(const NumericalFailure& failure);
    /// Ends the output files.
    virtual void close() = 0;
    /// The text of summary.json
    virtual std::string summary() = 0;
    /// Prints the result of a run whose files are complete.
    virtual void report() {}

    virtual double time() const = 0;  ///< of the present state [s]
    /// Shows the progress.
    virtual void show(ProgressLine& on, Clock::time_point now) const = 0;
    /// Is called before each checkpoint: synchronises the outputs with the disk. For that of the end it is
    /// called before close().
    virtual void before_save() {}
    /// Passes the content of a checkpoint on.
    virtual void write(const Append& append) = 0;
    /// Whether an interrupted run can be continued
    virtual bool can_be_resumed() const { return true; }
    /// Whether a complete run can be continued to a later end
    virtual bool can_be_extended() const { return true; }

    /// Restores the last checkpoint. Returns false if there is none. IoError if none can be read.
    bool load();
    void save();
    /// Creates and locks the directory before prepare() does, for files of another program in it.
    void create_directory() { lock.create(); }
    /// A complete run is unfinished from here on: it has another end.
    void extend();
    /// Records an interruption, with a checkpoint.
    void interrupted();

    /// Removes the progress line, and writes a warning, or a line of --verbose.
    void warn(const std::string& what);
    void log(const std::string& what);
    std::string path(const std::string& file) const { return options.directory + '/' + file; }
    /// Wall time [s] since the end of prepare(), or before that since the construction
    double seconds() const;

    CheckpointFiles files;
    bool resumed = false;
    std::string status = "ok", message;  ///< message: of a failure
    int code = 0;                        ///< exit code
    std::optional<ProgressLine> line;    ///< during the steps

private:
    const ResumableOptions options;
    OutputLock lock;
    std::string restored;  ///< name of the checkpoint
    Clock::time_point begin, saved;
};

}  // namespace hilda::io
