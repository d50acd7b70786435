// SPDX-License-Identifier: GPL-3.0-or-later
/// Order of elimination and lists of operations of the condensed solver.
#include "lie/solver/condensed.hpp"
#include "lie/solver/condensed_kernels.hpp"
#include "lie/solver/minimum_degree.hpp"

#include <algorithm>
#include <bit>
#include <map>
#include <set>

namespace hilda::lie {

using namespace kernels;

namespace {

// Largest number of blocks in a column for which the order is improved further
constexpr size_t most_blocks = 50;

/// Bits 0 to 2: the components of r of the body on which the row entry depends
unsigned translation_bits(const Rows::Entry& entry) { return entry.nonzero & 0b111; }

/// The blocks of a column are the neighbours of the group that are eliminated after it, and those of its
/// children in the elimination tree. The parent of a group is the first of them. Returns the blocks of each
/// column in the order of elimination, and adds the fill-in to the neighbours.
std::vector<std::vector<int>> eliminate(const std::vector<int>& order, std::vector<std::set<int>>& neighbours)
{
    std::vector<int> position(order.size());
    for (size_t p = 0; p < order.size(); ++p) position[order[p]] = static_cast<int>(p);
    const auto earlier = [&](int a, int b) { return position[a] < position[b]; };
    std::vector<std::vector<int>> below(order.size());
    for (const int g : order) {
        for (const int h : neighbours[g])
            if (earlier(g, h)) below[g].push_back(h);
        std::sort(below[g].begin(), below[g].end(), earlier);
        if (below[g].empty()) continue;
        const int parent = below[g].front();
        for (size_t n = 1; n < below[g].size(); ++n)
            neighbours[parent].insert(below[g][n]), neighbours[below[g][n]].insert(parent);
    }
    return below;
}

/// An order without further fill-in for a graph with its fill-in, of an elimination tree of least height
/// (Jess and Kees 1982): level by level all groups that can be eliminated independently of each other.
/// Operations that follow each other then do not depend on each other, and the processor overlaps them. A
/// chain is eliminated from both ends.
std::vector<int> least_height_order(std::vector<std::set<int>> neighbours)
{
    std::vector<int> order;
    std::set<int> candidates;
    for (int g = 0; g < static_cast<int>(neighbours.size()); ++g) candidates.insert(g);
    const auto is_simplicial = [&](int g) {  // all neighbours are neighbours of each other
        const std::set<int>& all = neighbours[g];
        return std::all_of(all.begin(), all.end(), [&](int a) {
            return std::all_of(all.upper_bound(a), all.end(),
                               [&](int b) { return neighbours[a].count(b) != 0; });
        });
    };
    while (order.size() < neighbours.size()) {
        std::set<int> level, next;
        for (const int g : candidates)
            if (std::none_of(neighbours[g].begin(), neighbours[g].end(),
                             [&](int h) { return level.count(h) != 0; }) &&
                is_simplicial(g))
                level.insert(g);
        for (const int g : level) {
            for (const int h : neighbours[g]) neighbours[h].erase(g);
            next.insert(neighbours[g].begin(), neighbours[g].end());
        }
        order.insert(order.end(), level.begin(), level.end());
        candidates = std::move(next);
    }
    return order;
}

}  // namespace

Condensed::Condensed(const Mass& mass, const Rows& pattern)
{
    for (const double m : mass.m) by_sqrt_m.push_back(1 / std::sqrt(m));
    for (const Mat3& J_bar : mass.J_bar) L_inverse.push_back(Mat3(J_bar.llt().matrixL()).inverse());
    find_groups(pattern);
    find_order(pattern);
}

void Condensed::find_groups(const Rows& pattern)
{
    const auto bodies = [&](int k) {
        std::vector<int> all;
        for (int n = pattern.start[k]; n < pattern.start[k + 1]; ++n) all.push_back(pattern.entry[n].body);
        return all;
    };
    const auto has_translation = [&](int k) {
        const auto entry = pattern.entry.begin();
        return std::any_of(entry + pattern.start[k], entry + pattern.start[k + 1],
                           [](const Rows::Entry& of) { return translation_bits(of) != 0; });
    };
    int w = 0;
    for (int k = 0; k < pattern.rows(); ++k) {
        const std::vector<int> mine = bodies(k);
        if (group.empty() || group.back().rows == most_rows || bodies(group.back().first) != mine ||
            group.back().has_translation != has_translation(k)) {
            group.push_back({.first = k,
                             .rows = 0,
                             .bodies = static_cast<int>(mine.size()),
                             .body = static_cast<int>(body_of.size()),
                             .has_translation = has_translation(k)});
            body_of.insert(body_of.end(), mine.begin(), mine.end());
        }
        ++group.back().rows;
    }
    for (Group& g : group) {
        g.w = w;
        w += 6 * g.bodies;
    }
    W.assign(w, Column{});
    y.assign(group.size(), Column{});
    diagonal.assign(group.size(), Column{1, 1, 1, 1});
}

/// The contribution of a body, number s of group g and number t of group h, without its place in `value`
Condensed::Term Condensed::term_of(const Rows& pattern, int g, int s, int h, int t) const
{
    Translation translation = group[g].has_translation && group[h].has_translation ? one_component : none;
    Term of{.kernel = 0, .w_of = group[g].w + 6 * s, .w_by = group[h].w + 6 * t, .at = 0, .component = {}};
    for (int k = 0; k < group[h].rows; ++k) {
        const unsigned bits = translation_bits(pattern.entry[pattern.start[group[h].first + k] + t]);
        if (std::popcount(bits) > 1 && translation != none) translation = all_components;
        of.component[k] = bits != 0 ? std::countr_zero(bits) : 0;
    }
    of.kernel = (group[h].rows - 1) * translations + translation;
    return of;
}

void Condensed::find_order(const Rows& pattern)
{
    // groups are neighbours if they share a body
    const int n = static_cast<int>(group.size());
    for (int g = 0; g < n; ++g)
        for (int s = 0; s < group[g].bodies; ++s)
            at_body[pattern.entry[pattern.start[group[g].first] + s].body].emplace_back(g, s);
    std::vector<std::set<int>> neighbours(n);
    long couplings = 0;
    for (const auto& [body, all] : at_body)
        for (const auto& [g, s] : all)
            for (const auto& [h, t] : all)
                if (g != h) couplings += neighbours[g].insert(h).second;

    order = minimum_degree_order(neighbours);
    below = eliminate(order, neighbours);
    const auto most = [&] {
        size_t blocks = 0;
        for (const std::vector<int>& of_column : below) blocks = std::max(blocks, of_column.size());
        return blocks;
    };
    if (most() <= most_blocks) {  // the order of a dense matrix makes no difference
        order = least_height_order(neighbours);
        below = eliminate(order, neighbours);
    }
    position.resize(n);
    for (int p = 0; p < n; ++p) position[order[p]] = p;
    divided.assign(most_rows * most(), Column{});

    fill = -couplings / 2;
    for (const auto& [body, all] : at_body)
        for (const auto& [g, s] : all)
            for (const auto& [h, t] : all)
                if (position[g] >= position[h])
                    products +=
                        group[h].rows * (group[g].has_translation && group[h].has_translation ? 4 : 3);
    for (int g = 0; g < n; ++g) {
        const double m = group[g].rows, blocks = static_cast<double>(below[g].size());
        products += 0.5 * m * (m + 1) * (1 + blocks);
        fill += static_cast<long>(blocks);
        for (size_t k = 0; k < below[g].size(); ++k)  // the blocks from k on, times block k
            products += m * group[below[g][k]].rows * (blocks - static_cast<double>(k));
    }
}

/// The first column of the block of the rows of group h in the columns of group g
int Condensed::place(int h, int g) const
{
    if (h == g) return group[g].diagonal;
    const auto found = std::lower_bound(below[g].begin(), below[g].end(), h,
                                        [&](int a, int b) { return position[a] < position[b]; });
    return group[g].diagonal + group[g].rows * (1 + static_cast<int>(found - below[g].begin()));
}

void Condensed::prepare(const Rows& pattern)
{
    // storage of the blocks, column by column
    int size = 0;
    for (const int g : order) {
        group[g].diagonal = size;
        size += group[g].rows;
        column.push_back(static_cast<int>(block.size()));
        for (const int h : below[g]) {
            block.push_back({.of = h, .at = size});
            size += group[g].rows;
        }
    }
    column.push_back(static_cast<int>(block.size()));
    value.assign(size, Column{});
    for (const int k : pattern.regularised) {
        const auto after = std::upper_bound(group.begin(), group.end(), k,
                                            [](int row, const Group& g) { return row < g.first; });
        const int g = static_cast<int>(after - group.begin()) - 1;
        regularised_at.emplace_back(g, k - group[g].first);
    }

    for (const auto& [body, all] : at_body)
        for (const auto& [g, s] : all)
            for (const auto& [h, t] : all) {
                if (position[g] < position[h]) continue;
                term.push_back(term_of(pattern, g, s, h, t));
                term.back().at = place(g, h);
            }
    // Equal kernels follow each other: their loop has no branches.
    std::stable_sort(term.begin(), term.end(),
                     [](const Term& a, const Term& b) { return a.kernel < b.kernel; });
    for (int kernel = 0; kernel <= most_rows * translations; ++kernel) {
        const auto first =
            std::find_if(term.begin(), term.end(), [&](const Term& t) { return t.kernel >= kernel; });
        term_start.push_back(static_cast<int>(first - term.begin()));
    }
    for (const int g : order) {
        update_start.push_back(static_cast<int>(update.size()));
        for (size_t i = 0; i < below[g].size(); ++i)
            for (size_t j = 0; j <= i; ++j) {
                const int h = below[g][i], k = below[g][j];
                update.push_back({.by = group[k].rows,
                                  .of = static_cast<int>(i) * group[g].rows,
                                  .at_by = place(k, g),
                                  .to = place(h, k)});
            }
    }
    update_start.push_back(static_cast<int>(update.size()));
}

}  // namespace hilda::lie
