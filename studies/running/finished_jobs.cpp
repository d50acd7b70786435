// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/running/finished_jobs.hpp"

#include <sys/stat.h>

#include <cstdint>
#include <cstdio>
#include <cstring>

namespace hilda::studies {

namespace {

constexpr size_t most = size_t{4} << 30;  // largest file that is read [byte]

constexpr FinishedJobs::Key identity_key = {-1, -1};

/// Begins each record.
struct Header {
    std::int64_t pool, job;
    std::uint64_t length, checksum;  ///< of the bytes that follow
};

std::string path_in(const std::string& directory) { return directory + "/study.part"; }

/// A value in one line; the parts of a list are separated by line breaks.
std::string quoted(const std::string& value)
{
    if (value.empty()) return "the default";
    std::string line;
    for (const char c : value) line += c == '\n' ? std::string(", ") : std::string(1, c);
    return "'" + line + "'";
}

}  // namespace

FinishedJobs::FinishedJobs(const std::string& directory, const Identity& identity, bool resume)
    : path(path_in(directory))
{
    if (resume && !in(directory))
        throw io::UsageError(directory + ": has no interrupted study; --resume needs its file study.part");
    bool is_new = !resume;
    if (resume) {
        const size_t whole = read(io::read_file(path, most), identity);
        file.emplace(path, whole, true);
        is_new = whole == 0;
    } else {
        file.emplace(path);
    }
    if (is_new) {
        io::Archive a;
        Identity copy = identity;
        a.map(copy);
        append(identity_key, a.bytes());
    }
}

FinishedJobs::~FinishedJobs()
{
    if (file && results.empty() && !has_new) remove();
}

bool FinishedJobs::in(const std::string& directory)
{
    struct stat status {};
    return stat(path_in(directory).c_str(), &status) == 0;
}

/// Reads the whole records and returns their length [byte].
size_t FinishedJobs::read(const std::string& bytes, const Identity& identity)
{
    size_t at = 0;
    bool has_identity = bytes.empty();  // the study was interrupted before the first record
    Header h{};
    while (bytes.size() - at >= sizeof h) {
        std::memcpy(&h, bytes.data() + at, sizeof h);
        const char* content = bytes.data() + at + sizeof h;
        if (h.length > bytes.size() - at - sizeof h || io::checksum(content, h.length) != h.checksum) break;
        at += sizeof h + h.length;
        const Key key(h.pool, h.job);
        std::string result(content, h.length);
        if (key != identity_key) {
            results[key] = std::move(result);
            continue;
        }
        io::Archive a(result, path);
        Identity of_file;
        a.map(of_file);
        for (const auto& [name, value] : identity)
            if (of_file[name] != value)
                throw io::UsageError(path + ": --resume needs the same " + name +
                                     "; the interrupted study has " + quoted(of_file[name]) +
                                     ", this command has " + quoted(value));
        has_identity = true;
    }
    if (!has_identity) throw io::IoError(path + ": is not the file of an interrupted study");
    return at;
}

bool FinishedJobs::restore(Key key, const Transfer& transfer) const
{
    const auto at = results.find(key);
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
    file.reset();
    std::remove(path.c_str());
}

}  // namespace hilda::studies
