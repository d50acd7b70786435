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

namespace hilda::studies {

/// The file DIRECTORY/study.part: what the results depend on, then a record for each finished job. A record
/// is written when its job finishes. A record that an interruption cut off is dropped, and its job is
/// computed again.
class FinishedJobs {
public:
    /// Name and value of everything that the results depend on
    using Identity = std::map<std::string, std::string>;
    /// Writes or reads the result of a job
    using Transfer = std::function<void(io::Archive&)>;
    /// Number of the pool in the study, number of the job in the pool
    using Key = std::pair<long, long>;

    /// Creates the file, or with `resume` reads it and continues it. io::UsageError if there is no file to
    /// resume, or if it has another identity.
    FinishedJobs(const std::string& directory, const Identity& identity, bool resume);

    /// Removes the file if no job has finished.
    ~FinishedJobs();
    FinishedJobs(const FinishedJobs&) = delete;
    FinishedJobs& operator=(const FinishedJobs&) = delete;

    /// Whether the directory contains the file of an interrupted study
    static bool in(const std::string& directory);

    /// Reads the result of a job that finished before. False if there is none.
    bool restore(Key key, const Transfer& transfer) const;
    /// Appends the result of a job. Safe to call from several threads. io::IoError.
    void keep(Key key, const Transfer& transfer);
    /// Removes the file: the study has ended.
    void remove();
    /// Number of the next pool
    long next_pool() { return pools++; }
    /// Number of the jobs that finished before the interruption
    size_t count() const { return results.size(); }

private:
    std::string path;
    std::map<Key, std::string> results;
    std::optional<io::OutputFile> file;
    std::mutex in_use;
    long pools = 0;
    bool has_new = false;

    size_t read(const std::string& bytes, const Identity& identity);
    void append(Key key, std::string bytes);
};

}  // namespace hilda::studies
