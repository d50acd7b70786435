// SPDX-License-Identifier: GPL-3.0-or-later
/// Errors of a run with evolving contacts relative to the reference solution of its benchmark.

#pragma once

#include "run/columns/contact_rows.hpp"
#include "studies/framework/run.hpp"

#include <array>

namespace hilda::studies {

namespace evolving_norm {

/// Maximum norms over the instants of the reference solution:
///
///     r        Euclidean norm over all bodies [m]
///     A        Frobenius norm over all bodies
///     alpha    Euclidean norm of the contact-point coordinates of all contacts [m]
///     F_N      largest error of the normal force of a contact [N]
enum : int { r, A, alpha, F_N, count };
inline constexpr std::array<const char*, count> names = {"r", "A", "alpha", "F_N"};

}  // namespace evolving_norm

/// Observer that accumulates the errors of a run.
class ReferenceErrors final : public lie::Observer {
public:
    /// h is the interval between nodes [s]. Errors are evaluated at the nodes that coincide with an instant
    /// of the reference solution; the constraint residual is evaluated at every node.
    ReferenceErrors(const Benchmark& c, double h);

    void accepted(const lie::State& x, long n, int iterations) override;

    std::array<double, evolving_norm::count> error{};
    double constraint_norm = 0;  ///< largest constraint residual at any node [m or rad]
    int instants = 0;            ///< number of compared instants

private:
    const Benchmark& c;
    const dae::Model& model;
    const double h;
    const std::vector<const contact::EvolvingContact*> contacts;
};

}  // namespace hilda::studies
