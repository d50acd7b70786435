// SPDX-License-Identifier: GPL-3.0-or-later
/// The types of surfaces of model files that are polytopes: box, capsule, polygon, convex.
#include "contact/surface_types.hpp"
#include "contact/surfaces/polytope.hpp"
#include "lie/check.hpp"

namespace hilda::contact {

namespace {

double read_rounding(dae::ObjectReader& o)
{
    return o.not_negative(
        "radius", {"Rounding radius [m]: the surface has this distance from the polytope.", "0.01"}, 0);
}

std::shared_ptr<const Surface> read_box(dae::ObjectReader& o)
{
    const std::vector<double> lengths =
        o.numbers("lengths", 3,
                  {"Lengths of the edges along x, y and z of the surface frame [m].", "[0.2, 0.1, 0.05]",
                   R"("items": {"type": "number", "exclusiveMinimum": 0})"});
    for (const double length : lengths)
        if (!(length > 0))
            o.fail("lengths", "lengths must be positive, got " + dae::described(*o.find("lengths")));
    return std::make_shared<Polytope>(Polytope::box(Vec3::Map(lengths.data()), read_rounding(o)));
}

std::shared_ptr<const Surface> read_capsule(dae::ObjectReader& o)
{
    const double length =
        o.positive("length", {"Distance between the centres of the two half spheres [m].", "0.2"});
    const double radius = o.positive("radius", {"Radius [m].", "0.05"});
    return std::make_shared<Polytope>(Polytope::capsule(length, radius));
}

const io::About about_corners = {
    "Corners of the polygon in the plane z = 0 of the surface frame [m], in any order; the polygon must be "
    "convex.",
    "[[0, 0], [0.2, 0], [0, 0.1]]",
    R"("minItems": 3, "items": {"type": "array", "minItems": 2, "maxItems": 2, "items": {"type": "number"}})"};

std::shared_ptr<const Surface> read_polygon(dae::ObjectReader& o)
{
    const Eigen::MatrixXd rows = read_rows(o, "vertices", 2, about_corners);
    std::vector<Eigen::Vector2d> corners;
    for (Eigen::Index k = 0; k < rows.rows(); ++k) corners.emplace_back(rows(k, 0), rows(k, 1));
    return std::make_shared<Polytope>(Polytope::polygon(corners, read_rounding(o)));
}

const io::About about_vertices = {"Corners of the body [m], in the surface frame and in any order.",
                                  "[[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]",
                                  R"("minItems": 4, "items": {"$ref": "#/$defs/vector"})"};

/// The hull of these points. A plate is a polygon.
std::shared_ptr<const Surface> solid(dae::ObjectReader& o, const char* key, std::vector<Vec3> corners,
                                     double radius, double tolerance)
{
    auto body = std::make_shared<Polytope>(std::move(corners), radius, "convex", tolerance);
    if (body->face.size() <= 2)
        o.fail(key, "the corners of a convex body must not lie in a plane; a plate is a polygon");
    return body;
}

/// The corners of a mesh file. Its canonical form has them, so that it is independent of the file.
std::shared_ptr<const Surface> read_convex_file(dae::ObjectReader& o)
{
    o.exclude("file", "vertices");
    const dae::MeshKeys keys = read_mesh_keys(
        o,
        "Path of an OBJ or STL file (text or binary) whose corners are those of the body, relative to "
        "the folder of the model file and below it, unless --allow-paths is given, instead of "
        "vertices. Corners are in a plane if they are closer to it than a millionth of the size.");
    o.record("vertices", {});  // its place in the canonical form
    const double radius = read_rounding(o);
    try {
        std::vector<Vec3> corners = dae::read_mesh_points(keys);
        dae::Json::List vertices;
        for (const Vec3& x : corners) vertices.push_back(dae::json(x));
        o.record("vertices", std::move(vertices));
        return solid(o, "file", std::move(corners), radius, Polytope::tolerance_of_files);
    } catch (const dae::PlacedError&) {
        throw;
    } catch (const lie::InvalidInput& e) {
        // Messages about the text of the file begin with its name.
        const std::string what = e.what();
        o.fail("file",
               what.starts_with(Polytope::where) ? keys.path + what.substr(Polytope::where.size()) : what);
    }
}

std::shared_ptr<const Surface> read_convex(dae::ObjectReader& o)
{
    if (o.find("file") != nullptr) return read_convex_file(o);
    if (o.has("scale")) o.fail("scale", "scale is for a body from a file");
    const Eigen::MatrixXd rows = read_rows(o, "vertices", 3, about_vertices);
    std::vector<Vec3> corners;
    for (Eigen::Index k = 0; k < rows.rows(); ++k) corners.emplace_back(rows.row(k).transpose());
    return solid(o, "vertices", std::move(corners), read_rounding(o), Polytope::tolerance_of_vertices);
}

const bool registered_box = io::Registry<SurfaceType>::add(
    {.name = "box",
     .schema = {.description = "Box with its centre at the origin of the surface frame.",
                .examples = {R"("lengths": [0.2, 0.1, 0.05])"}},
     .read = read_box});

const bool registered_capsule = io::Registry<SurfaceType>::add(
    {.name = "capsule",
     .schema = {.description = "Cylinder with half spheres at its ends; the axis is z of the surface frame.",
                .examples = {R"("length": 0.2, "radius": 0.05)"}},
     .read = read_capsule,
     .z = "axis"});

const bool registered_polygon = io::Registry<SurfaceType>::add(
    {.name = "polygon",
     .schema = {.description =
                    "Convex plate of thickness zero in the plane z = 0 of the surface frame, or of "
                    "twice its rounding radius.",
                .examples = {R"("vertices": [[0, 0], [0.2, 0], [0, 0.1]])"}},
     .read = read_polygon,
     .z = "normal"});

const bool registered_convex = io::Registry<SurfaceType>::add(
    {.name = "convex",
     .schema = {.description = "Convex polytope with given corners.",
                .examples = {R"("vertices": [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]])",
                             R"("file": "stone.stl", "scale": 0.001)"},
                .rest = R"("oneOf": [{"required": ["vertices"]}, {"required": ["file"]}], )"
                        R"("dependentRequired": {"scale": ["file"]})"},
     .read = read_convex,
     .format_only = true});

}  // namespace

}  // namespace hilda::contact
