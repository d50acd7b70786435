// SPDX-License-Identifier: GPL-3.0-or-later
/// Results of the finished jobs of a study, kept in a file until the study ends: an interrupted study
/// continues from them.

#pragma once

#include "io/archive.hpp"
#include "io/files.hpp"

#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

namespace hilda::run {

/// The contents of a file of finished jobs
struct JobRecords {
    /// Name and value of everything that the results depend on
    using Identity = std::map<std::string, std::string>;
    /// Number of the pool in the study, number of the job in the pool
    using Key = std::pair<long, long>;

    std::string file;
    Identity identity;
    std::string command;  ///< of a shard: the words of the command line, each with a final '\0'
    std::map<Key, std::string> results;
    size_t length = 0;  ///< of the whole records [byte]
};

/// Reads a file of finished jobs. io::IoError if it is not one.
JobRecords read_job_records(const std::string& file);

/// The file DIRECTORY/study.part: what the results depend on, then a record for each finished job. A record
/// is written when its job finishes. A record that an interruption cut off is dropped, and its job is
/// computed again.
///
/// The jobs of a shard that has ended are in DIRECTORY/study.shard, for hilda collect.
class FinishedJobs {
public:
    using Identity = JobRecords::Identity;
    /// Writes or reads the result of a job
    using Transfer = std::function<void(io::Archive&)>;
    using Key = JobRecords::Key;

    /// Creates the file, or with `resume` reads it and continues it. io::UsageError if there is no file to
    /// resume, or if it has another identity.
    FinishedJobs(const std::string& directory, const Identity& identity, bool resume,
                 const std::string& command = "");
    /// The results of all jobs of a study, from its shards, without a file. io::UsageError if they have
    /// another identity.
    FinishedJobs(JobRecords all, const Identity& identity);

    /// Removes the file if no job has finished.
    ~FinishedJobs();
    FinishedJobs(const FinishedJobs&) = delete;
    FinishedJobs& operator=(const FinishedJobs&) = delete;

    /// Whether the directory contains the file of an interrupted study
    static bool in(const std::string& directory);
    /// The file of an interrupted study or shard, and that of a shard that has ended
    static std::string part_file(const std::string& directory) { return directory + "/study.part"; }
    static std::string shard_file(const std::string& directory) { return directory + "/study.shard"; }

    /// Reads the result of a job that finished before. False if there is none; io::IoError if the results of
    /// all jobs should be there.
    bool restore(Key key, const Transfer& transfer) const;
    /// Appends the result of a job. Safe to call from several threads. io::IoError.
    void keep(Key key, const Transfer& transfer);
    /// Removes the file: the study has ended.
    void remove();
    /// Renames the file: the shard has ended.
    void end_shard();
    /// Number of the next pool
    long next_pool() { return pools++; }
    /// Number of the jobs that finished before the interruption
    size_t count() const { return results.size(); }

private:
    std::string directory, path;
    std::map<Key, std::string> results;
    bool is_complete = false;  ///< no job is computed
    std::optional<io::OutputFile> file;
    std::mutex in_use;
    long pools = 0;
    bool has_new = false;

    void append(Key key, std::string bytes);
};

}  // namespace hilda::run
