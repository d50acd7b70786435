// SPDX-License-Identifier: GPL-3.0-or-later
/// The rows of the joints.
#include "dae/joints.hpp"

#include "dae/constraints/cd.hpp"
#include "dae/constraints/d.hpp"
#include "dae/constraints/dp1.hpp"
#include "dae/constraints/dp2.hpp"
#include "dae/constraints/driven_hinge.hpp"
#include "lie/check.hpp"

#include <cmath>
#include <memory>
#include <utility>

namespace hilda::dae {

namespace {

template <class B, class... Arguments>
void add(Blocks& blocks, Arguments&&... arguments)
{
    blocks.push_back(std::make_unique<B>(std::forward<Arguments>(arguments)...));
}

Vec3 unit(const Vec3& axis)
{
    const double length = axis.norm();
    if (!(length > 0) || !std::isfinite(length))
        lie::reject("joint", "an axis must have a positive length", length);
    return axis / length;
}

/// Two unit vectors that form a right-handed orthonormal triad (first, second, axis) with the axis
struct Perpendicular {
    Vec3 first, second;
    explicit Perpendicular(const Vec3& axis)
    {
        const Vec3 a = unit(axis);
        Eigen::Index smallest = 0;
        a.cwiseAbs().minCoeff(&smallest);
        first = a.cross(Vec3::Unit(smallest)).normalized();
        second = a.cross(first);
    }
};

Mat3 orientation(const State& x, int b) { return b == ground ? Mat3::Identity() : x.body[b].A; }
Vec3 position(const State& x, int b) { return b == ground ? Vec3::Zero() : x.body[b].r; }

/// Adds the rows of coinciding points.
void coincide(Blocks& blocks, int i, const Vec3& s_bar_i, int j, const Vec3& s_bar_j)
{
    for (int k = 0; k < 3; ++k) add<CD>(blocks, Vec3::Unit(k), i, s_bar_i, j, s_bar_j);
}

/// Adds the rows of parallel axes.
void parallel(Blocks& blocks, int i, const Vec3& axis_bar_i, int j, const Vec3& axis_bar_j)
{
    const Perpendicular p(axis_bar_i);
    add<DP1>(blocks, i, p.first, j, unit(axis_bar_j));
    add<DP1>(blocks, i, p.second, j, unit(axis_bar_j));
}

/// Adds the rows of a point Q of body j on the axis through P of body i.
void on_axis(Blocks& blocks, int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j)
{
    const Perpendicular p(axis_bar_i);
    add<DP2>(blocks, i, p.first, s_bar_i, j, s_bar_j);
    add<DP2>(blocks, i, p.second, s_bar_i, j, s_bar_j);
}

}  // namespace

Blocks spherical(int i, const Vec3& s_bar_i, int j, const Vec3& s_bar_j)
{
    Blocks blocks;
    coincide(blocks, i, s_bar_i, j, s_bar_j);
    return blocks;
}

Blocks revolute(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j,
                const Vec3& axis_bar_j)
{
    Blocks blocks;
    coincide(blocks, i, s_bar_i, j, s_bar_j);
    parallel(blocks, i, axis_bar_i, j, axis_bar_j);
    return blocks;
}

Blocks cylindrical(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j,
                   const Vec3& axis_bar_j)
{
    Blocks blocks;
    parallel(blocks, i, axis_bar_i, j, axis_bar_j);
    on_axis(blocks, i, s_bar_i, axis_bar_i, j, s_bar_j);
    return blocks;
}

Blocks translational(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j,
                     const Vec3& axis_bar_j, const State& x)
{
    Blocks blocks = cylindrical(i, s_bar_i, axis_bar_i, j, s_bar_j, axis_bar_j);
    const Perpendicular p(axis_bar_i);
    add<DP1>(blocks, i, p.first, j, orientation(x, j).transpose() * (orientation(x, i) * p.second));
    return blocks;
}

Blocks universal(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j,
                 const Vec3& axis_bar_j)
{
    Blocks blocks;
    coincide(blocks, i, s_bar_i, j, s_bar_j);
    add<DP1>(blocks, i, unit(axis_bar_i), j, unit(axis_bar_j));
    return blocks;
}

Blocks revolute_cylindrical(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, int j, const Vec3& s_bar_j,
                            const Vec3& axis_bar_j)
{
    Blocks blocks;
    add<DP1>(blocks, i, unit(axis_bar_i), j, unit(axis_bar_j));
    on_axis(blocks, j, s_bar_j, axis_bar_j, i, s_bar_i);
    return blocks;
}

Blocks fixed(int i, int j, const State& x)
{
    const Mat3 A_ij = orientation(x, i).transpose() * orientation(x, j);
    Blocks blocks;
    coincide(blocks, i, orientation(x, i).transpose() * (position(x, j) - position(x, i)), j, Vec3::Zero());
    for (int k = 0; k < 3; ++k)
        add<DP1>(blocks, i, Vec3::Unit(k), j, A_ij.transpose() * Vec3::Unit((k + 1) % 3));
    return blocks;
}

Blocks distance(int i, const Vec3& s_bar_i, int j, const Vec3& s_bar_j, double length)
{
    if (!(length > 0) || !std::isfinite(length))
        lie::reject("distance joint", "the length must be positive [m]", length);
    Blocks blocks;
    add<D>(blocks, i, s_bar_i, j, s_bar_j, Driver(length * length));
    return blocks;
}

Blocks hinge_driver(int i, const Vec3& axis_bar_i, int j, const Vec3& axis_bar_j, const Driver& g,
                    const State& x)
{
    const Perpendicular p(axis_bar_i);
    const Vec3 axis = orientation(x, i) * unit(axis_bar_i);
    const double c = std::cos(g.f(x.t)), s = std::sin(g.f(x.t));
    const Vec3 towards = orientation(x, i) * (c * p.first + s * p.second);
    // w is perpendicular to the axis of body j, also if the initial data are not exact
    const Vec3 axis_j = orientation(x, j) * unit(axis_bar_j);
    if (axis.dot(axis_j) < 0.9)
        lie::reject("hinge driver",
                    "the two axes must be parallel at the start and point in the same direction; "
                    "cosine of their angle",
                    axis.dot(axis_j));
    const Vec3 w = (towards - axis_j * axis_j.dot(towards)).normalized();
    Blocks blocks;
    add<DrivenHinge>(blocks, i, p.first, p.second, j, orientation(x, j).transpose() * w, g);
    return blocks;
}

}  // namespace hilda::dae
