// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/archive.hpp"
#include "tests/fuzz/targets.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace hilda::fuzz {

namespace {

// See io::Archive: eight letters, version, length; at the end the checksum
constexpr std::size_t before_length = 16, header = 24, sum_bytes = 8;

}  // namespace

std::string sealed(std::string_view content, const std::string& valid)
{
    std::string bytes = valid.substr(0, header) + std::string(content);
    const std::uint64_t length = bytes.size() + sum_bytes;
    std::memcpy(bytes.data() + before_length, &length, sizeof length);
    const std::uint64_t sum = io::checksum(bytes.data(), bytes.size());
    return bytes.append(reinterpret_cast<const char*>(&sum), sum_bytes);
}

std::string_view content_of(const std::string& checkpoint)
{
    return std::string_view(checkpoint).substr(header, checkpoint.size() - header - sum_bytes);
}

CommandLine::CommandLine(const char* program, std::string_view lines)
{
    words.emplace_back(program);
    for (std::size_t begin = 0; begin <= lines.size() && words.size() < 64;) {
        const std::size_t end = std::min(lines.find('\n', begin), lines.size());
        words.emplace_back(lines.substr(begin, end - begin));
        words.back().erase(std::remove(words.back().begin(), words.back().end(), '\0'), words.back().end());
        begin = end + 1;
    }
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
}

}  // namespace hilda::fuzz
