// SPDX-License-Identifier: GPL-3.0-or-later
/// Lists of contacts (CSV) and networks of contacts for ParaView (VTK).

#pragma once

#include "granular/world/world.hpp"

#include <string>

namespace hilda::granular {

/// t,i,j,boundary,...: the columns of contact_list_csv()
std::string contact_list_header();
/// Appends one line per contact at t: ids, point, normal, overlap, normal force F · n, positive in
/// compression, and tangential force F - (F · n) n. See ContactRecord. SI units, global frame.
void contact_list_csv(std::string& text, double t, const std::vector<ContactRecord>& contacts);

/// A line for each contact: from the centre of i to that of j, across periodic sides to its image, or to the
/// contact point with a boundary. Cell data: `normal force` and `tangential force` [N], `overlap` [m],
/// `boundary` (0 or 1), `i`, `j`. VTK XML PolyData.
std::string contact_network_vtp(const World& world, const std::vector<ContactRecord>& contacts);

}  // namespace hilda::granular
