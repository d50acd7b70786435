// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/jobs/finished_jobs.hpp"

#include "io/error.hpp"

#include <sys/stat.h>

#include <cstdint>
#include <cstdio>
#include <cstring>

namespace hilda::run {

namespace {

constexpr size_t most = size_t{4} << 30;  // largest file that is read [byte]

// Records that are not results
constexpr FinishedJobs::Key identity_key = {-1, -1}, command_key = {-2, -2};

/// Begins each record.
struct Header {
    std::int64_t pool, job;
    std::uint64_t length, checksum;  ///< of the bytes that follow
};

/// A value in one line; the parts of a list are separated by line breaks.
std::string quoted(const std::string& value)
{
    if (value.empty()) return "the default";
    std::string line;
    for (const char c : value) line += c == '\n' ? std::string(", ") : std::string(1, c);
    return "'" + line + "'";
}

void require_same(const JobRecords& records, const FinishedJobs::Identity& identity, const std::string& whose)
{
    for (const auto& [name, value] : identity) {
        const auto at = records.identity.find(name);
        const std::string there = at == records.identity.end() ? "" : at->second;
        if (there != value)
            throw io::UsageError(records.file + ": " + whose + " the same " + name + "; the " +
                                 (records.command.empty() ? "interrupted study" : "shard") + " has " +
                                 quoted(there) + ", this command has " + quoted(value));
    }
}

}  // namespace

JobRecords read_job_records(const std::string& file)
{
    JobRecords records;
    records.file = file;
    const std::string bytes = io::read_file(file, most);
    bool has_identity = bytes.empty();  // the study was interrupted before the first record
    size_t& at = records.length;
    Header h{};
    while (bytes.size() - at >= sizeof h) {
        std::memcpy(&h, bytes.data() + at, sizeof h);
        const char* content = bytes.data() + at + sizeof h;
        if (h.length > bytes.size() - at - sizeof h || io::checksum(content, h.length) != h.checksum) break;
        at += sizeof h + h.length;
        const JobRecords::Key key(h.pool, h.job);
        std::string result(content, h.length);
        if (key == identity_key) {
            io::Archive a(result, file);
            a.map(records.identity);
            has_identity = true;
        } else if (key == command_key) {
            records.command = std::move(result);
        } else {
            records.results[key] = std::move(result);
        }
    }
    if (!has_identity) throw io::IoError(file + ": is not the file of an interrupted study");
    return records;
}

FinishedJobs::FinishedJobs(const std::string& directory, const Identity& identity, bool resume,
                           const std::string& command)
    : directory(directory), path(part_file(directory))
{
    // In an empty directory the study begins: a job array starts and continues with the same command.
    if (resume && !in(directory)) resume = !io::is_missing_or_empty(directory);
    if (resume && !in(directory))
        throw io::UsageError(directory + ": has no interrupted study; --resume needs its file study.part");
    bool is_new = !resume;
    if (resume) {
        JobRecords records = read_job_records(path);
        is_new = records.length == 0;
        if (!is_new) require_same(records, identity, "--resume needs");
        results = std::move(records.results);
        file.emplace(path, records.length, true);
    } else {
        std::remove(shard_file(directory).c_str());
        file.emplace(path);
    }
    if (is_new) {
        io::Archive a;
        Identity copy = identity;
        a.map(copy);
        append(identity_key, a.bytes());
        if (!command.empty()) append(command_key, command);
    }
}

FinishedJobs::FinishedJobs(JobRecords all, const Identity& identity)
    : path(all.file), results(std::move(all.results)), is_complete(true)
{
    require_same(all, identity, "hilda collect needs");
}

FinishedJobs::~FinishedJobs()
{
    if (file && results.empty() && !has_new) remove();
}

bool FinishedJobs::in(const std::string& directory)
{
    struct stat status {};
    return stat(part_file(directory).c_str(), &status) == 0;
}

bool FinishedJobs::restore(Key key, const Transfer& transfer) const
{
    const auto at = results.find(key);
    if (at == results.end() && is_complete)
        throw io::IoError(path + ": the shards have no result of run " + std::to_string(key.second + 1));
    if (at == results.end()) return false;
    io::Archive a(at->second, path);
    transfer(a);
    a.end();
    return true;
}

void FinishedJobs::keep(Key key, const Transfer& transfer)
{
    io::Archive a;
    transfer(a);
    const std::lock_guard lock(in_use);
    append(key, a.bytes());
    has_new = true;
}

void FinishedJobs::append(Key key, std::string bytes)
{
    const Header h{key.first, key.second, bytes.size(), io::checksum(bytes.data(), bytes.size())};
    file->buffer.append(reinterpret_cast<const char*>(&h), sizeof h);
    file->buffer += bytes;
    file->flush();  // without a buffer: a signal may end the process at any time
}

void FinishedJobs::remove()
{
    if (is_complete) return;
    file.reset();
    std::remove(path.c_str());
}

void FinishedJobs::end_shard()
{
    file->sync();
    file.reset();
    io::rename_file(path, shard_file(directory));
}

}  // namespace hilda::run
