// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/progress.hpp"

#include "io/formats/characters.hpp"
#include "io/message.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cmath>

namespace hilda::io {

namespace {

using namespace std::chrono_literals;

constexpr auto interval_on_terminal = 200ms;
constexpr auto interval_of_lines = 1min;
constexpr double longest = 1e8;  // remaining time that is shown [s]

/// Width of the terminal [characters]. A longer text would begin a new line, which \r does not remove.
std::size_t terminal_width()
{
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

std::string duration_text(double seconds)
{
    if (seconds < 99.5) return formatted("%.0f s", seconds);
    const double minutes = std::round(seconds / 60), hours = std::round(seconds / 3600);
    if (minutes < 100) return formatted("%.0f min", minutes);
    if (minutes < 48 * 60)
        return formatted("%.0f h %.0f min", std::floor(minutes / 60), std::fmod(minutes, 60));
    return formatted("%.0f d %.0f h", std::floor(hours / 24), std::fmod(hours, 24));
}

ProgressLine::ProgressLine(bool quiet) : shown(!quiet), on_terminal(isatty(STDERR_FILENO) != 0) {}

bool ProgressLine::is_due(Clock::time_point now) const
{
    return shown && now - last >= (on_terminal ? Clock::duration(interval_on_terminal) : interval_of_lines);
}

void ProgressLine::completed(double value, double at_begin, Clock::time_point now)
{
    if (value == share) return;
    share = value;
    const double done = share - at_begin;
    total_seconds = done > 0 ? seconds(now) * (1 + (1 - share) / done) : unknown;
}

/// ", 42 %, 3 min left"
std::string ProgressLine::completion(Clock::time_point now) const
{
    if (std::isnan(share)) return {};
    // Rounding errors of a sum of shares do not reduce the percentage by one.
    std::string text = formatted(", %.0f %%", std::floor(100 * share * (1 + 1e-12)));
    const double left = total_seconds - seconds(now);
    if (left > 0 && left < longest) text += ", " + duration_text(left) + " left";
    return text;
}

void ProgressLine::show(const std::string& text, Clock::time_point now)
{
    if (!is_due(now)) return;
    last = now;
    const std::string end = completion(now);
    if (!on_terminal) {
        message("hilda: " + text + end + '\n');
        return;
    }
    const std::size_t width = terminal_width() - 1;
    const std::size_t text_width = width > end.size() ? width - end.size() : 0;
    raw_message("\r" + (printable(text).substr(0, text_width) + end).substr(0, width) + "\033[K");
    visible = true;
}

void ProgressLine::clear()
{
    if (visible) raw_message("\r\033[K");
    visible = false;
}

}  // namespace hilda::io
