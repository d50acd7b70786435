// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/descriptor.hpp"

#include <cerrno>

#include <unistd.h>

namespace hilda::io {

std::size_t write_all(int descriptor, const void* bytes, std::size_t count)
{
    const char* const from = static_cast<const char*>(bytes);
    std::size_t done = 0;
    while (done < count) {
        const ssize_t n = write(descriptor, from + done, count - done);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) break;
        done += static_cast<std::size_t>(n);
    }
    return done;
}

std::size_t read_all(int descriptor, void* bytes, std::size_t count)
{
    char* const to = static_cast<char*>(bytes);
    std::size_t done = 0;
    errno = 0;
    while (done < count) {
        const ssize_t n = read(descriptor, to + done, count - done);
        if (n < 0 && errno == EINTR) {
            errno = 0;
            continue;
        }
        if (n <= 0) break;
        done += static_cast<std::size_t>(n);
    }
    return done;
}

}  // namespace hilda::io
