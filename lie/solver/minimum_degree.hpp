// SPDX-License-Identifier: GPL-3.0-or-later
/// Order of elimination with little fill-in.

#pragma once

#include <set>
#include <vector>

namespace hilda::lie {

/// A minimum degree order of the nodes of a graph, by AMD of SuiteSparse. neighbours[n]: the nodes adjacent
/// to node n, both ways
std::vector<int> minimum_degree_order(const std::vector<std::set<int>>& neighbours);

}  // namespace hilda::lie
