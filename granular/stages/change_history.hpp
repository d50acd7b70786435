// SPDX-License-Identifier: GPL-3.0-or-later
/// The changes of a run so far, for summary.json and checkpoints.

#pragma once

#include "io/json.hpp"

#include <string>
#include <vector>

namespace hilda::granular {

class ChangeHistory {
public:
    struct Change {
        double t = 0;   ///< [s]
        long step = 0;  ///< at which the run was changed
        long rows = 0;  ///< of run.csv until then
        std::vector<std::string> what;
    };

    std::vector<Change> all;

    /// Number of rows of run.csv after this step, with a row every `interval` steps since the last change
    long rows(long step, long interval) const;
    io::Json summary() const;
    /// For a checkpoint
    std::string bytes() const;
    /// Reads bytes(). Throws io::IoError; `file` is the name of the checkpoint.
    void read(const std::string& bytes, const std::string& file);
};

}  // namespace hilda::granular
