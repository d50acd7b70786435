// SPDX-License-Identifier: GPL-3.0-or-later
/// A run written down between two steps, so that it can go on as if nothing had happened.

#pragma once

#include "contact/evolving/unilateral.hpp"
#include "studies/running/csv_steps.hpp"
#include "studies/running/csv_trajectory.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace hilda::studies {

struct Checkpoint {
    std::string settings;  ///< of the run, for people; only a run with the same may go on from here
    lie::State node;       ///< on which the march stands
    long number = 0;       ///< of that node
    int iterations = 0;    ///< of the step that led to it
    lie::State pivots;     ///< see PivotNode; no bodies: none so far
    lie::Statistics statistics;
    Invariants invariants;
    contact::UnilateralStep::Past contacts;  ///< of those that open
    StepsCsv::Cost last_step;
    std::uint64_t trajectory_bytes = 0, steps_bytes = 0;
    double wall_seconds = 0;
};

/// Little endian: magic, format version, length of the whole, content, CRC-32 of all before.
std::string to_bytes(const Checkpoint& checkpoint);
/// IoError, naming the file, when the bytes are not exactly what to_bytes() made.
Checkpoint from_bytes(const std::string& bytes, const std::string& file);

/// Writes DIRECTORY/checkpoint; the one before becomes checkpoint.1. At every instant at least one of them is
/// whole.
void save(const Checkpoint& checkpoint, const std::string& directory);

/// The last checkpoint, or, with a warning on stderr, the one before when the last is damaged. Nothing when
/// there is none; IoError when none can be read.
std::optional<Checkpoint> load(const std::string& directory);

void remove_checkpoints(const std::string& directory);

/// FNV-1a, to tell texts apart
std::uint64_t hash(const std::string& text);

}  // namespace hilda::studies
