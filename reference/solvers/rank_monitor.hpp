// SPDX-License-Identifier: GPL-3.0-or-later
/// The rank of the constraint rows during a run with adaptive steps.

#pragma once

namespace hilda::reference {

/// An integrator that watches the rank of the constraint rows at its internal steps.
class RankMonitor {
public:
    /// Smallest reciprocal condition of the saddle matrix with scaled rows, relative to that of the start.
    /// After it has fallen below nearly_dependent once, later configurations are not included.
    struct Smallest {
        double ratio = 1;
        double t = 0;  ///< [s]
    };

    /// The rows may have lost rank between two internal steps
    static constexpr double nearly_dependent = 1e-5;

    virtual ~RankMonitor() = default;
    virtual Smallest smallest_condition() const = 0;
};

}  // namespace hilda::reference
