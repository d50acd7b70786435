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
constexpr double max_cell = 1LL << 40;                // cell numbers beyond this are clamped
constexpr std::uint64_t golden = 0x9E3779B97F4A7C15;  // 2⁶⁴ divided by the golden ratio (Fibonacci hashing)

std::uint64_t hash(const std::array<std::int64_t, 3>& cell)
{
    std::uint64_t h = 0;
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

    const double size = cell_factor * std::max(2 * largest + margin, std::numeric_limits<double>::min());
    const size_t buckets = std::bit_ceil(static_cast<size_t>(bodies) + 1);
    const auto bucket = [&](const Cell& at) { return hash(at) & (buckets - 1); };
    cell.resize(bodies);
    first.assign(buckets + 1, 0);
    for (int b = 0; b < bodies; ++b) {
        if (!is_ball(b)) continue;
        for (int k = 0; k < 3; ++k)
            cell[b][k] =
                static_cast<std::int64_t>(std::floor(std::clamp(centre[b][k] / size, -max_cell, max_cell)));
        ++first[bucket(cell[b])];
    }
    for (size_t k = 0; k < buckets; ++k) first[k + 1] += first[k];  // end of bucket k
    sorted.resize(bodies);
    for (int b = bodies - 1; b >= 0; --b)
        if (is_ball(b)) sorted[--first[bucket(cell[b])]] = b;  // after the loop: the beginning of the bucket

    found.clear();
    for (int i = 0; i < bodies; ++i) {
        const size_t first_of_i = found.size();
        if (is_ball(i)) {
            for (int k = 0; k < 27; ++k) {
                const Cell at = {cell[i][0] + k % 3 - 1, cell[i][1] + k / 3 % 3 - 1, cell[i][2] + k / 9 - 1};
                const size_t in = bucket(at);
                for (int k_sorted = first[in]; k_sorted < first[in + 1]; ++k_sorted) {
                    const int j = sorted[k_sorted];
                    const double limit = reach[i] + reach[j] + margin;
                    if (j > i && cell[j] == at && (centre[i] - centre[j]).squaredNorm() < limit * limit)
                        found.push_back({i, j});
                }
            }
            for (const int j : unbounded)
                if (j > i) found.push_back({i, j});
        } else if (reach[i] >= 0) {
            for (int j = i + 1; j < bodies; ++j)
                if (is_ball(j)) found.push_back({i, j});
        }
        std::sort(found.begin() + static_cast<std::ptrdiff_t>(first_of_i), found.end(),
                  [](const Candidate& a, const Candidate& b) { return a.j < b.j; });
    }
    return found;
}

}  // namespace hilda::contact
