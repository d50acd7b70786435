// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/fields/cell_weights.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

namespace {

using Three = std::array<double, 3>;

struct QuadraturePoint {
    double place, weight;
};
/// Gauss-Legendre, on the interval from 0 to 1
constexpr std::array<QuadraturePoint, 4> quadrature = {{{0.06943184420297371, 0.17392742256872693},
                                                        {0.33000947820757187, 0.32607257743127307},
                                                        {0.66999052179242813, 0.32607257743127307},
                                                        {0.93056815579702629, 0.17392742256872693}}};

/// Smallest integer n with n ≥ x, within the range of int
int rounded_up(double x) { return static_cast<int>(std::ceil(std::clamp(x, -2e9, 2e9))); }

Vec3 vector(const Three& v) { return {v[0], v[1], v[2]}; }

}  // namespace

std::vector<Footprint> CellWeights::of_line(const Vec3& r, const Vec3& a) const
{
    const Three from = {r.x, r.y, r.z}, along = {a.x, a.y, a.z};
    // the images n = first … last of each axis whose kernels reach into the grid
    std::array<int, 3> first = {}, last = {};
    Three low = {}, high = {};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(from[axis], from[axis] + along[axis]) - kernel.reach();
        high[axis] = std::max(from[axis], from[axis] + along[axis]) + kernel.reach();
        if (const double period = grid.period[axis]; period > 0) {
            first[axis] = rounded_up((grid.low[axis] - high[axis]) / period);
            last[axis] = -rounded_up(-(grid.high[axis] - low[axis]) / period);
        }
    }
    std::vector<Footprint> all;
    for (int k = first[2]; k <= last[2]; ++k)
        for (int j = first[1]; j <= last[1]; ++j)
            for (int i = first[0]; i <= last[0]; ++i) {
                const std::array<int, 3> image = {i, j, k};
                Footprint one;
                Three at = from;
                std::size_t size = 1;
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    const double shift = image[axis] * grid.period[axis], edge = grid.edge(int(axis)),
                                 most = grid.cells[axis];
                    at[axis] += shift;
                    const double begin = std::floor((low[axis] + shift - grid.low[axis]) / edge),
                                 end = std::ceil((high[axis] + shift - grid.low[axis]) / edge);
                    one.begin[axis] = static_cast<int>(std::clamp(begin, 0., most));
                    one.count[axis] = static_cast<int>(std::clamp(end, 0., most)) - one.begin[axis];
                    size *= static_cast<std::size_t>(std::max(0, one.count[axis]));
                }
                if (size == 0) continue;
                one.weight.assign(size, 0);
                fill(one, at, along);
                all.push_back(std::move(one));
            }
    return all;
}

void CellWeights::fill(Footprint& to, const Three& r, const Three& a) const
{
    if (grid.values == FieldGrid::Values::points) {
        double* weight = to.weight.data();
        for (int k = 0; k < to.count[2]; ++k)
            for (int j = 0; j < to.count[1]; ++j)
                for (int i = 0; i < to.count[0]; ++i) {
                    const Vec3 x = grid.centre(to.begin[0] + i, to.begin[1] + j, to.begin[2] + k);
                    // φ(x - (r + s a)) is symmetric
                    *weight++ = grid.volume() * kernel.line(vector(r) - x, vector(a));
                }
        return;
    }
    const bool gaussian = kernel.type == Kernel::Type::gaussian;
    const auto add = [&](const Three& at, double factor) {
        gaussian ? add_gaussian(to, at, factor) : add_lucy(to, at, factor);
    };
    const double length = vector(a).norm();
    if (length == 0) return add(r, 1);
    const int panels = std::max(1, rounded_up(length / kernel.width));
    for (int n = 0; n < panels; ++n)
        for (const QuadraturePoint& q : quadrature) {
            const double s = (n + q.place) / panels;
            add({r[0] + s * a[0], r[1] + s * a[1], r[2] + s * a[2]}, q.weight / panels);
        }
}

void CellWeights::add_gaussian(Footprint& to, const Three& r, double factor) const
{
    thread_local std::array<std::vector<double>, 3> of_axis;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto up_to = [&](int cell) {
            return kernel.integral(grid.low[axis] + cell * grid.edge(int(axis)) - r[axis]);
        };
        const int begin = to.begin[axis];
        double below = up_to(begin), within = 1;
        if (is_closed(axis)) {
            if (is_outside(axis, r[axis])) return;
            within = up_to(grid.cells[axis]) - up_to(0);
        }
        of_axis[axis].resize(static_cast<std::size_t>(to.count[axis]));
        for (double& weight : of_axis[axis]) {
            const double above = up_to(begin + 1 + static_cast<int>(&weight - of_axis[axis].data()));
            weight = (above - below) / within, below = above;
        }
    }
    double* weight = to.weight.data();
    for (const double z : of_axis[2])
        for (const double y : of_axis[1])
            for (const double x : of_axis[0]) *weight++ += factor * z * y * x;
}

void CellWeights::add_lucy(Footprint& to, const Three& r, double factor) const
{
    // Gauss-Legendre points in the cube around the kernel: two on each of `panels` parts of an edge of a
    // cell, with equal weights
    struct Point {
        double square;  ///< of the coordinate relative to r, over w²
        int cell;       ///< in the block; -1: outside of it
    };
    thread_local std::array<std::vector<Point>, 3> of_axis;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        of_axis[axis].clear();
        if (is_closed(axis) && is_outside(axis, r[axis])) return;
        const int panels = std::max(1, rounded_up(3 * grid.edge(int(axis)) / kernel.width)),
                  end = grid.cells[axis] * panels;
        const double panel = grid.edge(int(axis)) / panels, at = (r[axis] - grid.low[axis]) / panel,
                     reach = kernel.width / panel;
        for (int n = -rounded_up(reach - at); n < rounded_up(at + reach); ++n) {
            if (is_closed(axis) && (n < 0 || n >= end)) continue;
            const int cell = n < 0 ? -1 : n / panels - to.begin[axis];
            for (const double place : {-1., 1.}) {
                const double x = (n + 0.5 + place / std::sqrt(12.) - at) / reach;
                of_axis[axis].push_back({x * x, cell >= 0 && cell < to.count[axis] ? cell : -1});
            }
        }
    }
    thread_local std::vector<double> values;
    values.assign(to.weight.size(), 0);
    double sum = 0;
    for (const Point& z : of_axis[2])
        for (const Point& y : of_axis[1]) {
            const double yz = y.square + z.square;
            if (yz >= 1) continue;
            const int row = (z.cell * to.count[1] + y.cell) * to.count[0];
            const bool in_block = z.cell >= 0 && y.cell >= 0;
            for (const Point& x : of_axis[0]) {
                const double value = Kernel::lucy(yz + x.square);
                sum += value;
                if (in_block && x.cell >= 0) values[static_cast<std::size_t>(row + x.cell)] += value;
            }
        }
    for (std::size_t k = 0; k < values.size(); ++k) to.weight[k] += factor / sum * values[k];
}

}  // namespace hilda::granular
