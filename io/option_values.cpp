// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/option_values.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hilda::io {

void refuse_option(const std::string& option, const std::string& what, const std::string& text)
{
    throw UsageError(option + ": " + what + ", got '" + text + "'");
}

double finite_number_in(std::string_view text)
{
    const std::optional<double> value = number_in<double>(text);
    return value && std::isfinite(*value) ? *value : std::nan("");
}

double number(const std::string& option, const std::string& text)
{
    const double value = finite_number_in(text);
    if (std::isnan(value)) refuse_option(option, "must be a finite number", text);
    return value;
}

double positive_number(const std::string& option, const std::string& text)
{
    const double value = finite_number_in(text);
    if (!(value > 0)) refuse_option(option, "must be a positive, finite number", text);
    return value;
}

double nonnegative_number(const std::string& option, const std::string& text)
{
    const double value = finite_number_in(text);
    if (!(value >= 0)) refuse_option(option, "must be a finite number, not negative", text);
    return value;
}

double fraction(const std::string& option, const std::string& text)
{
    const double value = finite_number_in(text);
    if (!(value >= 0 && value <= 1)) refuse_option(option, "must be a number from 0 to 1", text);
    return value;
}

int positive_count(const std::string& option, const std::string& text)
{
    const std::optional<int> value = number_in<int>(text);
    if (!value || *value < 1) refuse_option(option, "must be a whole number, at least 1", text);
    return *value;
}

int count_up_to(int most, const std::string& option, const std::string& text)
{
    const std::optional<int> value = number_in<int>(text);
    if (!value || *value < 1 || *value > most)
        refuse_option(option, "must be a whole number from 1 to " + std::to_string(most), text);
    return *value;
}

std::uint64_t seed(const std::string& option, const std::string& text)
{
    const std::optional<std::uint64_t> value = number_in<std::uint64_t>(text);
    if (!value) refuse_option(option, "must be a whole number from 0 to 2^64 - 1", text);
    return *value;
}

std::vector<std::string> list(const std::string& option, const std::string& text)
{
    std::vector<std::string> parts;
    for (size_t from = 0; from <= text.size();) {
        const size_t to = std::min(text.find(',', from), text.size());
        if (to == from) refuse_option(option, "must be a list such as A,B without empty parts", text);
        parts.push_back(text.substr(from, to - from));
        from = to + 1;
    }
    return parts;
}

std::string one_of(const std::string& option, const std::string& text, std::span<const std::string> words)
{
    if (std::find(words.begin(), words.end(), text) != words.end()) return text;
    std::string all;
    for (size_t k = 0; k < words.size(); ++k)
        all += (k == 0 ? "" : k + 1 < words.size() ? ", " : " or ") + words[k];
    refuse_option(option, "must be " + all, text);
}

std::string path(const std::string& option, const std::string& text)
{
    if (text.empty()) throw UsageError(option + ": must not be empty");
    return text;
}

std::string setting(const std::string& option, const std::string& text)
{
    if (!text.starts_with('/') || text.find('=') == std::string::npos)
        refuse_option(option, "must be /json/pointer=VALUE, such as /gravity/2=-1.62", text);
    return text;
}

namespace {

/// Number of characters of a UTF-8 text
size_t characters(std::string_view text)
{
    return static_cast<size_t>(std::count_if(
        text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

/// Column of the description in "  --option TYPE   description" or "name  description"; without one the
/// column of the first letter
size_t column_of_description(const std::string& line)
{
    const size_t first = line.find_first_not_of(' ');
    if (first == std::string::npos) return 0;
    const size_t gap = line.find("  ", first);
    const size_t after = gap == std::string::npos ? gap : line.find_first_not_of(' ', gap);
    return after == std::string::npos ? first : after;
}

}  // namespace

std::string wrapped_help(const std::string& text, size_t width)
{
    std::string out;
    for (size_t begin = 0; begin < text.size();) {
        const size_t end = std::min(text.find('\n', begin), text.size());
        std::string line = text.substr(begin, end - begin);
        begin = end + 1;
        const size_t indent = column_of_description(line);
        while (characters(line) > width) {
            // the last blank of the first `width` characters that is not part of the indentation
            size_t at = 0;
            for (size_t count = 0; at < line.size() && count <= width; ++at)
                count += (static_cast<unsigned char>(line[at]) & 0xC0) != 0x80;
            at = line.rfind(' ', at - 1);
            if (at == std::string::npos || at <= indent) break;  // one long word
            out += line.substr(0, line.find_last_not_of(' ', at) + 1) + '\n';
            line = std::string(indent, ' ') + line.substr(at + 1);
        }
        out += line + '\n';
    }
    return out;
}

}  // namespace hilda::io
