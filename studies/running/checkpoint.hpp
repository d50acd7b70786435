// SPDX-License-Identifier: GPL-3.0-or-later
/// Checkpoints: the state of a run between two steps. A run resumed from a checkpoint gives the same digits
/// as an uninterrupted run.

#pragma once

#include "contact/evolving/unilateral.hpp"
#include "lie/statistics.hpp"
#include "studies/running/csv_steps.hpp"
#include "studies/running/csv_trajectory.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace hilda::studies {

struct Checkpoint {
    std::string settings;  ///< list of the settings of the run, as text; a resumed run must have the same
    lie::State node;       ///< last accepted node
    long number = 0;       ///< number of that node
    int iterations = 0;    ///< Newton iterations of the step that ends there
    lie::State
        pivots;  ///< state of the last choice of pivots (see PivotNode); no bodies: pivots not chosen yet
    lie::Statistics statistics;
    Invariants invariants;
    contact::UnilateralStep::History contacts;  ///< of unilateral contacts
    StepsCsv::Cost last_step;
    std::uint64_t trajectory_bytes = 0, steps_bytes = 0;
    double wall_seconds = 0;
};

/// Serialises a checkpoint, little endian: magic, format version, total length [byte], content, CRC-32 of all
/// preceding bytes.
std::string to_bytes(const Checkpoint& checkpoint);
/// Inverse of to_bytes(). `file` is for the message. io::IoError if length, checksum or format version is wrong.
Checkpoint from_bytes(const std::string& bytes, const std::string& file);

/// Writes DIRECTORY/checkpoint; the previous checkpoint becomes checkpoint.1. At any time at least one of the
/// two files is complete. io::IoError.
void save(const Checkpoint& checkpoint, const std::string& directory);

/// Reads the last checkpoint; if it is damaged, the previous one, with a warning on stderr. Empty if there is
/// no checkpoint. io::IoError if none can be read.
std::optional<Checkpoint> load(const std::string& directory);

/// Removes all checkpoint files of a directory.
void remove_checkpoints(const std::string& directory);

/// FNV-1a hash of a text, 64 bits
std::uint64_t hash(const std::string& text);

}  // namespace hilda::studies
