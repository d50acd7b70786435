// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/boundary_keys.hpp"

#include "granular/reading/inertia_keys.hpp"

#include <array>
#include <cmath>

namespace hilda::granular {

namespace {

/// Reads a vector of numbers, or of formulas. The number is then the value at t = 0, or zero if it is not
/// finite there: velocities and forces are evaluated within steps. Positions need it, which the caller
/// checks.
void read_vector(ObjectReader& o, const std::string& key, const io::About& about, Vec3& number,
                 std::optional<VectorFormula>& formula)
{
    o.note(key, R"("$ref": "#/$defs/formulas", "default": [0, 0, 0])", about);
    if (!o.has_formula(key)) {
        number = o.vec3(key, {}, Vec3{0, 0, 0});
        return;
    }
    formula = o.formulas(key);
    const Vec3 v = (*formula)(0);
    number = finite(v) ? v : Vec3{0, 0, 0};
}

NamedBoundary read_motion(ObjectReader& o, const std::string& name, const std::string& place)
{
    NamedBoundary all{.name = name, .boundary = {}};
    all.motion.name = name;
    read_vector(o, "r", {place, "[0, 0, -0.01]"}, all.boundary.r, all.motion.r);
    if (all.motion.r && !finite((*all.motion.r)(0)))
        o.fail("r", "r must be finite at t = 0, got " + described(*o.find("r")));
    read_vector(o, "v",
                {"Velocity of r [m/s], in the global frame; numbers or formulas in t, evaluated at the "
                 "middle of a step. It must be 0 if r contains a formula.",
                 R"json([0, 0, "0.1*cos(t)"])json"},
                all.boundary.v, all.motion.v);
    if (all.motion.r && (all.motion.v || !(all.boundary.v == Vec3{0, 0, 0})))
        o.fail("v", "v must be 0 or not be given if r is a formula, got " + io::written(*o.find("v")));
    return all;
}

/// The sides of a box as planes, without those that `open` lists
// NOLINTNEXTLINE(performance-unnecessary-value-param): the type of BoundaryType::read
std::vector<NamedBoundary> read_box(ObjectReader& o, NamedBoundary box)
{
    const Vec3 low = o.vec3("low", {"Lower corner [m], in the global frame.", "[0, 0, 0]"});
    const Vec3 high = o.vec3(
        "high", {"Upper corner [m], in the global frame. It must exceed the lower corner in each component.",
                 "[0.03, 0.02, 0.06]"});
    const double widths[] = {high.x - low.x, high.y - low.y, high.z - low.z};
    for (int k = 0; k < 3; ++k)
        if (!(widths[k] > 0))
            o.fail("high", std::string("high must be above low along ") + "xyz"[k] + ", got " +
                               described(*o.find("high")));
    constexpr std::array<Vec3, 6> normals = {
        {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
    const std::array<bool, 6> open = o.sides("open", about_open_sides);
    std::vector<NamedBoundary> all;
    for (std::size_t side = 0; side < open.size(); ++side) {
        if (open[side]) continue;
        NamedBoundary plane = box;
        plane.name = plane.motion.name = box.name + ObjectReader::side_names[side];
        plane.boundary.axis = normals[side];
        const Vec3 corner = side % 2 == 0 ? low : high;
        displace(plane, corner);
        all.push_back(std::move(plane));
    }
    if (all.empty()) o.fail("open", "open must not contain all six sides");
    return all;
}

std::vector<NamedBoundary> read_plane(ObjectReader& o, NamedBoundary plane)
{
    read_body(o, plane);
    plane.boundary.axis =
        o.direction("normal", {"Normal towards the particles [-], in the global frame.", "[0, 0, 1]"});
    return {plane};
}

std::vector<NamedBoundary> read_sphere(ObjectReader& o, NamedBoundary sphere)
{
    Boundary& b = sphere.boundary;
    b.shape = Boundary::Shape::sphere;
    b.inside = o.flag("inside", about_inside, false);
    b.radius = o.positive("radius", about_radius);
    if (b.inside != 0 && o.has("density"))
        o.fail("density", "density needs particles outside of the sphere, got inside true");
    read_body(o, sphere,
              read_density(o, solid_ball(1, b.radius),
                           {"Density of the solid ball, instead of mass [kg/m^3]. Mass and inertia are those "
                            "of the ball; inertia replaces the latter.",
                            "7800"}));
    return {sphere};
}

/// Whether there is the key length. Refuses the keys of finite surfaces for an infinite one.
bool is_finite(ObjectReader& o, const char* type)
{
    o.note("length", "positive", {"Length along the axis [m]; without it the surface is infinite.", "0.1"});
    if (o.has("length")) return true;
    for (const char* key : {"open", "two_sided", "density", "centre"})
        if (o.has(key)) o.fail(key, std::string(key) + " is only for a " + type + " with a length, got none");
    return false;
}

std::vector<NamedBoundary> read_cylinder(ObjectReader& o, NamedBoundary cylinder)
{
    Boundary& b = cylinder.boundary;
    b.axis = o.direction("axis", {"Direction of the axis [-], in the global frame.", "[0, 0, 1]"});
    b.radius = o.positive("radius", about_radius);
    if (is_finite(o, "cylinder")) return read_frustum(o, cylinder, b.radius, b.radius);
    b.shape = Boundary::Shape::cylinder;
    b.inside = o.flag("inside", about_inside, false);
    read_body(o, cylinder);
    return {cylinder};
}

std::vector<NamedBoundary> read_cone(ObjectReader& o, NamedBoundary cone)
{
    Boundary& b = cone.boundary;
    b.axis = o.direction(
        "axis", {"Direction from the apex in which the cone opens [-], in the global frame.", "[0, 0, 1]"});
    const double half =
        o.number("half_angle", {"Angle between axis and surface [rad].", "0.5",
                                R"("exclusiveMinimum": 0, "exclusiveMaximum": 1.5707963267948966)"});
    if (!(half > 0 && half < M_PI / 2))
        o.fail("half_angle", "half_angle must be between 0 and pi/2, got " + io::shortest(half));
    if (is_finite(o, "cone")) return read_frustum(o, cone, 0, std::tan(half) * o.positive("length"));
    b.shape = Boundary::Shape::cone;
    b.cosine = std::cos(half), b.sine = std::sin(half);
    b.inside = o.flag("inside", about_inside, false);
    read_body(o, cone);
    return {cone};
}

/// A body without a surface of its own
std::vector<NamedBoundary> read_body_of_parts(ObjectReader& o, NamedBoundary body)
{
    body.boundary.shape = Boundary::Shape::none;
    body.sums_parts = o.flag("from_parts",
                             {"If true, mass, centre of mass and inertia are the sums over the parts, which "
                              "all have a density. r, mass and inertia must not be given.",
                              "true"},
                             false);
    if (body.sums_parts)
        for (const char* key : {"r", "mass", "inertia"})
            if (o.has(key))
                o.fail(key, std::string(key) + " must not be given together with from_parts, got " +
                                described(*o.find(key)));
    if (o.has("part_of"))
        o.fail("part_of", "part_of must not be given for the type body, which has parts itself, got " +
                              described(*o.find("part_of")));
    // The sums replace these values, see CaseReader.
    read_body(o, body, body.sums_parts ? std::optional(SolidBody{1, Inertia(1)}) : std::nullopt);
    return {body};
}

const bool registered_boundary_keys =
    io::Registry<BoundaryType>::add(
        {"plane",
         {.description = "Plane. The particles are on the side to which the normal points.",
          .examples = {R"("name": "lid", "normal": [0, 0, -1], "r": [0, 0, 0.03], "mass": 0.01,
                          "free": [false, false, true])"}},
         place_of("A point of the plane"),
         read_plane}) &&
    io::Registry<BoundaryType>::add(
        {"box",
         {.description = "Six planes around the particles, named NAME-x, NAME+x, NAME-y, NAME+y, NAME-z, "
                         "NAME+z. Sides can be left open.",
          .examples = {R"json("name": "box", "low": [0, 0, 0], "high": [0.03, 0.02, 0.06], "open": ["+z"],
                              "r": ["1e-3*sin(2*pi*20*t)", 0, 0])json"}},
         "Displacement of the whole box from low and high [m], in the global frame; numbers or formulas in "
         "t.",
         read_box}) &&
    io::Registry<BoundaryType>::add(
        {"cylinder",
         {.description = "Circular cylinder, infinite or with a length.",
          .examples =
              {R"("name": "drum", "axis": [0, 1, 0], "radius": 0.05, "inside": true, "omega": [0, 3, 0])",
               R"("name": "roller", "axis": [0, 1, 0], "radius": 0.01, "length": 0.02, "density": 7800)"}},
         place_of("A point of the axis, with length the centre of the first end"),
         read_cylinder}) &&
    io::Registry<BoundaryType>::add(
        {"cone",
         {.description = "Circular cone that opens along its axis, infinite or with a length.",
          .examples = {R"("name": "hopper", "axis": [0, 0, 1], "half_angle": 0.5, "inside": true)",
                       R"("name": "tip", "axis": [0, 0, 1], "half_angle": 0.5, "length": 0.02)"}},
         place_of("The apex"),
         read_cone}) &&
    io::Registry<BoundaryType>::add(
        {"sphere",
         {.description = "Sphere.", .examples = {R"("name": "obstacle", "radius": 0.01, "r": [0, 0, 0.02])"}},
         place_of("The centre"),
         read_sphere}) &&
    io::Registry<BoundaryType>::add(
        {"body",
         {.description = "Rigid body without a surface of its own. Other boundaries are its surfaces: their "
                         "part_of has its name.",
          .examples = {R"("name": "dumb-bell", "mass": 0.02, "inertia": 1e-6)"}},
         place_of("The centre of mass, or the point to which velocity and loads refer"),
         read_body_of_parts});

}  // namespace

std::string place_of(const std::string& point)
{
    return point +
           " [m], in the global frame; numbers or formulas in t. With formulas, the boundary is at r(t) "
           "after every step.";
}

std::optional<SolidBody> read_density(ObjectReader& o, const SolidBody& solid, const io::About& about)
{
    o.note("density", "positive", about);
    if (!o.has("density")) return {};
    if (o.has("mass")) o.fail("density", "density must not be given together with mass");
    const double density = o.positive("density");
    const Inertia& J = solid.inertia;
    return SolidBody{density * solid.mass,
                     Inertia(std::array{density * J.xx, density * J.yy, density * J.zz, density * J.xy,
                                        density * J.yz, density * J.zx}),
                     solid.centre};
}

void displace(NamedBoundary& b, const Vec3& d)
{
    b.boundary.r += d;
    if (!b.motion.r) return;
    const double by[] = {d.x, d.y, d.z};
    for (std::size_t k = 0; k < 3; ++k)
        b.motion.r->of[k] = [f = b.motion.r->of[k], c = by[k]](double t) { return c + f(t); };
}

void read_body(ObjectReader& o, NamedBoundary& body, const std::optional<SolidBody>& solid)
{
    if (o.has("part_of")) {
        body.solid = solid;
        return;
    }
    Boundary& b = body.boundary;
    read_vector(o, "omega",
                {"Angular velocity about r [rad/s], in the global frame; numbers or formulas in t, evaluated "
                 "at the middle of a step. Of a boundary with a mass, that at the start about the free axes. "
                 "Formulas are not allowed if the boundary rotates freely about all three axes.",
                 "[0, 0, 3.14]"},
                b.omega, body.motion.omega);
    if (solid)
        b.mass = solid->mass, b.inertia = solid->inertia;
    else if (o.given("mass"))
        b.mass = o.positive(
            "mass",
            {"Mass [kg]. A boundary with a mass is a rigid body that moves under the contact loads, its "
             "weight, F and T. Without this key the motion of the boundary is prescribed by r, v and omega.",
             "0.01"});
    else {
        for (const char* key : {"inertia", "free", "F", "T"})
            if (o.has(key)) o.fail(key, std::string(key) + " is only for a boundary with a mass, got none");
        return;
    }
    o.note("inertia", R"("$ref": "#/$defs/inertia", "default": 0)",
           {"Inertia about the centre of mass [kg m^2]: one moment for every axis, the three principal "
            "moments if the axes of the body frame are principal axes, or the symmetric matrix by rows. The "
            "body frame is the frame of a mesh; otherwise it is the global frame at the start. The principal "
            "moments must satisfy the triangle inequality. 0: the boundary does not rotate under its loads. "
            "Only with mass or density.",
            "1e-5, [2e-5, 2e-5, 1e-5]"});
    if (o.has("inertia")) b.inertia = read_inertia(o);
    b.free = o.six_flags(
        "free",
        {"Directions x, y and z of the global frame in which a boundary with a mass moves freely, and the "
         "axes x, y and z about which it rotates freely. In the others its motion is prescribed by r, v and "
         "omega. Three values leave all rotations free. Only with mass or density.",
         "[false, false, true], [false, false, true, false, true, false]"},
        true);
    read_vector(o, "F",
                {"External force on a boundary with a mass [N], at its centre of mass, in the global frame; "
                 "numbers or formulas in t. Only with mass or density.",
                 R"json([0, 0, "-min(t,1)"])json"},
                b.F, body.motion.F);
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
    read_vector(o, "T",
                {"External torque on a boundary with a mass [N m], about its centre of mass, in the global "
                 "frame; numbers or formulas in t. Only with mass or density.",
                 "[0, 0.1, 0]"},
                b.T, body.motion.T);
}

std::vector<NamedBoundary> read_boundary(ObjectReader& o, const BoundaryType& type, const std::string& name)
{
    std::vector<NamedBoundary> all = type.read(o, read_motion(o, name, type.place));
    if (all.front().boundary.shape != Boundary::Shape::none)
        o.note("part_of", "text",
               {"Name of another boundary, the body, of which this one is a part. It moves rigidly with the "
                "body, from its place at the start on, and its loads act on the body and are in the columns "
                "of both. v, omega, mass and the other keys of motion are those of the body.",
                R"("wheel")"});
    if (!o.has("part_of")) return all;
    const std::string body = o.text("part_of");
    for (const char* key : {"v", "omega", "mass", "inertia", "free", "F", "T"})
        if (o.has(key))
            o.fail(key, std::string(key) + " must not be given for a part, which moves with " +
                            io::described(body) + ", got " + described(*o.find(key)));
    if (o.has_formula("r"))
        o.fail("r", "r must be three numbers for a part, which moves with " + io::described(body) + ", got " +
                        described(*o.find("r")));
    for (NamedBoundary& b : all) b.part_of = body;
    return all;
}

}  // namespace hilda::granular
