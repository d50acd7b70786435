// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/broad_phase.hpp"

#include "lie/check.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <string>

namespace hilda::contact {

namespace {

constexpr double wider = 1 + 1e-3;                    // a cell: rounding of its number must not matter
constexpr double furthest = 1LL << 40;                // number of a cell: from there on all is one
constexpr std::uint64_t golden = 0x9E3779B97F4A7C15;  // 2⁶⁴ over the golden ratio

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
        lie::reject(where, "every body needs a centre and a reach; bodies with a reach", reach.size());
    if (!(margin >= 0) || !std::isfinite(margin))
        lie::reject(where, "the margin must be finite and not negative", margin);

    const int bodies = static_cast<int>(centre.size());
    double largest = 0;
    big.clear();
    for (int b = 0; b < bodies; ++b) {
        if (std::isnan(reach[b])) lie::reject(where, "a reach must be a number", reach[b]);
        if (std::isinf(reach[b]) && reach[b] > 0)
            big.push_back(b);
        else if (reach[b] >= 0 && !centre[b].allFinite())
            throw lie::NumericalFailure("nonfinite", "contact::BroadPhase: the centre of body " +
                                                         std::to_string(b) + " is not finite");
        else
            largest = std::max(largest, reach[b]);
    }
    const auto is_ball = [&](int b) { return reach[b] >= 0 && std::isfinite(reach[b]); };

    const double size = wider * std::max(2 * largest + margin, std::numeric_limits<double>::min());
    const size_t buckets = std::bit_ceil(static_cast<size_t>(bodies) + 1);
    const auto bucket = [&](const Cell& at) { return hash(at) & (buckets - 1); };
    cell.resize(bodies);
    first.assign(buckets + 1, 0);
    for (int b = 0; b < bodies; ++b) {
        if (!is_ball(b)) continue;
        for (int k = 0; k < 3; ++k)
            cell[b][k] =
                static_cast<std::int64_t>(std::floor(std::clamp(centre[b][k] / size, -furthest, furthest)));
        ++first[bucket(cell[b])];
    }
    for (size_t k = 0; k < buckets; ++k) first[k + 1] += first[k];  // where bucket k ends
    sorted.resize(bodies);
    for (int b = bodies - 1; b >= 0; --b)
        if (is_ball(b)) sorted[--first[bucket(cell[b])]] = b;  // and in the end, where it begins

    found.clear();
    for (int i = 0; i < bodies; ++i) {
        const size_t of_i = found.size();
        if (is_ball(i)) {
            for (int k = 0; k < 27; ++k) {
                const Cell at = {cell[i][0] + k % 3 - 1, cell[i][1] + k / 3 % 3 - 1, cell[i][2] + k / 9 - 1};
                const size_t in = bucket(at);
                for (int place = first[in]; place < first[in + 1]; ++place) {
                    const int j = sorted[place];
                    const double near = reach[i] + reach[j] + margin;
                    if (j > i && cell[j] == at && (centre[i] - centre[j]).squaredNorm() < near * near)
                        found.push_back({i, j});
                }
            }
            for (const int j : big)
                if (j > i) found.push_back({i, j});
        } else if (reach[i] >= 0) {
            for (int j = i + 1; j < bodies; ++j)
                if (is_ball(j)) found.push_back({i, j});
        }
        std::sort(found.begin() + static_cast<std::ptrdiff_t>(of_i), found.end(),
                  [](const Candidate& a, const Candidate& b) { return a.j < b.j; });
    }
    return found;
}

}  // namespace hilda::contact
