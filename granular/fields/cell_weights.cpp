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
    const double length = vector(a).norm(), panel = gaussian ? kernel.width : kernel.width / 2;
    if (length == 0) return add(r, 1);
    const int panels = std::max(1, rounded_up(length / panel));
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
    struct Point {
        std::size_t cell;
        double value;
    };
    thread_local std::vector<Point> inside;
    inside.clear();
    // Gauss-Legendre points: two on each of `panels` parts of an edge of a cell, with equal weights
    std::array<int, 3> panels = {}, first = {}, last = {};
    Three panel = {};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        panels[axis] = std::max(1, rounded_up(3 * grid.edge(int(axis)) / kernel.width));
        panel[axis] = grid.edge(int(axis)) / panels[axis];
        const double at = (r[axis] - grid.low[axis]) / panel[axis], reach = kernel.width / panel[axis];
        first[axis] = -2 * rounded_up(reach - at), last[axis] = 2 * rounded_up(at + reach) - 1;
        if (!is_closed(axis)) continue;
        if (is_outside(axis, r[axis])) return;
        first[axis] = std::max(first[axis], 0);
        last[axis] = std::min(last[axis], 2 * grid.cells[axis] * panels[axis] - 1);
    }
    double sum = 0;
    std::array<int, 3> n = {};
    constexpr double gauss = 0.28867513459481287;  // 1/(2 √3)
    const auto place = [&](std::size_t axis) {
        const int number = n[axis] >> 1;
        const double in_panel = 0.5 + ((n[axis] & 1) != 0 ? gauss : -gauss);
        return grid.low[axis] + (number + in_panel) * panel[axis] - r[axis];
    };
    const auto cell = [&](std::size_t axis) {  // in the block
        return n[axis] < 0 ? -1 : n[axis] / (2 * panels[axis]) - to.begin[axis];
    };
    const auto in_block = [&](std::size_t axis) { return cell(axis) >= 0 && cell(axis) < to.count[axis]; };
    for (n[2] = first[2]; n[2] <= last[2]; ++n[2])
        for (n[1] = first[1]; n[1] <= last[1]; ++n[1])
            for (n[0] = first[0]; n[0] <= last[0]; ++n[0]) {
                const double value = kernel.value({place(0), place(1), place(2)});
                sum += value;
                if (value > 0 && in_block(0) && in_block(1) && in_block(2)) {
                    const int row = cell(2) * to.count[1] + cell(1);
                    inside.push_back({static_cast<std::size_t>(row) * to.count[0] + cell(0), value});
                }
            }
    for (const Point& p : inside) to.weight[p.cell] += factor * p.value / sum;
}

}  // namespace hilda::granular
