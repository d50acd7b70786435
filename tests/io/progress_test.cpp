// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/progress.hpp"

#include <pty.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include <catch2/catch.hpp>

using namespace hilda;
using namespace std::chrono_literals;

namespace {

/// A terminal of 20 columns that receives stderr while the object exists
class Terminal {
public:
    Terminal()
    {
        winsize size{};
        size.ws_row = 24, size.ws_col = 20;
        if (openpty(&master, &slave, nullptr, nullptr, &size) != 0) {
            WARN("not tested: no pseudo-terminal can be opened (" << std::strerror(errno) << ")");
            return;
        }
        stderr_before = dup(STDERR_FILENO);
        dup2(slave, STDERR_FILENO);
    }
    ~Terminal()
    {
        restore();
        if (is_open()) close(master);
    }
    bool is_open() const { return master >= 0; }
    /// Restores stderr and returns what was written.
    std::string written()
    {
        const std::string end = "the end";
        if (write(slave, end.data(), end.size()) < 0) return "nothing";
        restore();
        std::string all;
        char part[256];
        while (!all.ends_with(end)) {
            const auto n = read(master, part, sizeof part);
            if (n <= 0) break;
            all.append(part, static_cast<std::size_t>(n));
        }
        return all.substr(0, all.size() - end.size());
    }

private:
    void restore()
    {
        if (stderr_before < 0) return;
        dup2(stderr_before, STDERR_FILENO);
        close(stderr_before), close(slave);
        stderr_before = -1;
    }
    int master = -1, slave = -1, stderr_before = -1;
};

}  // namespace

TEST_CASE("a progress line is rewritten at most five times per second, cut to the terminal, and removed",
          "[io][progress]")
{
    Terminal terminal;
    if (!terminal.is_open()) return;
    bool shown = false, due_after_line = true, due_later = false;
    {
        io::ProgressLine line(false);
        const auto now = io::ProgressLine::Clock::now();
        shown = line.is_shown();
        line.show("too early", now);
        line.show("a text that is longer than the terminal", now + 300ms);
        due_after_line = line.is_due(now + 450ms);
        line.show("too early again", now + 450ms);
        due_later = line.is_due(now + 500ms);
        line.show("short", now + 500ms);
    }
    CHECK(terminal.written() == "\ra text that is long\033[K\rshort\033[K\r\033[K");
    CHECK(shown);
    CHECK_FALSE(due_after_line);
    CHECK(due_later);
}

TEST_CASE("no progress line is shown if it is not wanted", "[io][progress]")
{
    Terminal terminal;
    if (!terminal.is_open()) return;
    {
        io::ProgressLine line(true);
        line.show("text", io::ProgressLine::Clock::now() + 1s);
        line.clear();
        if (line.is_shown()) line.show("shown");
    }
    CHECK(terminal.written().empty());
}
