// SPDX-License-Identifier: GPL-3.0-or-later
/// Volume and inertia of homogeneous solids.
#include "dae/body_shape.hpp"

#include "dae/shapes/convex_hull.hpp"
#include "dae/shapes/solid_moments.hpp"
#include "io/json.hpp"
#include "lie/check.hpp"

#include <numbers>
#include <stdexcept>

namespace hilda::dae {

namespace {

using lie::Vec3;

/// Moments of inertia for a mass of 1 kg from the mean squares of the coordinates, J_x = <y²> + <z²>
Vec3 moments_of(const Vec3& mean_square)
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

/// Mean squares of a cylinder of radius R and length L with a half sphere at each end. The centroid of a half
/// sphere is 3/8 R from its flat face:
///
///     across   c R²/4 + (1 - c) R²/5,     along   c L²/12 + (1 - c) (L²/4 + 3 L R/8 + R²/5)
///
/// with the part c = L / (L + 4/3 R) of the volume that is in the cylinder.
Vec3 of_capsule(int axis, double R, double L)
{
    const double cylinder = L / (L + 4. / 3 * R), ends = 4. / 3 * R / (L + 4. / 3 * R);
    const double across = cylinder * R * R / 4 + ends * R * R / 5,
                 along = cylinder * L * L / 12 + ends * (L * L / 4 + 3 * L * R / 8 + R * R / 5);
    return about_axis(axis, across, along);
}

}  // namespace

const std::vector<std::string>& BodyShape::types()
{
    static const std::vector<std::string> names = {"box",     "sphere", "ellipsoid", "cylinder",
                                                   "capsule", "cone",   "convex"};
    return names;
}

std::size_t BodyShape::count(const std::string& type)
{
    if (type == "sphere") return 1;
    if (has_axis(type)) return 2;
    return type == "box" || type == "ellipsoid" ? 3 : 0;
}

BodyShape BodyShape::convex(std::vector<Vec3> vertices, double tolerance)
{
    constexpr const char* where = "a convex shape";
    for (std::size_t k = 0; k < vertices.size(); ++k)
        if (!vertices[k].allFinite())
            lie::reject(where, "vertex " + std::to_string(k) + " must be finite", vertices[k].transpose());
    if (vertices.size() < 4) lie::reject(where, "needs at least 4 vertices", vertices.size());
    const double distance = tolerance * extent(vertices);
    BodyShape shape{.type = "convex", .faces = convex_hull(vertices, distance)};
    if (shape.faces.size() < 4) lie::reject(where, "the vertices must not lie in a plane", "a plate");
    if (const auto inside = inside_point(vertices, shape.faces, 2 * distance); inside)
        lie::reject(where, "the vertices must be those of a convex body",
                    "vertex " + std::to_string(inside->number) + ", which lies " +
                        io::shortest(inside->depth) + " m inside of their hull");
    shape.vertices = std::move(vertices);
    return shape;
}

Vec3 BodyShape::centroid() const
{
    return type == "convex" ? moments(vertices, faces).centroid : Vec3(Vec3::Zero());
}

double BodyShape::volume() const
{
    constexpr double pi = std::numbers::pi;
    const std::vector<double>& d = dimensions;
    if (type == "box") return d.at(0) * d.at(1) * d.at(2);
    if (type == "sphere") return 4 * pi / 3 * d.at(0) * d.at(0) * d.at(0);
    if (type == "ellipsoid") return 4 * pi / 3 * d.at(0) * d.at(1) * d.at(2);
    if (type == "cylinder") return pi * d.at(0) * d.at(0) * d.at(1);
    if (type == "capsule") return pi * d.at(0) * d.at(0) * (d.at(1) + 4. / 3 * d.at(0));
    if (type == "convex") return moments(vertices, faces).volume;
    if (type == "cone") return pi / 3 * d.at(0) * d.at(0) * d.at(1);
    throw std::logic_error("dae::BodyShape: unknown type " + type);
}

Mat3 BodyShape::inertia(double mass) const
{
    if (type == "convex") return moments(vertices, faces).inertia(mass);
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
    else if (type == "capsule")
        mean_square = of_capsule(axis, d.at(0), d.at(1));
    else if (type == "cone")
        mean_square = about_axis(axis, 3 * square(0) / 20, 3 * square(1) / 80);
    else
        throw std::logic_error("dae::BodyShape: unknown type " + type);
    return Mat3((mass * moments_of(mean_square)).asDiagonal());
}

}  // namespace hilda::dae
