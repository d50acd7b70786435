// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files.hpp"

#include "io/descriptor.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace hilda::io {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const std::string& path, const std::string& what = "cannot be written")
{
    const int error = errno;
    throw IoError(path + ": " + what + ": " + std::strerror(error));
}

/// A temporary file, which commit() renames to the target and which is removed otherwise
class Temporary {
public:
    explicit Temporary(const std::string& target) : target(target), path(target + ".tmp")
    {
        unlink(path.c_str());  // of a process that was killed; a link is removed, not followed
        descriptor = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
        if (descriptor < 0) fail(target);
    }
    Temporary(const Temporary&) = delete;
    Temporary& operator=(const Temporary&) = delete;
    ~Temporary()
    {
        if (descriptor >= 0) close(descriptor);
        if (!renamed) unlink(path.c_str());
    }

    void write(std::string_view content) const
    {
        if (write_all(descriptor, content.data(), content.size()) < content.size()) fail(target);
    }

    void commit()
    {
        if (fsync(descriptor) != 0 && errno != EINVAL && errno != EROFS) fail(target);
        rename_file(path, target);
        renamed = true;
    }

private:
    const std::string target, path;
    int descriptor = -1;
    bool renamed = false;
};

void sync_directory(const std::string& path)
{
    const fs::path parent = fs::path(path).parent_path();
    const int descriptor = open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0)
        return;  // the file is complete; without the fsync only its name could be lost in a power failure
    fsync(descriptor);
    close(descriptor);
}

}  // namespace

void write_file(const std::string& name, const std::string& content)
{
    write_file(name, [&](const Append& append) { append(content); });
}

void write_file(const std::string& name, const std::function<void(const Append&)>& content)
{
    Temporary file(name);
    content([&](std::string_view piece) { file.write(piece); });
    file.commit();
}

void write_named_file(const std::string& name, const std::string& content)
{
    std::error_code error;
    const fs::path target = fs::weakly_canonical(name, error);  // writes through a symbolic link
    const std::string path = error ? name : target.string();
    if (!fs::exists(path, error) || fs::is_regular_file(path, error)) return write_file(path, content);
    std::ofstream out(path, std::ios::binary);
    if (!(out << content).flush()) fail(name);
}

void rename_file(const std::string& from, const std::string& to)
{
    if (rename(from.c_str(), to.c_str()) != 0) fail(to, "cannot be written");
    sync_directory(to);
}

std::string read_file(const std::string& path, size_t most)
{
    struct stat s {};
    if (stat(path.c_str(), &s) != 0) {
        if (errno == ENOENT) throw IoError(path + ": does not exist");
        fail(path, "cannot be read");
    }
    if (!S_ISREG(s.st_mode)) throw IoError(path + ": is not a regular file");
    if (static_cast<size_t>(s.st_size) > most)
        throw IoError(path + ": is larger than " + std::to_string(most) + " bytes, got " +
                      std::to_string(s.st_size));
    std::string content(static_cast<size_t>(s.st_size), '\0');
    std::ifstream in(path, std::ios::binary);
    if (!in.read(content.data(), s.st_size)) fail(path, "cannot be read");
    return content;
}

bool is_missing_or_empty(const std::string& directory)
{
    std::error_code error;
    const fs::file_status status = fs::status(directory, error);
    if (status.type() == fs::file_type::not_found) return true;
    if (status.type() != fs::file_type::directory)
        throw IoError(directory + ": " + (error ? error.message() : "exists and is not a directory"));
    const bool empty = fs::is_empty(directory, error);
    if (error) throw IoError(directory + ": " + error.message());
    return empty;
}

void make_directory(const std::string& directory)
{
    std::error_code error;
    fs::create_directories(directory, error);
    if (error) throw IoError(directory + ": cannot be created: " + error.message());
}

void make_folder_in(const std::string& directory, const std::string& name)
{
    const std::string path = directory + '/' + name;
    std::error_code error;
    if (fs::is_symlink(path, error))
        throw IoError(path + ": is a symbolic link; remove it, or give another --output");
    make_directory(path);
}

OutputFile::OutputFile(std::string file, std::uint64_t keep_bytes, bool resume)
    : path(std::move(file)), written(keep_bytes)
{
    constexpr int flags = O_WRONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;  // a pipe would wait for a reader
    descriptor = open(path.c_str(), flags | (resume ? 0 : O_CREAT | O_TRUNC), 0666);
    if (descriptor < 0 && errno == ELOOP)
        throw IoError(path + ": is a symbolic link; remove it, or give another --output");
    if (descriptor < 0) fail(path);
    struct stat s {};
    if (fstat(descriptor, &s) != 0) fail(path);
    if (!S_ISREG(s.st_mode)) {
        close(descriptor);
        throw IoError(path + ": is not a regular file; remove it, or give another --output");
    }
    if (!resume) return;
    if (static_cast<std::uint64_t>(s.st_size) < keep_bytes) {
        close(descriptor);
        throw IoError(path + ": is shorter than the checkpoint states: " + std::to_string(s.st_size) +
                      " bytes, not " + std::to_string(keep_bytes));
    }
    if (ftruncate(descriptor, static_cast<off_t>(keep_bytes)) != 0 || lseek(descriptor, 0, SEEK_END) < 0)
        fail(path);
}

OutputFile::~OutputFile()
{
    if (descriptor >= 0) close(descriptor);
}

void OutputFile::flush()
{
    const size_t done = write_all(descriptor, buffer.data(), buffer.size());
    const bool failed = done < buffer.size();
    written += done;
    buffer.clear();  // a later flush() must not fail again for the same rows
    if (failed) fail(path);
}

void OutputFile::sync()
{
    flush();
    if (fdatasync(descriptor) != 0 && errno != EINVAL && errno != EROFS) fail(path);
    require_name();
}

void OutputFile::finish()
{
    flush();
    require_name();
}

void OutputFile::require_name() const
{
    struct stat open {
    }, named{};
    if (fstat(descriptor, &open) != 0) fail(path);
    if (lstat(path.c_str(), &named) != 0 && errno != ENOENT) fail(path);
    if (named.st_dev == open.st_dev && named.st_ino == open.st_ino) return;
    throw IoError(path +
                  ": was removed or replaced by another program while it was written; its rows are lost");
}

}  // namespace hilda::io
