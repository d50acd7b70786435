// SPDX-License-Identifier: GPL-3.0-or-later
/// Nearest known word to a misspelt one, for messages that end with "did you mean ...?".

#pragma once

#include <algorithm>
#include <cctype>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hilda::io {

/// Edit distance of two words (optimal string alignment): the number of insertions, deletions, replacements
/// and transpositions of adjacent letters that turn a into b. Case is ignored.
inline std::size_t edit_distance(std::string_view a, std::string_view b)
{
    const auto same = [](char x, char y) {
        return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y));
    };
    // d[i][j] is the distance of the first i letters of a from the first j letters of b.
    std::vector d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
    for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        for (std::size_t j = 1; j <= b.size(); ++j) {
            d[i][j] =
                std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + !same(a[i - 1], b[j - 1])});
            if (i > 1 && j > 1 && same(a[i - 1], b[j - 2]) && same(a[i - 2], b[j - 1]))
                d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
        }
    }
    return d[a.size()][b.size()];
}

/// The first of the known words with the smallest edit distance. An empty string if all distances exceed two,
/// or half of the length of the word. The second bound avoids suggestions such as 't' for 'x' or 'cos' for
/// 'pow'.
inline std::string nearest(std::string_view word, std::span<const std::string> known)
{
    std::string best;
    std::size_t bound = std::min<std::size_t>(2, word.size() / 2) + 1;
    for (const std::string& candidate : known) {
        // A difference of lengths above the bound needs no table. This keeps long words cheap.
        if (word.size() >= candidate.size() + bound || candidate.size() >= word.size() + bound) continue;
        const std::size_t distance = edit_distance(word, candidate);
        if (distance < bound) {
            bound = distance;
            best = candidate;
        }
    }
    return best;
}

/// The ending "; did you mean 'x'?" of a message, or nothing if no known word is near
inline std::string did_you_mean(std::string_view word, std::span<const std::string> known)
{
    const std::string meant = nearest(word, known);
    return meant.empty() ? "" : "; did you mean '" + meant + "'?";
}

/// The text " 'x'; did you mean 'y'?", where y is the known word nearest to x; without the question if no
/// known word is near.
inline std::string with_nearest(const std::string& word, std::span<const std::string> known)
{
    return " '" + word + "'" + did_you_mean(word, known);
}

}  // namespace hilda::io
