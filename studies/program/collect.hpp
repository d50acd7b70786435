// SPDX-License-Identifier: GPL-3.0-or-later
/// The command hilda collect: writes the results of a study from its shards (hilda study KIND --shard I/N).

#pragma once

#include "run/jobs/finished_jobs.hpp"
#include "studies/program/study_option_table.hpp"

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
}

namespace hilda::studies {

struct CollectOptions {
    std::vector<std::string> directories;  ///< of the shards
    StudyArguments study;                  ///< those of the results
};

void add_collect_options(CLI::App& command, CollectOptions& to);

/// The results of all shards, with the command line of one of them. io::UsageError with one line if a shard
/// is missing, is there twice or has not ended, or if they are not of one study with the same options and the
/// same version of the program.
run::JobRecords read_shards(const std::vector<std::string>& directories);

/// The words of the command line of the shards
std::vector<std::string> words_of(const run::JobRecords& shards);

/// Writes study.csv, study.json and the figures, as the study writes them, and copies the other files of the
/// shards, such as the motions of --keep. `kind` and `arguments` are those of the command line of the shards.
/// Returns the exit code.
int collect(const CollectOptions& collected, const run::JobRecords& shards, const std::string& kind,
            StudyArguments arguments);

}  // namespace hilda::studies
