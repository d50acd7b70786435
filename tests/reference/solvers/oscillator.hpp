// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "reference/solvers/ode.hpp"

namespace hilda::tests {

/// The harmonic oscillator of angular frequency 1 rad/s: y = (position, velocity)
inline void oscillator(double, const reference::ConstVectorRef& y, reference::VectorRef ydot)
{
    ydot[0] = y[1];
    ydot[1] = -y[0];
}

}  // namespace hilda::tests
