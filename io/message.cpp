// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/message.hpp"

#include "io/error.hpp"

#include <cstdarg>
#include <new>

namespace hilda::io {

std::string formatted(const char* format, ...)
{
    va_list values, again;
    va_start(values, format);
    va_copy(again, values);
    std::string text(static_cast<std::size_t>(std::vsnprintf(nullptr, 0, format, values)), '\0');
    std::vsnprintf(text.data(), text.size() + 1, format, again);
    va_end(again);
    va_end(values);
    return text;
}

std::string counted(long n, const std::string& one, const std::string& many)
{
    return std::to_string(n) + ' ' + (n == 1 ? one : many.empty() ? one + 's' : many);
}

namespace {

/// The text of an error on one line, also if it quotes a name with line breaks or other control characters
std::string on_one_line(std::string_view text)
{
    std::string line;
    for (const char c : text)
        if (c == '\n')
            line += "\\n";
        else
            line += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
    return line;
}

}  // namespace

int report(const std::exception& error)
{
    const auto say = [&](const std::string& head, int code) {
        message("hilda: " + head + ": " + on_one_line(error.what()) + '\n');
        return code;
    };
    if (const auto* failure = dynamic_cast<const Failure*>(&error)) return say("error", failure->code);
    if (dynamic_cast<const InvalidInput*>(&error) != nullptr) return say("error", exit_code::invalid_input);
    if (const auto* failure = dynamic_cast<const NumericalFailure*>(&error))
        return say("error[" + failure->status + "]", exit_code::numerical_failure);
    if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) {
        message("hilda: internal error: out of memory\n");
        return exit_code::internal_error;
    }
    return say("internal error", exit_code::internal_error);
}

}  // namespace hilda::io
