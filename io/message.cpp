// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/message.hpp"

#include "io/error.hpp"
#include "io/formats/characters.hpp"

#include <cstdarg>
#include <filesystem>
#include <new>

namespace hilda::io {

void raw_message(const std::string& text) noexcept
{
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
}

void message(const std::string& text) noexcept
{
    std::string all;
    for (std::string_view rest = text; !rest.empty();) {
        const std::size_t end = rest.find('\n');
        all += printable(rest.substr(0, end));
        if (end == std::string_view::npos) break;
        all += '\n';
        rest.remove_prefix(end + 1);
    }
    raw_message(all);
}

void warning(const std::string& what) { message("hilda: warning: " + what + '\n'); }

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

int report(const std::exception& error)
{
    const auto say = [&](const std::string& head, int code) {
        message("hilda: " + head + ": " + printable(error.what()) + '\n');
        return code;
    };
    if (const auto* failure = dynamic_cast<const Failure*>(&error)) return say("error", failure->code);
    if (dynamic_cast<const InvalidInput*>(&error) != nullptr) return say("error", exit_code::invalid_input);
    if (const auto* failure = dynamic_cast<const NumericalFailure*>(&error))
        return say("error[" + failure->status + "]", exit_code::numerical_failure);
    if (const auto* file = dynamic_cast<const std::filesystem::filesystem_error*>(&error)) {
        message("hilda: error: " + printable(file->path1().string() + ": " + file->code().message()) + '\n');
        return exit_code::input_output;
    }
    if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) {
        message("hilda: internal error: out of memory\n");
        return exit_code::internal_error;
    }
    return say("internal error", exit_code::internal_error);
}

}  // namespace hilda::io
