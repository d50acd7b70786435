// SPDX-License-Identifier: GPL-3.0-or-later
/// Files that are written or read at once, output files that grow, and directories.

#pragma once

#include "io/error.hpp"

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace hilda::io {

/// Writes a file of an output directory atomically: to FILE.tmp, fsync, rename, fsync of the directory. After
/// a crash the file has its old or its new contents. A symbolic link, a device or a pipe of this name is
/// replaced, not written to. IoError; the temporary file is removed then.
void write_file(const std::string& path, const std::string& content);

/// Receives the next piece of a content
using Append = std::function<void(std::string_view piece)>;
/// The same for a content that is not in memory as a whole: `content` passes its pieces to its argument.
void write_file(const std::string& path, const std::function<void(const Append&)>& content);

/// The same for a file that the user names: a symbolic link is followed; a device or pipe is written to
/// directly.
void write_named_file(const std::string& path, const std::string& content);

/// Renames a file, replacing an existing file, and synchronises the directory with the disk. IoError.
void rename_file(const std::string& from, const std::string& to);

/// Contents of a regular file of at most `most` bytes. IoError.
std::string read_file(const std::string& path, size_t most);

/// With this some editors begin a text in UTF-8.
inline constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
inline std::string_view without_byte_order_mark(std::string_view text)
{
    return text.substr(text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0);
}

/// True if the path does not exist or is an empty directory. IoError if it is not a directory.
bool is_missing_or_empty(const std::string& directory);

/// Creates the directory and its parents. IoError.
void make_directory(const std::string& directory);

/// Creates a folder of the program, `name`, in an output directory. IoError, also if it is a symbolic link:
/// the files would be written elsewhere.
void make_folder_in(const std::string& directory, const std::string& name);

/// A buffered output file with checked writes and known length, which can be continued from a checkpoint
class OutputFile {
public:
    /// Creates the file; with `resume`, opens it and truncates it to `keep_bytes` bytes. IoError, also if the
    /// file is shorter than that, a symbolic link, a device or a pipe.
    explicit OutputFile(std::string path, std::uint64_t keep_bytes = 0, bool resume = false);
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;
    /// Closes the file without writing the buffer, because a destructor could not report an error. Call
    /// flush() before.
    ~OutputFile();

    /// Text appended here is written by the next flush().
    std::string buffer;

    /// Writes the buffer if it exceeds 1 MiB. IoError.
    void flush_when_full()
    {
        if (buffer.size() >= full) flush();
    }
    /// Writes the buffer. IoError.
    void flush();
    /// flush() and fdatasync. IoError, also if the file of this name is another one now: it was removed,
    /// renamed or replaced.
    void sync();
    /// flush() at the end of the file. IoError as of sync().
    void finish();
    /// Length of the file including the buffer [byte]
    std::uint64_t size() const { return written + buffer.size(); }
    const std::string& name() const { return path; }

private:
    static constexpr size_t full = 1 << 20;

    void require_name() const;

    std::string path;
    int descriptor = -1;
    std::uint64_t written = 0;
};

}  // namespace hilda::io
