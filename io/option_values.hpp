// SPDX-License-Identifier: GPL-3.0-or-later
/// Options: their declaration, from which command lines, their help and the identity of results come, and the
/// conversion of their values to numbers and lists. Each function of the conversion takes the name of the
/// option and its text. An invalid text is a UsageError that states the option, the valid range and the text.

#pragma once

#include "io/error.hpp"

#include <charconv>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hilda::io {

/// What depends on the value of an option
enum class Scope {
    numerical,  ///< results: the value is part of the identity of checkpoints and of the jobs of a study
    output,     ///< files that are written, and what is printed
    none        ///< neither, such as the number of concurrent runs
};

struct Option {
    std::string name;        ///< --vtk
    std::string value = "";  ///< name of its value in the help; empty for a switch
    std::string help;
    /// Throws UsageError for an invalid text.
    void (*check)(const std::string& option, const std::string& text) = nullptr;
    Scope scope = Scope::output;

    bool is_switch() const { return value.empty(); }
    /// max_iterations of --max-iterations: the key in JSON files and the keyword of Python
    std::string key() const
    {
        std::string key = name.substr(2);
        for (char& c : key)
            if (c == '-') c = '_';
        return key;
    }
};

/// Throws UsageError "OPTION: what, got 'TEXT'".
[[noreturn]] void refuse_option(const std::string& option, const std::string& what, const std::string& text);

/// The number that the whole text represents, if it is one
template <class Number>
std::optional<Number> number_in(std::string_view text)
{
    Number value = 0;
    const char* const end = text.data() + text.size();
    const auto [at, error] = std::from_chars(text.data(), end, value);
    return error == std::errc() && at == end ? std::optional(value) : std::nullopt;
}

/// The finite number that the whole text represents; NaN if it represents none
double finite_number_in(std::string_view text);

/// A finite number. The whole text must be the number.
double number(const std::string& option, const std::string& text);
/// A finite number > 0, and a finite number >= 0
double positive_number(const std::string& option, const std::string& text);
double nonnegative_number(const std::string& option, const std::string& text);
/// A number from 0 to 1
double fraction(const std::string& option, const std::string& text);
/// An integer from 1 to `most`
int positive_count(const std::string& option, const std::string& text);
int count_up_to(int most, const std::string& option, const std::string& text);
/// An unsigned 64-bit integer
std::uint64_t seed(const std::string& option, const std::string& text);
/// The parts of A,B,C. No part may be empty.
std::vector<std::string> list(const std::string& option, const std::string& text);
/// One of the words; the error lists them.
std::string one_of(const std::string& option, const std::string& text, std::span<const std::string> words);
/// A text that is not empty
std::string path(const std::string& option, const std::string& text);
/// The text of a --set. It must have the form /json/pointer=VALUE.
std::string setting(const std::string& option, const std::string& text);

/// The help text of a command, or a list of two columns, with its lines broken at blanks, so that no line has
/// more than `width` characters where possible. A continued line begins below the description of its option,
/// or with the indentation of its line.
std::string wrapped_help(const std::string& text, std::size_t width = 100);

}  // namespace hilda::io
