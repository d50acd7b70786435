// SPDX-License-Identifier: GPL-3.0-or-later
// The boundary type `mesh`: triangles of a file, or of a shape that the case describes.
#include "granular/case/boundary_keys.hpp"
#include "granular/mesh/mesh_file.hpp"
#include "granular/mesh/mesh_shapes.hpp"

#include <limits>

namespace hilda::granular {

namespace {

/// A list of at least `least` points, each of two numbers
std::vector<std::array<double, 2>> points(ObjectReader& o, std::string_view key, std::size_t least)
{
    std::vector<std::array<double, 2>> all;
    io::Json::List recorded;
    const std::string at = o.pointer(key);
    for (const io::Json& point : o.list(key, true)) {
        const std::string here = at + '/' + std::to_string(all.size());
        const auto* const list = std::get_if<io::Json::List>(&point.value);
        if (list == nullptr || list->size() != 2)
            o.fail(key, here + " must be two numbers, got " + described(point));
        all.push_back({o.number_at((*list)[0], here + "/0", key), o.number_at((*list)[1], here + "/1", key)});
        recorded.emplace_back(io::Json::List{all.back()[0], all.back()[1]});
    }
    if (all.size() < least)
        o.fail(key, std::string(key) + " must have at least " + std::to_string(least) + " points, got " +
                        std::to_string(all.size()));
    o.record(key, recorded);
    return all;
}

/// An integer of at most 31 bits
int number(ObjectReader& o, std::string_view key, long fallback)
{
    const long n = o.count(key, {}, fallback);
    if (n > std::numeric_limits<int>::max())
        o.fail(key, std::string(key) + " must be at most 2147483647, got " + std::to_string(n));
    return static_cast<int>(n);
}

TriangleMesh read_box_mesh(ObjectReader& o)
{
    const Vec3 low = o.vec3("low"), high = o.vec3("high");
    const std::array<bool, 6> open = o.sides("open");
    const bool inside = o.flag("inside", {}, true);
    return box_mesh(low, high, open, inside, o.not_negative("edge", {}, 0));
}
TriangleMesh read_lathe(ObjectReader& o)
{
    const auto profile = points(o, "profile", 2);
    return lathe_mesh(profile, number(o, "segments", 48));
}
TriangleMesh read_extrusion(ObjectReader& o)
{
    const auto outline = points(o, "outline", 3);
    return extrude_mesh(outline, o.positive("length"));
}
TriangleMesh read_plate(ObjectReader& o)
{
    const double x = o.positive("width_x"), y = o.positive("width_y");
    return plate_mesh(x, y, o.not_negative("edge", {}, 0));
}
TriangleMesh read_sphere_mesh(ObjectReader& o)
{
    const double radius = o.positive("radius");
    return sphere_mesh(radius, number(o, "divisions", 3));
}

struct Source {
    const char* key;
    TriangleMesh (*read)(ObjectReader& o);
};
constexpr std::array<Source, 5> shapes = {{{"box", read_box_mesh},
                                           {"lathe", read_lathe},
                                           {"extrude", read_extrusion},
                                           {"plate", read_plate},
                                           {"sphere", read_sphere_mesh}}};

TriangleMesh read_triangles(ObjectReader& o)
{
    std::string given;
    const auto check = [&](const char* key) {
        if (!o.has(key)) return;
        if (!given.empty()) o.fail(key, std::string(key) + " must not be given together with " + given);
        given = key;
    };
    check("file");
    for (const Source& s : shapes) check(s.key);
    if (given.empty()) o.fail("", "a mesh needs one of the keys file, box, lathe, extrude, plate, sphere");
    for (const Source& s : shapes) {
        if (given != s.key) continue;
        ObjectReader shape = o.object(s.key);
        TriangleMesh mesh = shape.located([&] { return s.read(shape); });
        o.record(s.key, shape.finish());
        return mesh;
    }
    const std::string file = o.file("file");
    const double scale = o.positive("scale", {}, 1);
    try {
        TriangleMesh mesh = read_mesh(file);
        for (Vec3& v : mesh.vertex) v = scale * v;
        return mesh;
    } catch (const io::IoError& e) {
        o.fail("file", e.what());
    } catch (const io::InvalidInput& e) {
        o.fail("file", e.what());
    }
}

/// The solid inside the mesh, of the density 1
SolidBody solid_inside(ObjectReader& o, const TriangleMesh& mesh)
{
    if (const std::size_t open = open_edges(mesh); open > 0)
        o.fail("density",
               "density needs a closed mesh, got one with " + std::to_string(open) + " open edges");
    const MassProperties p = mass_properties(mesh);
    if (!(p.volume > 0))
        o.fail("density", "density needs a mesh with normals out of a solid, got one that encloses " +
                              io::shortest(p.volume) + " m^3");
    return {p.volume, Inertia(p.J), p.centre};
}

/// Makes the centre of mass the origin of the mesh and the place of the boundary.
void set_mesh_centre(NamedBoundary& b, const Vec3& centre)
{
    for (Vec3& v : b.mesh->vertex) v = v - centre;
    displace(b, rotated(b.boundary.p, centre));
}

std::vector<NamedBoundary> read_mesh(ObjectReader& o, NamedBoundary b)
{
    b.boundary.shape = Boundary::Shape::mesh;
    b.mesh = read_triangles(o);
    b.two_sided = o.flag("two_sided", {}, false);
    b.boundary.p = turned({1, {0, 0, 0}}, o.vec3("rotation", Vec3{0, 0, 0}));
    o.located([&] { check_mesh(*b.mesh, b.name); });
    std::optional<SolidBody> solid;
    if (o.has("density")) solid = read_density(o, solid_inside(o, *b.mesh));
    read_body(o, b, solid);
    Vec3 centre = solid ? solid->centre : Vec3{0, 0, 0};
    if (b.boundary.mass > 0) centre = o.vec3("centre", centre);
    if (centre != Vec3{0, 0, 0}) set_mesh_centre(b, centre);
    return {b};
}

/// Schema of an object with these properties. `required` lists names in quotes.
std::string object_schema(const std::string& required, const std::string& properties,
                          const std::string& example)
{
    return R"("type": "object", "additionalProperties": false, "required": [)" + required +
           R"(], "properties": {)" + properties + R"(, "note": {"$ref": "#/$defs/note"}}, "examples": [)" +
           example + "]";
}

const std::string
    list_of_points =
        R"("type": "array", "items": {"type": "array", "items": {"type": "number"}, "minItems": 2,
                              "maxItems": 2}, )",
    edge =
        R"("edge": {"description": "Longest edge of the cells into which each side is divided [m]; 0: one cell.",
                            "type": "number", "minimum": 0, "default": 0, "examples": [0.01]})";

const bool registered_mesh_keys = io::Registry<BoundaryType>::add(
    {"mesh",
     {.description =
          "Triangles, with a contact for each local minimum of the distance: with a triangle, an edge "
          "or a vertex. One of the keys file, box, lathe, extrude, plate, sphere gives them, in a frame "
          "of their own with the origin r. The normals point to the particles.",
      .parts = {"boundary_keys", "body_keys"},
      .keys =
          {{"file",
            "OBJ or STL file. A relative path refers to the working directory of the program. The file must "
            "be below the folder of the case, unless --allow-paths is given.",
            R"("type": "string", "examples": ["plough.stl"])"},
           {"scale", "Factor of the coordinates of the file, for example 0.001 for mm [-].",
            R"("$ref": "#/$defs/positive", "default": 1, "examples": [0.001])"},
           {"box", "The sides of a box.",
            object_schema(
                R"("low", "high")",
                R"("low": {"description": "Lower corner [m], in the frame of the mesh.", "$ref": "#/$defs/vector",
                           "examples": [[0, 0, 0]]},
                   "high": {"description": "Upper corner [m], in the frame of the mesh.", "$ref": "#/$defs/vector",
                            "examples": [[0.1, 0.1, 0.2]]},
                   "open": {"description": "Sides that are left open; at least one side must remain.", "type": "array",
                            "items": {"enum": ["-x", "+x", "-y", "+y", "-z", "+z"]}, "uniqueItems": true,
                            "maxItems": 5, "default": [], "examples": [["+z"]]},
                   "inside": {"description": "If true, the particles are inside of the box; otherwise they are outside.",
                              "type": "boolean", "default": true, "examples": [false]}, )" +
                    edge,
                R"({"low": [0, 0, 0], "high": [0.1, 0.1, 0.2], "open": ["+z"]})")},
           {"lathe", "A surface of revolution about the z axis of the mesh.",
            object_schema(
                R"("profile")",
                R"("profile": {"description": "Points [radius, z] [m], in the frame of the mesh. The particles are on the left of the profile, seen with the radius to the right and z up: a profile that leads upwards has the particles inside.", )" +
                    list_of_points + R"("minItems": 2, "examples": [[[0.01, 0], [0.05, 0.06], [0.05, 0.2]]]},
                   "segments": {"description": "Number of divisions of the circle [-].", "type": "integer", "minimum": 3,
                                "default": 48, "examples": [32]})",
                R"({"profile": [[0.01, 0], [0.05, 0.06], [0.05, 0.2]], "segments": 32})")},
           {"extrude", "A prism along the z axis of the mesh, from z = 0; the particles are outside.",
            object_schema(
                R"("outline", "length")",
                R"("outline": {"description": "Counterclockwise points [x, y] [m], in the frame of the mesh.", )" +
                    list_of_points +
                    R"("minItems": 3, "examples": [[[0, 0], [0.01, 0], [0, 0.02]]]},
                   "length": {"description": "Length along z [m].", "$ref": "#/$defs/positive", "examples": [0.05]})",
                R"({"outline": [[0, 0], [0.01, 0], [0, 0.02]], "length": 0.05})")},
           {"plate", "A rectangle about the origin of the mesh with the normal +z.",
            object_schema(
                R"("width_x", "width_y")",
                R"("width_x": {"description": "Width along x [m].", "$ref": "#/$defs/positive", "examples": [0.1]},
                   "width_y": {"description": "Width along y [m].", "$ref": "#/$defs/positive", "examples": [0.1]}, )" +
                    edge,
                R"({"width_x": 0.1, "width_y": 0.05})")},
           {"sphere", "A sphere about the origin of the mesh; the particles are outside.",
            object_schema(
                R"("radius")",
                R"("radius": {"description": "Radius of the vertices [m].", "$ref": "#/$defs/positive", "examples": [0.01]},
                   "divisions": {"description": "Number of divisions of the 20 triangles of an icosahedron into four [-].",
                                 "type": "integer", "minimum": 0, "maximum": 8, "default": 3, "examples": [2]})",
                R"({"radius": 0.01, "divisions": 2})")},
           {"two_sided", "If true, particles are in contact with both sides of the triangles.",
            R"("type": "boolean", "default": false, "examples": [true])"},
           {"rotation",
            "Rotation of the mesh about r at the start, a rotation vector in the global frame [rad].",
            R"("$ref": "#/$defs/vector", "default": [0, 0, 0], "examples": [[0, 0, 0.5]])"},
           {"density",
            "Density of the solid inside a closed mesh, instead of mass [kg/m^3]. Mass, centre of mass and "
            "inertia are those of the solid; inertia and centre replace the last two.",
            R"("$ref": "#/$defs/positive", "examples": [7800])"},
           {"centre",
            "Centre of mass of a mesh with a mass [m], in the frame of the mesh. The default is the origin, "
            "or "
            "with density the centre of the solid. Position and loads in the output refer to it.",
            R"("$ref": "#/$defs/vector", "examples": [[0, 0, 0.02]])"},
           {"r",
            "The origin of the mesh [m], in the global frame; numbers or formulas in t. The formulas give "
            "the "
            "displacement of the centre of mass.",
            R"("$ref": "#/$defs/formulas", "default": [0, 0, 0], "examples": [[0, 0, -0.01]])"}},
      .example = R"json("name": "hopper", "lathe": {"profile": [[0.01, 0], [0.05, 0.06], [0.05, 0.2]]})json"},
     read_mesh});

}  // namespace

}  // namespace hilda::granular
