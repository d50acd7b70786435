// SPDX-License-Identifier: GPL-3.0-or-later
/// The state in which a run chose the pivots of its linear solver.

#pragma once

#include "lie/trajectory.hpp"

namespace hilda::lie {
class Integrator;
}

namespace hilda::run {

/// The state at which the integrator last chose the pivots of its sparse factorisation
/// (Integrator::pivots()). For a scheme that does not provide this state, the node at the start of the step
/// in which it chose them.
///
/// The pivots are the only data of a fixed-step scheme outside the state. A new integrator that chooses
/// its pivots at the same state gives the same digits from there on.
class PivotNode final : public lie::Observer {
public:
    explicit PivotNode(lie::Integrator& integrator) : integrator(integrator) {}

    void accepted(const lie::State& x, long n, int iterations) override;
    /// Makes a new integrator choose its pivots at the state `from`; h: step [s]
    void restore(const lie::State& from, double h);

    lie::State node;

private:
    lie::Integrator& integrator;
    long last_count = 0;
};

}  // namespace hilda::run
