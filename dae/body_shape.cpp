// SPDX-License-Identifier: GPL-3.0-or-later
/// Volume and inertia of homogeneous solids.
#include "dae/body_shape.hpp"

#include <numbers>
#include <stdexcept>

namespace hilda::dae {

namespace {

using lie::Vec3;

/// Moments of inertia for a mass of 1 kg from the mean squares of the coordinates, J_x = <y²> + <z²>
Vec3 moments(const Vec3& mean_square)
{
    const double x = mean_square[0], y = mean_square[1], z = mean_square[2];
    return {y + z, z + x, x + y};
}

/// Mean squares across and along the axis, in the order of the coordinates
Vec3 about_axis(int axis, double across, double along)
{
    Vec3 mean_square = Vec3::Constant(across);
    mean_square[axis] = along;
    return mean_square;
}

}  // namespace

const std::vector<std::string>& BodyShape::types()
{
    static const std::vector<std::string> names = {"box", "sphere", "ellipsoid", "cylinder", "cone"};
    return names;
}

std::size_t BodyShape::count(const std::string& type)
{
    if (type == "sphere") return 1;
    if (has_axis(type)) return 2;
    return type == "box" || type == "ellipsoid" ? 3 : 0;
}

double BodyShape::volume() const
{
    constexpr double pi = std::numbers::pi;
    const std::vector<double>& d = dimensions;
    if (type == "box") return d.at(0) * d.at(1) * d.at(2);
    if (type == "sphere") return 4 * pi / 3 * d.at(0) * d.at(0) * d.at(0);
    if (type == "ellipsoid") return 4 * pi / 3 * d.at(0) * d.at(1) * d.at(2);
    if (type == "cylinder") return pi * d.at(0) * d.at(0) * d.at(1);
    if (type == "cone") return pi / 3 * d.at(0) * d.at(0) * d.at(1);
    throw std::logic_error("dae::BodyShape: unknown type " + type);
}

Mat3 BodyShape::inertia(double mass) const
{
    const std::vector<double>& d = dimensions;
    const auto square = [&](std::size_t k) { return d.at(k) * d.at(k); };
    Vec3 mean_square;
    if (type == "box")
        mean_square = Vec3(square(0), square(1), square(2)) / 12;
    else if (type == "sphere")
        mean_square = Vec3::Constant(square(0) / 5);
    else if (type == "ellipsoid")
        mean_square = Vec3(square(0), square(1), square(2)) / 5;
    else if (type == "cylinder")
        mean_square = about_axis(axis, square(0) / 4, square(1) / 12);
    else if (type == "cone")
        mean_square = about_axis(axis, 3 * square(0) / 20, 3 * square(1) / 80);
    else
        throw std::logic_error("dae::BodyShape: unknown type " + type);
    return Mat3((mass * moments(mean_square)).asDiagonal());
}

}  // namespace hilda::dae
