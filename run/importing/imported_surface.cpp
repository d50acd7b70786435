// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/importing/imported_surface.hpp"

#include "contact/surfaces/disk.hpp"
#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/polytope.hpp"
#include "contact/surfaces/sphere.hpp"
#include "dae/object_reader.hpp"
#include "dae/shapes/convex_hull.hpp"
#include "io/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace hilda::run {

using lie::Vec3;

namespace {

/// The corners of the hull of these points
std::vector<Vec3> corners_of_hull(const std::vector<Vec3>& points)
{
    std::set<int> corners;
    if (points.empty()) return {};
    for (const std::vector<int>& face :
         dae::convex_hull(points, dae::hull_tolerance_of_files * dae::extent(points)))
        corners.insert(face.begin(), face.end());
    std::vector<Vec3> all;
    for (const int k : corners) all.push_back(points[static_cast<std::size_t>(k)]);
    return all;
}

/// Smallest z of the points of a shape [m]. Throws as surface_of().
double lowest_height(const ImportedShape& shape)
{
    io::Json keys;
    const Vec3 down = -(shape.A.transpose() * Vec3::UnitZ()).normalized();
    const std::shared_ptr<const contact::Surface> surface = surface_of(shape, keys);
    if (shape.type == ImportedShape::disk) return shape.p.z() - shape.size[0] * down.head<2>().norm();
    return (shape.p + shape.A * *surface->support(down)).z();
}

}  // namespace

std::shared_ptr<const contact::Surface> surface_of(const ImportedShape& shape, io::Json& keys)
{
    const Vec3& size = shape.size;
    switch (shape.type) {
        case ImportedShape::plane:
            keys = {{"type", "plane"}};
            return std::make_shared<contact::Plane>();
        case ImportedShape::box:
            keys = {{"type", "box"}, {"lengths", dae::json(size)}};
            return std::make_shared<contact::Polytope>(contact::Polytope::box(size));
        case ImportedShape::sphere:
            keys = {{"type", "sphere"}, {"radius", size[0]}};
            return std::make_shared<contact::Sphere>(size[0]);
        case ImportedShape::capsule:
            keys = {{"type", "capsule"}, {"length", size[1]}, {"radius", size[0]}};
            return std::make_shared<contact::Polytope>(contact::Polytope::capsule(size[1], size[0]));
        case ImportedShape::ellipsoid:
            keys = {{"type", "ellipsoid"}, {"semi_axes", dae::json(size)}};
            return std::make_shared<contact::Ellipsoid>(size);
        case ImportedShape::disk:
            keys = {{"type", "disk"}, {"radius", size[0]}};
            return std::make_shared<contact::Disk>(size[0]);
        case ImportedShape::convex:
            break;
    }
    const std::vector<Vec3> corners = corners_of_hull(shape.points);
    auto body = std::make_shared<contact::Polytope>(corners);
    if (body->face.size() <= 2) throw io::InvalidInput("its points are in a plane");
    io::Json::List vertices;
    for (const Vec3& x : corners) vertices.push_back(dae::json(x));
    keys = {{"type", "convex"}, {"vertices", std::move(vertices)}};
    return body;
}

std::string reason_of(const std::exception& error)
{
    const std::string what = error.what();
    return what.starts_with("contact::") ? what.substr(what.find(": ") + 2) : what;
}

void raise_above_floor(ImportedModel& model)
{
    // a body that is fixed to the ground, unless it is a link without geometry that carries free bodies
    for (std::size_t b = 0; b < model.bodies.size(); ++b) {
        const ImportedBody& body = model.bodies[b];
        const auto number = static_cast<int>(b);
        const auto is_free = [](const ImportedBody& of) {
            return !of.joints.empty() && of.joints.front().type == ImportedJoint::free;
        };
        const bool only_carries =
            body.joints.empty() &&
            std::none_of(model.shapes.begin(), model.shapes.end(),
                         [&](const ImportedShape& shape) { return shape.body == number; }) &&
            std::all_of(model.bodies.begin(), model.bodies.end(),
                        [&](const ImportedBody& other) { return other.parent != number || is_free(other); });
        if (body.parent < 0 && !is_free(body) && !only_carries) return;
    }
    double lowest = 0;
    for (const ImportedShape& shape : model.shapes) {
        if (shape.body < 0) continue;
        try {
            lowest = std::min(lowest, lowest_height(shape));
        } catch (const io::InvalidInput&) {
            continue;  // has a warning in imported_contacts()
        }
    }
    if (!(lowest < 0)) return;
    const Vec3 up(0, 0, -lowest);
    for (ImportedBody& body : model.bodies) {
        body.r += up;
        for (ImportedJoint& joint : body.joints) joint.anchor += up;
    }
    for (ImportedShape& shape : model.shapes)
        if (shape.body >= 0) shape.p += up;
    for (ImportedLoop& loop : model.loops) loop.point += up;
    model.warnings.push_back(
        fmt::format("height of body '{}', which is raised by {:.6g} m with all others: geometries were below "
                    "the floor z = 0",
                    model.bodies.front().name, -lowest));
}

}  // namespace hilda::run
