// SPDX-License-Identifier: GPL-3.0-or-later
/// Ends the program at a known write to a file, for tests of --resume. Linked with --wrap of the functions
/// below.
///
/// The environment variable HILDA_END_AT has the form
///     SIGNAL COUNT FILE           at write COUNT to a file whose path ends with FILE, this process gets the signal
///     -SIGNAL COUNT FILE          its parent process gets the signal; this process then waits for its own end
/// The signal comes after the first half of the bytes. Files are not synchronised with the disk: the end of a
/// process does not need it, and a checkpoint after each step takes 40 µs instead of 4 ms. Without the
/// variable the program is unchanged.

#include <sys/types.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <sstream>
#include <string>

// NOLINTBEGIN(bugprone-reserved-identifier): the names that the linker gives wrapped functions
extern "C" ssize_t __real_write(int descriptor, const void* bytes, size_t count);
extern "C" ssize_t __wrap_write(int descriptor, const void* bytes, size_t count);
extern "C" int __real_fsync(int descriptor);
extern "C" int __wrap_fsync(int descriptor);
extern "C" int __real_fdatasync(int descriptor);
extern "C" int __wrap_fdatasync(int descriptor);
// NOLINTEND(bugprone-reserved-identifier)

namespace {

struct End {
    int signal = 0;
    long write = 0;
    std::string file;

    End()
    {
        if (const char* text = std::getenv("HILDA_END_AT"))
            std::istringstream(text) >> signal >> write >> file;
    }
    bool is_at(int descriptor)
    {
        std::array<char, 4096> target{};
        const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
        const ssize_t length = readlink(link.c_str(), target.data(), target.size());
        return length > 0 && std::string_view(target.data(), static_cast<size_t>(length)).ends_with(file) &&
               ++writes == write;
    }

private:
    std::atomic<long> writes{0};
};

End& end()
{
    static End at;
    return at;
}

}  // namespace

ssize_t __wrap_write(int descriptor, const void* bytes, size_t count)
{
    const int signal = end().signal;
    if (signal == 0 || !end().is_at(descriptor)) return __real_write(descriptor, bytes, count);
    const ssize_t half = __real_write(descriptor, bytes, count / 2);
    if (signal > 0) {
        raise(signal);
    } else {
        kill(getppid(), -signal);
        for (;;) pause();
    }
    // The program continues after a signal that it has only recorded.
    if (half < 0) return half;
    const ssize_t rest = __real_write(descriptor, static_cast<const char*>(bytes) + half, count - half);
    return rest < 0 ? rest : half + rest;
}

int __wrap_fsync(int descriptor) { return end().signal == 0 ? __real_fsync(descriptor) : 0; }
int __wrap_fdatasync(int descriptor) { return end().signal == 0 ? __real_fdatasync(descriptor) : 0; }
