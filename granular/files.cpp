// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/files.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fcntl.h>
#include <unistd.h>

namespace hilda::granular {

namespace {

[[noreturn]] void fail(const std::string& file, const std::string& what)
{
    throw FileError(file + ": " + what + ": " + std::strerror(errno));
}

/// A file that is being written. The destructor closes it, and deletes it unless `done` is set.
struct Open {
    int descriptor;
    const std::string& name;
    bool done = false;
    ~Open()
    {
        if (descriptor >= 0) close(descriptor);
        if (!done) unlink(name.c_str());
    }
};

}  // namespace

void write_file(const std::string& file, const std::string& bytes)
{
    const std::string next = file + ".new";
    Open out{::open(next.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666), next};
    if (out.descriptor < 0) fail(next, "cannot be written");
    for (std::size_t at = 0; at < bytes.size();) {
        const ssize_t n = ::write(out.descriptor, bytes.data() + at, bytes.size() - at);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) fail(next, "cannot be written");
        at += static_cast<std::size_t>(n);
    }
    if (fsync(out.descriptor) != 0 && errno != EINVAL) fail(next, "cannot be flushed to the disk");
    if (std::rename(next.c_str(), file.c_str()) != 0) fail(file, "cannot be replaced by " + next);
    out.done = true;
    const std::string parent = std::filesystem::path(file).parent_path().string();
    const int folder = ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder >= 0) {
        fsync(folder);
        close(folder);
    }
}

std::string read_file(const std::string& file, std::size_t most)
{
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error))
        throw FileError(file + ": does not exist or is not a regular file");
    if (const auto size = std::filesystem::file_size(file, error); error || size > most)
        throw FileError(file + ": must not be larger than " + std::to_string(most) + " bytes");
    std::ifstream in(file, std::ios::binary);
    std::ostringstream all;
    all << in.rdbuf();
    if (!in) fail(file, "cannot be read");
    return all.str();
}

void make_directory(const std::string& directory)
{
    std::error_code error;
    std::filesystem::create_directories(directory, error);
    if (error) throw FileError(directory + ": cannot be created: " + error.message());
}

std::uint64_t checksum(const char* bytes, std::size_t count)
{
    std::uint64_t h = 0xcbf29ce484222325u;
    const auto take = [&](std::uint64_t w) { h = (h ^ w) * 0x100000001b3u, h ^= h >> 29; };
    for (; count >= 8; bytes += 8, count -= 8) {
        std::uint64_t w = 0;
        std::memcpy(&w, bytes, 8);
        take(w);
    }
    for (; count > 0; ++bytes, --count) take(static_cast<unsigned char>(*bytes));
    return h;
}

}  // namespace hilda::granular
