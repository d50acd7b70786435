// SPDX-License-Identifier: GPL-3.0-or-later
/// Weights of a kernel on the cells of a regular grid.

#pragma once

#include "granular/fields/kernel.hpp"

#include <array>
#include <vector>

namespace hilda::granular {

/// A regular grid, aligned with the axes
struct FieldGrid {
    /// What a cell has: the mean over its volume, or the value at its centre
    enum class Values { averages, points };

    std::array<double, 3> low = {}, high = {};  ///< lower and upper corner [m]
    std::array<int, 3> cells = {1, 1, 1};
    /// Period of the particles along each axis [m]; 0: none. The grid is not longer.
    std::array<double, 3> period = {};
    Values values = Values::averages;
    /// Whether the kernel is cut at the sides of the grid, those along periodic axes excepted, and divided by
    /// its integral inside. A kernel whose centre is outside has no weight. Of averages only.
    bool closed = false;

    double edge(int axis) const
    {
        const auto a = static_cast<std::size_t>(axis);
        return (high[a] - low[a]) / cells[a];
    }
    double volume() const { return edge(0) * edge(1) * edge(2); }  ///< of a cell [m³]
    std::size_t count() const { return static_cast<std::size_t>(cells[0]) * cells[1] * cells[2]; }
    /// Number of a cell: x varies fastest
    std::size_t number(int i, int j, int k) const
    {
        return (static_cast<std::size_t>(k) * cells[1] + j) * cells[0] + i;
    }
    Vec3 centre(int i, int j, int k) const
    {
        return {low[0] + (i + 0.5) * edge(0), low[1] + (j + 0.5) * edge(1), low[2] + (k + 0.5) * edge(2)};
    }
};

/// Weights of the cells of a block, x fastest: the integral of the kernel over each cell
struct Footprint {
    std::array<int, 3> begin = {}, count = {};
    std::vector<double> weight;
};

/// Weights of the cells for a kernel at a point r, and for its mean on the line from r to r + a. Images
/// across periodic sides have footprints of their own.
///
/// The weights of all cells sum up to 1 if the grid contains the whole kernel, and always if it is closed
/// and contains the point.
///
///     gaussian:  integrals in closed form
///     lucy:      Gauss-Legendre quadrature with 2 × 2 × 2 points in each cube of edge w/3 or less of a cell,
///                divided by the sum over all points, also those outside of the grid
///     a line:    Gauss-Legendre quadrature with four points for each length of w
///
/// With FieldGrid::Values::points, a weight is the value at the centre of the cell, in closed form, times its
/// volume. The sum is then close to 1 if the cells are small compared to the width.
class CellWeights {
public:
    CellWeights(const FieldGrid& grid, const Kernel& kernel) : grid(grid), kernel(kernel) {}

    std::vector<Footprint> of_point(const Vec3& r) const { return of_line(r, {0, 0, 0}); }
    std::vector<Footprint> of_line(const Vec3& r, const Vec3& a) const;

private:
    void fill(Footprint& to, const std::array<double, 3>& r, const std::array<double, 3>& a) const;
    void add_gaussian(Footprint& to, const std::array<double, 3>& r, double factor) const;
    void add_lucy(Footprint& to, const std::array<double, 3>& r, double factor) const;
    bool is_closed(std::size_t axis) const { return grid.closed && grid.period[axis] == 0; }
    /// Points on a side of the grid, such as contact points with a wall there, are inside in spite of
    /// rounding.
    bool is_outside(std::size_t axis, double x) const
    {
        const double rounding = 1e-9 * (grid.high[axis] - grid.low[axis]);
        return x < grid.low[axis] - rounding || x > grid.high[axis] + rounding;
    }

    FieldGrid grid;
    Kernel kernel;
};

}  // namespace hilda::granular
