// SPDX-License-Identifier: GPL-3.0-or-later
// The boundary type `mesh`: triangles of a file, or of a shape that the case describes.
#include "granular/case/boundary_keys.hpp"
#include "granular/mesh/mesh_file.hpp"
#include "granular/mesh/mesh_repair.hpp"
#include "granular/mesh/mesh_shapes.hpp"

#include <limits>

namespace hilda::granular {

namespace {

/// A list of at least `least` points, each of two numbers
std::vector<std::array<double, 2>> points(ObjectReader& o, std::string_view key, std::size_t least,
                                          const io::About& about)
{
    o.note(key,
           R"("type": "array", "items": {"type": "array", "items": {"type": "number"}, "minItems": 2, )"
           R"("maxItems": 2}, "minItems": )" +
               std::to_string(least),
           about);
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
int number(ObjectReader& o, std::string_view key, const io::About& about, long fallback)
{
    const long n = o.count(key, about, fallback);
    if (n > std::numeric_limits<int>::max())
        o.fail(key, std::string(key) + " must be at most 2147483647, got " + std::to_string(n));
    return static_cast<int>(n);
}

constexpr io::About about_edge = {
    "Longest edge of the cells into which each side is divided [m]; 0: one cell.", "0.01"};

TriangleMesh read_box_mesh(ObjectReader& o)
{
    const Vec3 low = o.vec3("low", {"Lower corner [m], in the frame of the mesh.", "[0, 0, 0]"});
    const Vec3 high = o.vec3("high", {"Upper corner [m], in the frame of the mesh.", "[0.1, 0.1, 0.2]"});
    const std::array<bool, 6> open = o.sides("open", about_open_sides);
    const bool inside =
        o.flag("inside",
               {"If true, the particles are inside of the box; otherwise they are outside.", "false"}, true);
    return box_mesh(low, high, open, inside, o.not_negative("edge", about_edge, 0));
}
TriangleMesh read_lathe(ObjectReader& o)
{
    const auto profile = points(
        o, "profile", 2,
        {"Points [radius, z] [m], in the frame of the mesh. The particles are on the left of the profile, "
         "seen with the radius to the right and z up: a profile that leads upwards has the particles inside.",
         "[[0.01, 0], [0.05, 0.06], [0.05, 0.2]]"});
    const io::About about = {"Number of divisions of the circle [-].", "32", R"("minimum": 3)"};
    return lathe_mesh(profile, number(o, "segments", about, 48));
}
TriangleMesh read_extrusion(ObjectReader& o)
{
    const auto outline = points(
        o, "outline", 3,
        {"Counterclockwise points [x, y] [m], in the frame of the mesh.", "[[0, 0], [0.01, 0], [0, 0.02]]"});
    return extrude_mesh(outline, o.positive("length", {"Length along z [m].", "0.05"}));
}
TriangleMesh read_plate(ObjectReader& o)
{
    const double x = o.positive("width_x", {"Width along x [m].", "0.1"}),
                 y = o.positive("width_y", {"Width along y [m].", "0.1"});
    return plate_mesh(x, y, o.not_negative("edge", about_edge, 0));
}
TriangleMesh read_sphere_mesh(ObjectReader& o)
{
    const double radius = o.positive("radius", {"Radius of the vertices [m].", "0.01"});
    const io::About about = {"Number of divisions of the 20 triangles of an icosahedron into four [-].", "2",
                             R"("maximum": 8)"};
    return sphere_mesh(radius, number(o, "divisions", about, 3));
}

struct Source {
    const char* key;
    TriangleMesh (*read)(ObjectReader& o);
    io::About about;
};
constexpr std::array<Source, 5> shapes = {
    {{"box",
      read_box_mesh,
      {"The sides of a box.", R"({"low": [0, 0, 0], "high": [0.1, 0.1, 0.2], "open": ["+z"]})"}},
     {"lathe",
      read_lathe,
      {"A surface of revolution about the z axis of the mesh.",
       R"({"profile": [[0.01, 0], [0.05, 0.06], [0.05, 0.2]], "segments": 32})"}},
     {"extrude",
      read_extrusion,
      {"A prism along the z axis of the mesh, from z = 0; the particles are outside.",
       R"({"outline": [[0, 0], [0.01, 0], [0, 0.02]], "length": 0.05})"}},
     {"plate",
      read_plate,
      {"A rectangle about the origin of the mesh with the normal +z.",
       R"({"width_x": 0.1, "width_y": 0.05})"}},
     {"sphere",
      read_sphere_mesh,
      {"A sphere about the origin of the mesh; the particles are outside.",
       R"({"radius": 0.01, "divisions": 2})"}}}};

std::string text_of(const Welded& welded)
{
    std::string text;
    if (welded.vertices > 0)
        text = std::to_string(welded.vertices) + " vertices are joined with others at distances of up to " +
               io::shortest(welded.distance) + " m, within 1e-9 of the size of the mesh";
    if (welded.triangles > 0)
        text += (text.empty() ? "" : "; ") + std::to_string(welded.triangles) +
                " triangles without an area or equal to another one are removed";
    return text;
}

/// `notice`: about repairs
TriangleMesh read_triangles(ObjectReader& o, std::string& notice)
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
    TriangleMesh mesh;
    for (const Source& s : shapes) {
        if (given != s.key && !o.records_schema()) continue;
        ObjectReader shape = o.object(s.key, s.about);
        mesh = shape.located([&] { return s.read(shape); });
        o.record(s.key, shape.finish());
    }
    if (given != "file" && !o.records_schema()) return mesh;
    const std::string file =
        o.file("file", {"OBJ or STL file. A relative path refers to the folder of the case. "
                        "The file must be below the folder of the case, unless --allow-paths is given.",
                        R"("plough.stl")"});
    const double scale = o.positive(
        "scale", {"Factor of the coordinates of the file, for example 0.001 for mm [-].", "0.001"}, 1);
    if (o.records_schema()) return mesh;
    try {
        mesh = read_mesh(file);
        for (Vec3& v : mesh.vertex) v = scale * v;
        notice = text_of(weld(mesh));
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
    b.mesh = read_triangles(o, b.notice);
    b.two_sided =
        o.flag("two_sided",
               {"If true, particles are in contact with both sides of the triangles, and their orientation "
                "has no meaning. An edge may then have more than two triangles.",
                "true"},
               false);
    const bool repairs =
        o.flag("repair",
               {"If true, triangles are turned to the orientation of their neighbours, each connected part "
                "as its first triangle, with a notice. A two_sided mesh does not need it.",
                "true"},
               false);
    const auto add_notice = [&](std::size_t number, const char* what) {
        if (number == 0) return;
        b.notice += (b.notice.empty() ? "" : "; ") + std::to_string(number) + what;
    };
    if (b.two_sided)
        add_notice(remove_copies(*b.mesh), " triangles with the vertices of another one are removed");
    if (b.two_sided || repairs)
        if (const std::size_t turned = orient(*b.mesh); !b.two_sided)
            add_notice(turned, " triangles are turned to the orientation of their neighbours");
    const Vec3 rotation =
        o.vec3("rotation",
               {"Rotation of the mesh about r at the start, a rotation vector in the global frame [rad].",
                "[0, 0, 0.5]"},
               Vec3{0, 0, 0});
    b.boundary.p = turned({1, {0, 0, 0}}, rotation);
    o.located([&] { check_mesh(*b.mesh, b.name, b.two_sided && !o.has("density")); });
    const SolidBody inside = o.has("density") ? solid_inside(o, *b.mesh) : SolidBody{};
    const std::optional<SolidBody> solid =
        read_density(o, inside,
                     {"Density of the solid inside a closed mesh, instead of mass [kg/m^3]. Mass, centre of "
                      "mass and inertia are those of the solid; inertia and centre replace the last two.",
                      "7800"});
    read_body(o, b, solid);
    Vec3 centre = solid ? solid->centre : Vec3{0, 0, 0};
    if (b.boundary.mass > 0)
        centre = o.vec3("centre",
                        {.text = "Centre of mass of a mesh with a mass [m], in the frame of the mesh. The "
                                 "default is the origin, or with density the centre of the solid. Position "
                                 "and loads in the output refer to it.",
                         .example = "[0, 0, 0.02]",
                         .computed = true},
                        centre);
    if (centre != Vec3{0, 0, 0}) set_mesh_centre(b, centre);
    return {b};
}

const bool registered_mesh_keys = io::Registry<BoundaryType>::add(
    {"mesh",
     {.description = "Triangles, with a contact for each local minimum of the distance: with a triangle, an "
                     "edge or a vertex. One of the keys file, box, lathe, extrude, plate, sphere gives them, "
                     "in a frame of their own with the origin r. The normals point to the particles.",
      .examples = {R"("name": "hopper", "lathe": {"profile": [[0.01, 0], [0.05, 0.06], [0.05, 0.2]]})"}},
     "The origin of the mesh [m], in the global frame; numbers or formulas in t. The formulas give the "
     "displacement of the centre of mass.",
     read_mesh});

}  // namespace

}  // namespace hilda::granular
