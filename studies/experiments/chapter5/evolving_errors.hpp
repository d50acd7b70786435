// SPDX-License-Identifier: GPL-3.0-or-later
/// How far a run with contacts that evolve is from the truth of its case.

#pragma once

#include "studies/framework/run.hpp"
#include "studies/running/contact_rows.hpp"

#include <array>

namespace hilda::studies {

namespace evolving_norm {

/// Largest over the instants: r [m] and A (Frobenius) stacked over the bodies, α stacked over the contacts [m], the
/// normal force of any contact [N]
enum : int { r, A, alpha, F_N, count };
inline constexpr std::array<const char*, count> names = {"r", "A", "alpha", "F_N"};

}  // namespace evolving_norm

class ReferenceErrors final : public lie::Observer {
public:
    /// Compares the nodes that are instants of the truth; at others it only takes the residual.
    ReferenceErrors(const Benchmark& c, double h);

    void accepted(const lie::State& x, long n, int iterations) override;

    std::array<double, evolving_norm::count> error{};
    double constraint_norm = 0;  ///< at any node [m or rad]
    int instants = 0;

private:
    const Benchmark& c;
    const dae::Model& model;
    const double h;
    const std::vector<const contact::EvolvingContact*> contacts;
};

}  // namespace hilda::studies
