// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/output_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace hilda::io {

namespace {

[[noreturn]] void fail(const std::string& path)
{
    const int error = errno;
    throw IoError(path + ": cannot be written: " + std::strerror(error));
}

}  // namespace

OutputFile::OutputFile(std::string file, std::uint64_t keep_bytes, bool resume)
    : path(std::move(file)), written(keep_bytes)
{
    descriptor = open(path.c_str(), O_WRONLY | O_CLOEXEC | (resume ? 0 : O_CREAT | O_TRUNC), 0666);
    if (descriptor < 0) fail(path);
    if (!resume) return;
    struct stat s {};
    if (fstat(descriptor, &s) != 0) fail(path);
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
    size_t done = 0;
    while (done < buffer.size()) {
        const ssize_t n = write(descriptor, buffer.data() + done, buffer.size() - done);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) {
            written += done;
            buffer.clear();  // a later flush() must not fail again for the same rows
            fail(path);
        }
        done += static_cast<size_t>(n);
    }
    written += done;
    buffer.clear();
}

void OutputFile::sync()
{
    flush();
    if (fdatasync(descriptor) != 0 && errno != EINVAL && errno != EROFS) fail(path);
}

}  // namespace hilda::io
