// SPDX-License-Identifier: GPL-3.0-or-later
/// Checkpoints of a run of a case: the world, its insertions, groups and stages, the changes so far, and what
/// the outputs need.

#pragma once

#include "granular/running/sink.hpp"
#include "granular/stages/change_history.hpp"
#include "granular/stages/continuation.hpp"

#include <string>

namespace hilda::granular {

class CaseCheckpoint {
public:
    using Saved = io::Sinks<CaseSetup>::Saved;

    explicit CaseCheckpoint(Continuation& of) : id(id_of(of.c)), from(of), c(of.c) {}

    /// Passes the state of the run on in pieces. of_sinks: that of the outputs
    void write(Saved of_sinks, const io::Append& append) const;
    /// Restores the state in the bytes of a checkpoint. Returns whether it is that before the changes of the
    /// continuation: a run that was interrupted just after a change has one with it. io::IoError.
    bool read(const std::string& bytes, const std::string& file, io::Sinks<CaseSetup>& sinks);

    const std::string id;  ///< of the case and its files, when the run started; see identity()
    ChangeHistory history;

private:
    void add_parts(Saved& parts) const;
    void read_parts(const Saved& parts, const std::string& file);
    bool changes_groups() const;
    void transfer_insertions(io::Archive& a) const;

    const Continuation& from;
    Case& c;
};

}  // namespace hilda::granular
