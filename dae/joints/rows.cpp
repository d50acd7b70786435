// SPDX-License-Identifier: GPL-3.0-or-later
/// Rows that joints have in common.
#include "dae/joints/rows.hpp"

#include "dae/constraints/cd.hpp"
#include "dae/constraints/dp1.hpp"
#include "dae/constraints/dp2.hpp"
#include "lie/check.hpp"

#include <cmath>

namespace hilda::dae {

Vec3 unit(const Vec3& axis)
{
    const double length = axis.norm();
    if (!(length > 0) || !std::isfinite(length))
        lie::reject("joint", "an axis must have a positive length", length);
    return axis / length;
}

Perpendicular::Perpendicular(const Vec3& axis)
{
    const Vec3 a = unit(axis);
    Eigen::Index smallest = 0;
    a.cwiseAbs().minCoeff(&smallest);
    first = a.cross(Vec3::Unit(smallest)).normalized();
    second = a.cross(first);
}

void coincide(Blocks& blocks, int i, const Vec3& s_bar_i, int j, const Vec3& s_bar_j)
{
    for (int k = 0; k < 3; ++k) add<CD>(blocks, Vec3::Unit(k), i, s_bar_i, j, s_bar_j);
}

void parallel(Blocks& blocks, int i, const Vec3& axis_bar_i, int j, const Vec3& axis_bar_j)
{
    const Perpendicular p(axis_bar_i);
    add<DP1>(blocks, i, p.first, j, unit(axis_bar_j));
    add<DP1>(blocks, i, p.second, j, unit(axis_bar_j));
}

void on_axis(Blocks& blocks, int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j)
{
    const Perpendicular p(axis_bar_i);
    add<DP2>(blocks, i, p.first, s_bar_i, j, s_bar_j);
    add<DP2>(blocks, i, p.second, s_bar_i, j, s_bar_j);
}

}  // namespace hilda::dae
