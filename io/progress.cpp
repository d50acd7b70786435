// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/progress.hpp"

#include "io/message.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

namespace hilda::io {

namespace {

constexpr auto least_interval = std::chrono::milliseconds(200);

/// Width of the terminal [characters]. A longer text would begin a new line, which \r does not remove.
std::size_t terminal_width()
{
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

ProgressLine::ProgressLine(bool quiet) : shown(!quiet && isatty(STDERR_FILENO) != 0) {}

bool ProgressLine::is_due(Clock::time_point now) const { return shown && now - last >= least_interval; }

void ProgressLine::show(const std::string& text, Clock::time_point now)
{
    if (!is_due(now)) return;
    last = now;
    message("\r" + text.substr(0, terminal_width() - 1) + "\033[K");
    visible = true;
}

void ProgressLine::clear()
{
    if (visible) message("\r\033[K");
    visible = false;
}

}  // namespace hilda::io
