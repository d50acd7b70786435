// SPDX-License-Identifier: GPL-3.0-or-later
/// The rows of a joint that keep the coordinates of two points at constant differences.
#pragma once

#include "dae/body.hpp"
#include "lie/rows.hpp"

#include <array>

namespace hilda::dae {

using lie::State;

/// A row c e · d_ij = f between points P of body i and Q of body j, with a global axis e, numbers c and f,
/// and the vector d_ij from P to Q. See CD.
struct PointRow {
    int i, j;
    Vec3 s_bar_i, s_bar_j;  ///< P and Q in the body frames [m]
    int axis;
    double c, f;
};

/// Up to three consecutive rows for the same points. They are evaluated together, so that a spherical joint
/// reads its data and the vectors of its points once.
///
/// The values are those of CD, up to rounding.
class PointRows {
public:
    /// `first`: number of the row in the equations; `entry`: its first entry in lie::Rows::entry
    PointRows(const PointRow& row, int first, int entry);

    /// Adds a row if it is the next one, and has the same points; otherwise returns false.
    bool add(const PointRow& row, int number);

    /// Φ of the rows
    void phi(const State& x, double* out) const;
    /// Φ_r and Π̄ of the rows
    void variation(const State& x, lie::Rows::Entry* out) const;
    /// γ of the rows
    void gamma(const State& x, double* out) const;

    int first;  ///< number of the first row in the equations
    int rows;
    int entry;  ///< first entry of the first row

private:
    int i, j;
    Vec3 s_bar_i, s_bar_j;
    std::array<int, 3> axis{};
    std::array<double, 3> c{}, f{};
};

}  // namespace hilda::dae
