// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/broad_phase.hpp"

#include "lie/check.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <string>

namespace hilda::contact {

namespace {

constexpr double cell_factor = 1 + 1e-3;              // of the cell size, against rounding of the cell number
constexpr int levels = 48;                            // grids; smaller bodies are in the last one
constexpr double max_cell = 1LL << 40;                // cell numbers beyond this are clamped
constexpr std::uint64_t golden = 0x9E3779B97F4A7C15;  // 2⁶⁴ divided by the golden ratio (Fibonacci hashing)

std::uint64_t hash(const std::array<std::int64_t, 3>& cell, int level)
{
    auto h = static_cast<std::uint64_t>(level);
    for (const std::int64_t k : cell) {
        h = (h ^ static_cast<std::uint64_t>(k)) * golden;
        h ^= h >> 29;
    }
    return h;
}

}  // namespace

const std::vector<Candidate>& BroadPhase::find(std::span<const Vec3> centre, std::span<const double> reach,
                                               double margin)
{
    constexpr const char* where = "contact::BroadPhase";
    if (centre.size() != reach.size())
        lie::reject(where, "the numbers of centres and reaches must be equal; number of reaches",
                    reach.size());
    if (!(margin >= 0) || !std::isfinite(margin))
        lie::reject(where, "the margin must be finite and not negative", margin);

    const int bodies = static_cast<int>(centre.size());
    double largest = 0;
    unbounded.clear();
    for (int b = 0; b < bodies; ++b) {
        if (std::isnan(reach[b])) lie::reject(where, "the reach of a body must be a number", reach[b]);
        if (std::isinf(reach[b]) && reach[b] > 0)
            unbounded.push_back(b);
        else if (reach[b] >= 0 && !centre[b].allFinite())
            throw lie::NumericalFailure("nonfinite", "contact::BroadPhase: the centre of body " +
                                                         std::to_string(b) + " is not finite");
        else
            largest = std::max(largest, reach[b]);
    }
    const auto is_ball = [&](int b) { return reach[b] >= 0 && std::isfinite(reach[b]); };

    // Grid of a body: the number of halvings of the largest cell that still contains the body
    const double size = cell_factor * std::max(2 * largest + margin, std::numeric_limits<double>::min());
    level.resize(bodies);
    cell.resize(bodies);
    std::array<bool, levels> is_used{};
    for (int b = 0; b < bodies; ++b) {
        if (!is_ball(b)) continue;
        const double own = cell_factor * std::max(2 * reach[b] + margin, std::numeric_limits<double>::min());
        level[b] = std::clamp(std::ilogb(size / own), 0, levels - 1);
        is_used[static_cast<size_t>(level[b])] = true;
    }
    const size_t buckets = std::bit_ceil(static_cast<size_t>(bodies) + 1);
    const auto bucket = [&](const Cell& at, int of_level) { return hash(at, of_level) & (buckets - 1); };
    const auto cell_at = [&](const Vec3& r, int of_level) {
        const double length = std::ldexp(size, -of_level);
        Cell at;
        for (int k = 0; k < 3; ++k)
            at[k] = static_cast<std::int64_t>(std::floor(std::clamp(r[k] / length, -max_cell, max_cell)));
        return at;
    };
    first.assign(buckets + 1, 0);
    for (int b = 0; b < bodies; ++b) {
        if (!is_ball(b)) continue;
        cell[b] = cell_at(centre[b], level[b]);
        ++first[bucket(cell[b], level[b])];
    }
    for (size_t k = 0; k < buckets; ++k) first[k + 1] += first[k];  // end of bucket k
    sorted.resize(bodies);
    for (int b = bodies - 1; b >= 0; --b)
        if (is_ball(b))
            sorted[--first[bucket(cell[b], level[b])]] = b;  // after the loop: the beginning of the bucket

    found.clear();
    for (int i = 0; i < bodies; ++i) {
        if (is_ball(i)) {
            // the own grid and those of larger bodies; a pair is found from its smaller body
            for (int l = 0; l <= level[i]; ++l) {
                if (!is_used[static_cast<size_t>(l)]) continue;
                const Cell centre_cell = l == level[i] ? cell[i] : cell_at(centre[i], l);
                for (int k = 0; k < 27; ++k) {
                    const Cell at = {centre_cell[0] + k % 3 - 1, centre_cell[1] + k / 3 % 3 - 1,
                                     centre_cell[2] + k / 9 - 1};
                    const size_t in = bucket(at, l);
                    for (int k_sorted = first[in]; k_sorted < first[in + 1]; ++k_sorted) {
                        const int j = sorted[k_sorted];
                        if (level[j] != l || (l == level[i] && j <= i) || cell[j] != at) continue;
                        const double limit = reach[i] + reach[j] + margin;
                        ++tests;
                        if ((centre[i] - centre[j]).squaredNorm() < limit * limit)
                            found.push_back({std::min(i, j), std::max(i, j)});
                    }
                }
            }
            for (const int j : unbounded) found.push_back({std::min(i, j), std::max(i, j)});
        }
    }
    std::sort(found.begin(), found.end(),
              [](const Candidate& a, const Candidate& b) { return a.i != b.i ? a.i < b.i : a.j < b.j; });
    return found;
}

}  // namespace hilda::contact
