// SPDX-License-Identifier: GPL-3.0-or-later
/// The known word meant by a misspelt one, for messages that end with "did you mean ...?".

#pragma once

#include <algorithm>
#include <cctype>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hilda::dae {

/// Letters to insert, delete, replace or swap with their neighbour to turn a into b (optimal string
/// alignment); capitals count as small letters.
inline std::size_t edit_distance(std::string_view a, std::string_view b)
{
    const auto same = [](char x, char y) {
        return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y));
    };
    // d[i][j] is the distance between the first i letters of a and the first j of b.
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

/// The first of the closest known words, at most two edits and at most half of the word away; "" when none
/// is. The second bound keeps 'x' from suggesting 't', and 'pow' from suggesting 'cos'.
inline std::string nearest(std::string_view word, std::span<const std::string> known)
{
    std::string best;
    std::size_t bound = std::min<std::size_t>(2, word.size() / 2) + 1;
    for (const std::string& candidate : known) {
        // Lengths that differ by more than the bound need no table, however long the word is.
        if (word.size() >= candidate.size() + bound || candidate.size() >= word.size() + bound) continue;
        const std::size_t distance = edit_distance(word, candidate);
        if (distance < bound) {
            bound = distance;
            best = candidate;
        }
    }
    return best;
}

}  // namespace hilda::dae
