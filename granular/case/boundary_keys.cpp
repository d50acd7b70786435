// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/boundary_keys.hpp"

#include "granular/core/rigid_body.hpp"

#include <array>
#include <cmath>

namespace hilda::granular {

namespace {

/// Reads a vector of numbers, or of formulas. The number is then the value at t = 0, or zero if it is not
/// finite there: velocities and forces are evaluated within steps. Positions need it, which the caller
/// checks.
void read_vector(ObjectReader& o, const std::string& key, Vec3& number, std::optional<VectorFormula>& formula)
{
    if (!o.has_formula(key)) {
        number = o.vec3(key, Vec3{0, 0, 0});
        return;
    }
    formula = o.formulas(key);
    const Vec3 v = (*formula)(0);
    number = finite(v) ? v : Vec3{0, 0, 0};
}

NamedBoundary read_motion(ObjectReader& o, const std::string& name)
{
    NamedBoundary all{.name = name, .boundary = {}};
    all.motion.name = name;
    read_vector(o, "r", all.boundary.r, all.motion.r);
    if (all.motion.r && !finite((*all.motion.r)(0)))
        o.fail("r", "r must be finite at t = 0, got " + described(*o.find("r")));
    if (all.motion.r && o.has("v")) o.fail("v", "v must not be given if r is a formula");
    read_vector(o, "v", all.boundary.v, all.motion.v);
    return all;
}

/// The sides of a box as planes, without those that `open` lists
std::vector<NamedBoundary> read_box(ObjectReader& o, NamedBoundary box)
{
    const Vec3 low = o.vec3("low"), high = o.vec3("high");
    const double widths[] = {high.x - low.x, high.y - low.y, high.z - low.z};
    for (int k = 0; k < 3; ++k)
        if (!(widths[k] > 0))
            o.fail("high", std::string("high must be above low along ") + "xyz"[k] + ", got " +
                               described(*o.find("high")));
    constexpr std::array<Vec3, 6> normals = {
        {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
    const std::array<bool, 6> open = o.sides("open");
    std::vector<NamedBoundary> all;
    for (std::size_t side = 0; side < open.size(); ++side) {
        if (open[side]) continue;
        NamedBoundary plane = box;
        plane.name = plane.motion.name = box.name + ObjectReader::side_names[side];
        plane.boundary.axis = normals[side];
        const Vec3 corner = side % 2 == 0 ? low : high;
        plane.boundary.r += corner;
        if (box.motion.r) {
            const double from[] = {corner.x, corner.y, corner.z};
            for (int k = 0; k < 3; ++k)
                plane.motion.r->of[k] = [f = box.motion.r->of[k], c = from[k]](double t) { return c + f(t); };
        }
        all.push_back(std::move(plane));
    }
    if (all.empty()) o.fail("open", "open must not contain all six sides");
    return all;
}

std::vector<NamedBoundary> read_plane(ObjectReader& o, NamedBoundary plane)
{
    read_body(o, plane);
    plane.boundary.axis = o.direction("normal");
    return {plane};
}

/// A surface with an inside. The further keys: radius; axis, radius; or axis, half_angle
template <Boundary::Shape shape>
std::vector<NamedBoundary> read_round(ObjectReader& o, NamedBoundary round)
{
    read_body(o, round);
    Boundary& b = round.boundary;
    b.inside = o.flag("inside", false);
    b.shape = shape;
    if (shape != Boundary::Shape::sphere) b.axis = o.direction("axis");
    if (shape != Boundary::Shape::cone) {
        b.radius = o.positive("radius");
        return {round};
    }
    const double half = o.number("half_angle");
    if (!(half > 0 && half < M_PI / 2))
        o.fail("half_angle", "half_angle must be between 0 and pi/2, got " + io::shortest(half));
    b.cosine = std::cos(half), b.sine = std::sin(half);
    return {round};
}

const std::vector<std::string> common = {"boundary_keys"}, of_body = {"boundary_keys", "body_keys"};

/// The key r; `point` is what it is the position of
io::KeySchema place(const std::string& point)
{
    return {"r",
            point +
                " [m], in the global frame; numbers or formulas in t. With formulas, the boundary is at r(t) "
                "after "
                "every step.",
            R"("$ref": "#/$defs/formulas", "default": [0, 0, 0], "examples": [[0, 0, -0.01]])"};
}

io::KeySchema axis(const std::string& text)
{
    return {"axis", text, R"("$ref": "#/$defs/direction", "examples": [[0, 0, 1]])", true};
}

const io::KeySchema radius = {"radius", "Radius [m].", R"("$ref": "#/$defs/positive", "examples": [0.05])",
                              true},
                    inside = {"inside",
                              "If true, the particles are inside of the surface; otherwise they are outside.",
                              R"("type": "boolean", "default": false, "examples": [true])"};

const bool registered =
    io::Registry<BoundaryType>::add(
        {"plane",
         {.description = "Plane. The particles are on the side to which the normal points.",
          .parts = of_body,
          .keys = {{"normal", "Normal towards the particles [-], in the global frame.",
                    R"("$ref": "#/$defs/direction", "examples": [[0, 0, 1]])", true},
                   place("A point of the plane")},
          .example = R"("name": "lid", "normal": [0, 0, -1], "r": [0, 0, 0.03], "mass": 0.01,
                        "free": [false, false, true])"},
         read_plane}) &&
    io::Registry<BoundaryType>::add(
        {"box",
         {.description =
              "Six planes around the particles, named NAME-x, NAME+x, NAME-y, NAME+y, NAME-z, NAME+z. "
              "Sides can be left open.",
          .parts = common,
          .keys =
              {{"low", "Lower corner [m], in the global frame.",
                R"("$ref": "#/$defs/vector", "examples": [[0, 0, 0]])", true},
               {"high",
                "Upper corner [m], in the global frame. It must exceed the lower corner in each component.",
                R"("$ref": "#/$defs/vector", "examples": [[0.03, 0.02, 0.06]])", true},
               {"open", "Sides that are left open; at least one side must remain.",
                R"("type": "array", "items": {"enum": ["-x", "+x", "-y", "+y", "-z", "+z"]}, "uniqueItems": true,
                       "maxItems": 5, "default": [], "examples": [["+z"]])"},
               {"r",
                "Displacement of the whole box from low and high [m], in the global frame; numbers or "
                "formulas in "
                "t.",
                R"json("$ref": "#/$defs/formulas", "default": [0, 0, 0],
                         "examples": [["1e-3*sin(2*pi*20*t)", 0, 0]])json"}},
          .example = R"json("name": "box", "low": [0, 0, 0], "high": [0.03, 0.02, 0.06], "open": ["+z"],
                            "r": ["1e-3*sin(2*pi*20*t)", 0, 0])json"},
         read_box}) &&
    io::Registry<BoundaryType>::add(
        {"cylinder",
         {.description = "Infinite circular cylinder.",
          .parts = of_body,
          .keys = {axis("Direction of the axis [-], in the global frame."), radius, inside,
                   place("A point of the axis")},
          .example =
              R"("name": "drum", "axis": [0, 1, 0], "radius": 0.05, "inside": true, "omega": [0, 3, 0])"},
         read_round<Boundary::Shape::cylinder>}) &&
    io::Registry<BoundaryType>::add(
        {"cone",
         {.description = "Infinite circular cone that opens along its axis.",
          .parts = of_body,
          .keys = {axis("Direction from the apex in which the cone opens [-], in the global frame."),
                   {"half_angle", "Angle between axis and surface [rad].",
                    R"("type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 1.5707963267948966,
                       "examples": [0.5])",
                    true},
                   inside,
                   place("The apex")},
          .example = R"("name": "hopper", "axis": [0, 0, 1], "half_angle": 0.5, "inside": true)"},
         read_round<Boundary::Shape::cone>}) &&
    io::Registry<BoundaryType>::add({"sphere",
                                     {.description = "Sphere.",
                                      .parts = of_body,
                                      .keys = {radius, inside, place("The centre")},
                                      .example = R"("name": "obstacle", "radius": 0.01, "r": [0, 0, 0.02])"},
                                     read_round<Boundary::Shape::sphere>});

/// A matrix of three rows, row by row
std::array<double, 9> matrix(ObjectReader& o, const std::string& key)
{
    std::array<double, 9> M{};
    const io::Json::List& rows = o.list(key, true);
    const auto fail = [&] {
        o.fail(key, key + " must be one number, three numbers or three rows of three numbers, got " +
                        io::described(*o.find(key)));
    };
    if (rows.size() != 3) fail();
    for (std::size_t i = 0; i < 3; ++i) {
        if (rows[i].list() == nullptr || rows[i].size() != 3) fail();
        const std::string at = o.pointer(key) + '/' + std::to_string(i) + '/';
        for (std::size_t j = 0; j < 3; ++j)
            M[3 * i + j] = o.number_at((*rows[i].list())[j], at + std::to_string(j), key);
    }
    o.record(key, *o.find(key));
    return M;
}

/// One number, three principal moments, or a symmetric matrix of three rows
Inertia read_inertia(ObjectReader& o)
{
    const io::Json* v = o.find("inertia");
    if (v->list() == nullptr) return o.not_negative("inertia");
    Inertia J;
    if (v->size() == 0 || v->list()->front().list() == nullptr) {
        const Vec3 principal = o.vec3("inertia");
        J.xx = principal.x, J.yy = principal.y, J.zz = principal.z;
    } else {
        const auto M = matrix(o, "inertia");
        for (const auto& [i, j] : {std::pair{0u, 1u}, {1u, 2u}, {2u, 0u}})
            if (M[3 * i + j] != M[3 * j + i])
                o.fail("inertia", "inertia must be symmetric, got " + io::shortest(M[3 * i + j]) + " and " +
                                      io::shortest(M[3 * j + i]));
        J = Inertia(std::array{M[0], M[4], M[8], M[1], M[5], M[6]});
    }
    if (!is_inertia(J))
        o.fail(
            "inertia",
            "the principal moments of inertia must be positive, and none larger than the sum of the others, "
            "got " +
                described(*v));
    return J;
}

}  // namespace

void read_body(ObjectReader& o, NamedBoundary& body, const std::optional<SolidBody>& solid)
{
    Boundary& b = body.boundary;
    read_vector(o, "omega", b.omega, body.motion.omega);
    if (solid)
        b.mass = solid->mass, b.inertia = solid->inertia;
    else if (o.has("mass"))
        b.mass = o.positive("mass");
    else {
        for (const char* key : {"inertia", "free", "F", "T"})
            if (o.has(key)) o.fail(key, std::string(key) + " is only for a boundary with a mass, got none");
        return;
    }
    if (o.has("inertia")) b.inertia = read_inertia(o);
    b.free = o.six_flags("free", true);
    if (b.inertia.is_zero()) {
        if (o.has("free") && o.find("free")->size() == 6 && (b.free[3] || b.free[4] || b.free[5]))
            o.fail("free", "free rotations need inertia, got none or 0");
        if (o.has("T")) o.fail("T", "T needs inertia, got none or 0");
    }
    const bool turns = b.free[3] && b.free[4] && b.free[5] && !b.inertia.is_zero();
    if (turns && body.motion.omega)
        o.fail("omega", "omega must be three numbers if the boundary rotates freely about all axes");
    if (body.motion.v && !finite((*body.motion.v)(0)))
        o.fail("v", "v must be finite at t = 0 if the boundary has a mass");
    read_vector(o, "F", b.F, body.motion.F);
    read_vector(o, "T", b.T, body.motion.T);
}

std::vector<NamedBoundary> read_boundary(ObjectReader& o, const std::string& name)
{
    const std::string type = o.one_of("type", io::Registry<BoundaryType>::names());
    return io::Registry<BoundaryType>::find(type)->read(o, read_motion(o, name));
}

}  // namespace hilda::granular
