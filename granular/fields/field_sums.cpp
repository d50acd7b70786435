// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/fields/field_sums.hpp"

#include "granular/backend/par.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

std::vector<FieldSums::Part> FieldSums::parts(const FieldParticle& p) const
{
    const Vec3 P = p.mass * p.v;
    return {{weights.of_point(p.r),
             mass,
             11,
             {p.mass, p.volume, P.x, P.y, P.z, P.x * p.v.x, P.x * p.v.y, P.x * p.v.z, P.y * p.v.y,
              P.y * p.v.z, P.z * p.v.z}}};
}

std::vector<FieldSums::Part> FieldSums::parts(const FieldContact& c) const
{
    const Vec3 &l = c.l, &F = c.F;
    std::vector<Part> all;
    all.push_back({weights.of_line(c.r, -l),
                   stress,
                   9,
                   {l.x * F.x, l.x * F.y, l.x * F.z, l.y * F.x, l.y * F.y, l.y * F.z, l.z * F.x, l.z * F.y,
                    l.z * F.z}});
    if (c.boundary) all.push_back({weights.of_point(c.r - l), force, 3, {F.x, F.y, F.z}});
    return all;
}

void FieldSums::add_layer(int layer, std::size_t axis, const std::vector<Part>& all)
{
    for (const Part& part : all)
        for (const Footprint& f : part.footprints) {
            std::array<int, 3> begin = {}, end = f.count;  // in the block
            begin[axis] = layer - f.begin[axis], end[axis] = begin[axis] + 1;
            if (begin[axis] < 0 || begin[axis] >= f.count[axis]) continue;
            for (int k = begin[2]; k < end[2]; ++k)
                for (int j = begin[1]; j < end[1]; ++j)
                    for (int i = begin[0]; i < end[0]; ++i) {
                        const int in_block = (k * f.count[1] + j) * f.count[0] + i;
                        const double weight = f.weight[static_cast<std::size_t>(in_block)];
                        double* to =
                            &cells[grid.number(f.begin[0] + i, f.begin[1] + j, f.begin[2] + k)][part.first];
                        for (int n = 0; n < part.count; ++n) to[n] += weight * part.addend[n];
                    }
        }
}

/// Adds the items in blocks: first the weights of a block, by items, then its sums, by layers of the grid.
template <class Item>
void FieldSums::add_each(const std::vector<Item>& items)
{
    // The footprints of a block need about 64 MB at most.
    double cells_of_kernel = 1;
    for (int a = 0; a < 3; ++a)
        cells_of_kernel *= std::min(4 * kernel.reach() / grid.edge(a) + 2., 1. * grid.cells[a]);
    const auto most = static_cast<std::size_t>(std::clamp(8e6 / cells_of_kernel, 1., 512.));
    const std::size_t axis =
        static_cast<std::size_t>(std::max_element(grid.cells.begin(), grid.cells.end()) - grid.cells.begin());
    for (std::size_t begin = 0; begin < items.size(); begin += most) {
        std::vector<std::vector<Part>> of_item(std::min(most, items.size() - begin));
        par::for_each(
            par::Cpu(), of_item.size(), [&](std::uint32_t n) { of_item[n] = parts(items[begin + n]); }, 8);
        par::for_each(
            par::Cpu(), static_cast<std::size_t>(grid.cells[axis]),
            [&](std::uint32_t layer) {
                for (const std::vector<Part>& all : of_item) add_layer(static_cast<int>(layer), axis, all);
            },
            1);
    }
}

void FieldSums::add(const FieldInput& instant)
{
    add_each(instant.particles);
    add_each(instant.contacts);
    ++count;
}

bool FieldSums::is_finite() const
{
    return std::all_of(cells.begin(), cells.end(), [](const std::array<double, sums>& cell) {
        return std::all_of(cell.begin(), cell.end(), [](double x) { return std::isfinite(x); });
    });
}

void FieldSums::reset()
{
    std::fill(cells.begin(), cells.end(), std::array<double, sums>{});
    count = 0;
}

FieldValues FieldSums::values(std::size_t k) const
{
    FieldValues v;
    if (count == 0) return v;
    std::array<double, sums> s = cells[k];
    for (double& sum : s) sum /= static_cast<double>(count) * grid.volume();
    v.density = s[mass], v.volume_fraction = s[volume];
    v.momentum = {s[momentum], s[momentum + 1], s[momentum + 2]};
    v.boundary_force = {s[force], s[force + 1], s[force + 2]};
    std::copy_n(&s[stress], 9, v.contact_stress.begin());
    if (!(v.density > 0)) return v;
    v.velocity = (1 / v.density) * v.momentum;
    const double u[] = {v.velocity.x, v.velocity.y, v.velocity.z};
    constexpr int place[] = {0, 1, 2, 1, 3,
                             4, 2, 4, 5};  // of a component among the sums xx, xy, xz, yy, yz, zz
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            v.kinetic_stress[3 * a + b] = s[flux + place[3 * a + b]] - v.density * u[a] * u[b];
    return v;
}

}  // namespace hilda::granular
