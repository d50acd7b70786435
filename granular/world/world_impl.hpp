// SPDX-License-Identifier: GPL-3.0-or-later
/// Functions shared by the source files of World.

#pragma once

#include "granular/world/world.hpp"
#include "io/error.hpp"

#include <cmath>
#include <initializer_list>
#include <sstream>

namespace hilda::granular::detail {

inline std::string name_of(std::uint32_t id) { return "particle " + std::to_string(id); }

/// Whether the scheme uses the accelerations of the previous step
inline bool uses_previous_acceleration(Scheme s)
{
    return s == Scheme::chung || s == Scheme::velocity_verlet;
}

template <class Value>
[[noreturn]] void refuse(const std::string& where, const std::string& what, const Value& value)
{
    std::ostringstream text;
    text.precision(9);
    text << where << ": " << what << ", got " << value;
    throw io::InvalidInput(text.str());
}

/// The first component that is not finite, for a message
inline double not_finite(std::initializer_list<Vec3> all)
{
    for (const Vec3& v : all)
        for (const double x : {v.x, v.y, v.z})
            if (!std::isfinite(x)) return x;
    return 0;
}

/// Whether the force and its tangential part on two equal spheres with this radius [m] and mass [kg], or on
/// one at a boundary, agree in single and double precision. Products such as m* times a stiffness may
/// overflow or vanish in single precision although radius, mass and stiffness do not. h: step size [s]
bool has_single_forces(const PairLaw& law, double radius, double mass, double h);

inline Vec3 to_double(const Vec<float>& v) { return {v.x, v.y, v.z}; }
/// The first number of the record that is not finite; 0 if all are
double not_finite(const WatchRecord& record);
/// The cell exists, and along each axis the position is less than a cell away from it: it was inside when the
/// neighbour list was built. The width of the widest cell counts, for all worlds.
inline bool is_near_domain(const CellGrid& g, const Position& p)
{
    const std::int32_t x = g.x_of(p.cell), y = g.y_of(p.cell), z = g.z_of(p.cell);
    const auto near = [](std::int32_t at) { return at >= -CellGrid::widest && at < 2 * CellGrid::widest; };
    return x < g.cells[0] && y < g.cells[1] && z < g.cells[2] && near(g.local(p.x, x, 0)) &&
           near(g.local(p.y, y, 1)) && near(g.local(p.z, z, 2));
}
/// From the centre of particle j of a pair, or of its image, to that of i [m]
inline Vec3 separation(const CellGrid& g, const Arrays<par::Cpu>& of, std::uint32_t pair)
{
    const Pairs<par::Cpu>& pairs = of.pairs;
    const Position* const position = of.particle.position.data();
    const Position &i = position[pairs.i.data()[pair]], &j = position[pairs.j.data()[pair]];
    const Difference d =
        pairs.image.size() > 0 ? difference(g, i, j, pairs.image.data()[pair]) : difference(g, i, j);
    return g.unit * Vec3{double(d.x), double(d.y), double(d.z)};
}
/// Rounding error of the conversion to single precision, x - float(x). The volatile store is needed: GCC 12
/// with -O3 and AVX optimises the conversion to float and back away when it vectorises the function, and the
/// result is zero.
inline float rounding_error(double x)
{
    const volatile float near = static_cast<float>(x);
    return static_cast<float>(x - near);
}
inline Vec<float> rounding_error(const Vec3& v)
{
    return {rounding_error(v.x), rounding_error(v.y), rounding_error(v.z)};
}
inline double length(const std::array<double, 4>& e)
{
    return std::sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3]);
}
inline std::array<double, 4> unit(const std::array<double, 4>& e)
{
    const double l = length(e);
    return {e[0] / l, e[1] / l, e[2] / l, e[3] / l};
}
inline Float4 to_float4(const Vec3& v, double w)
{
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), static_cast<float>(w)};
}

}  // namespace hilda::granular::detail
