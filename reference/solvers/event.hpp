// SPDX-License-Identifier: GPL-3.0-or-later
/// Integration up to where something happens: a ball stops, slips, leaves.

#pragma once

#include "reference/solvers/ode.hpp"

namespace hilda::reference {

/// What happens where this falls through zero; continuous along the motion
using Event = std::function<double(double t, const ConstVectorRef& y)>;

/// As ode.advance, but ends at the first instant at which g is no longer positive after it has been; true then.
/// Where g is not positive at the start, it must first become so. g is looked at every `look` seconds, so that
/// two falls nearer than that can be missed; between two looks the instant is found by regula falsi, each
/// trial integrated from the earlier look, to 1e-15 of t or where g is zero. InvalidInput for look ≤ 0.
bool advance_to_event(Ode& ode, double& t, VectorRef y, double t_end, double look, const Event& g);

}  // namespace hilda::reference
