// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/progress.hpp"

#include <pty.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
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

/// A file that receives stderr while the object exists
class NoTerminal {
public:
    NoTerminal() : file(std::tmpfile()), stderr_before(dup(STDERR_FILENO))
    {
        dup2(fileno(file), STDERR_FILENO);
    }
    ~NoTerminal()
    {
        restore();
        std::fclose(file);
    }
    /// Restores stderr and returns what was written.
    std::string written()
    {
        restore();
        std::string all;
        std::rewind(file);
        for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file)) all += static_cast<char>(c);
        return all;
    }

private:
    void restore()
    {
        if (stderr_before < 0) return;
        dup2(stderr_before, STDERR_FILENO);
        close(stderr_before);
        stderr_before = -1;
    }
    std::FILE* file;
    int stderr_before;
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

TEST_CASE("a progress line ends with the completed share and the remaining time", "[io][progress]")
{
    Terminal terminal;
    if (!terminal.is_open()) return;
    {
        io::ProgressLine line(false);
        const auto now = io::ProgressLine::Clock::now();
        line.completed(0, 0, now);
        line.show("start", now + 1s);
        line.completed(0.25, 0, now + 10s);
        line.show("a text that is longer than the terminal", now + 10s);
        line.show("t", now + 20s);  // the share is that of 10 s
        line.show("late", now + 50s);
        line.completed(1, 0, now + 60s);
        line.show("t", now + 60s);
    }
    CHECK(terminal.written() ==
          "\rstart, 0 %\033[K\ra , 25 %, 30 s left\033[K\rt, 25 %, 20 s left\033[K\rlate, 25 %\033[K"
          "\rt, 100 %\033[K\r\033[K");
}

TEST_CASE("without a terminal progress is a line each minute", "[io][progress]")
{
    NoTerminal messages;
    {
        io::ProgressLine line(false);
        const auto now = io::ProgressLine::Clock::now();
        for (int seconds = 1; seconds < 60; ++seconds) line.show("too early", now + seconds * 1s);
        line.completed(0.75, 0.5, now + 60s);  // of a run that was resumed at 50 %
        line.show("first", now + 61s);
        line.show("too early", now + 120s);
        line.completed(0.8, 0.5, now + 121s);
        line.show("a text that is longer than a terminal of twenty columns", now + 121s);
        line.clear();
    }
    CHECK(messages.written() ==
          "hilda: first, 75 %, 59 s left\n"
          "hilda: a text that is longer than a terminal of twenty columns, 80 %, 81 s left\n");
}

TEST_CASE("a duration has the units that matter", "[io][progress]")
{
    const std::pair<double, std::string> all[] = {
        {0.3, "0 s"},         {99.4, "99 s"},      {99.6, "2 min"},         {3600, "60 min"},
        {6000, "1 h 40 min"}, {7190, "2 h 0 min"}, {172000, "47 h 47 min"}, {172790, "2 d 0 h"},
        {4e5, "4 d 15 h"}};
    for (const auto& [seconds, text] : all) CHECK(io::duration_text(seconds) == text);
}
