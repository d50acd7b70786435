// SPDX-License-Identifier: GPL-3.0-or-later
/// The run in an output directory, which --resume continues.

#pragma once

#include "io/error.hpp"
#include "io/json.hpp"
#include "run/recording/checkpoint.hpp"
#include "run/run_options.hpp"

#include <optional>
#include <string>

namespace hilda::dae {
struct Description;
}

namespace hilda::run {

/// The run in the directory has ended and cannot be continued.
struct RunHasEnded : io::UsageError {
    using UsageError::UsageError;
};
/// The run in the directory is complete, and no later end is asked for: there is nothing to do.
struct RunIsComplete : RunHasEnded {
    using RunHasEnded::RunHasEnded;
};

/// summary.json of the run in a directory. io::IoError, io::InvalidInput.
io::Json earlier_summary(const std::string& directory);

/// A run as its checkpoint identifies it
struct RunIdentity {
    const RunOptions& options;
    const lie::Scheme& scheme;
    const dae::Description& description;
    const lie::TimeGrid& grid;
    double end;              ///< as it is requested [s]
    std::string model_text;  ///< text of model.json
};

class EarlierRun {
public:
    explicit EarlierRun(std::string directory);

    /// Reads its checkpoint. io::IoError if it is damaged.
    void read(const std::string& bytes, const std::string& file);
    /// RunHasEnded if it has ended and no checkpoint has been read
    void require_checkpoint() const;
    /// The settings of a run, which may continue this one
    RunSettings settings(const RunIdentity& of) const;
    /// RunIsComplete if `by` has the end of this run; io::UsageError if it does not continue this run, or
    /// does not end after its checkpoint; io::IoError if the checkpoint does not fit the model.
    void check_continues(const RunIdentity& by, const RunSettings& settings) const;

    std::optional<Checkpoint> from;  ///< empty: there is none, or the run is not continued
    std::string file;                ///< of the checkpoint
    bool has_ended;

private:
    const std::string directory;
};

}  // namespace hilda::run
