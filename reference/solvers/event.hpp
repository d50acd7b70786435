// SPDX-License-Identifier: GPL-3.0-or-later
/// Integration of an ordinary differential equation up to an event: a ball stops, slips or lifts off.

#pragma once

#include "reference/solvers/ode.hpp"

namespace hilda::reference {

/// Event function g(t, y). The event is the zero of g with decreasing g. g is continuous along the solution.
using Event = std::function<double(double t, const ConstVectorRef& y)>;

/// Integrates as ode.advance(t, y, t_end) does, but stops at the first event. Returns true if it stopped
/// there.
///
/// g is evaluated every `interval` seconds. An event lies between two evaluations with g > 0 and then g ≤ 0;
/// if g ≤ 0 at the start, g must first become positive. Two events within one interval can be missed. The
/// event is located by regula falsi (Illinois variant), and each trial integrates from the start of the
/// interval. The search stops at g = 0 or when the bracket is a few units of rounding of t wide.
///
/// Throws lie::InvalidInput if interval ≤ 0, and the exceptions of Ode::advance().
bool advance_to_event(Ode& ode, double& t, VectorRef y, double t_end, double interval, const Event& g);

}  // namespace hilda::reference
