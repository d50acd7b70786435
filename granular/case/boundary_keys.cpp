// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/boundary_keys.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace hilda::granular {

namespace {

bool finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// Value of a formula at t = 0; zero if it is not finite there. Velocities and forces are evaluated within
/// steps, so they need no value at t = 0. Positions do, which the caller checks.
Vec3 value_at_start(const VectorFormula& f)
{
    const Vec3 v = f(0);
    return finite(v) ? v : Vec3{0, 0, 0};
}

/// Reads r and v. Vectors of numbers become initial values, vectors with a formula also become prescribed
/// motions.
NamedBoundary read_motion(ObjectReader& o, const std::string& name)
{
    NamedBoundary all{.name = name, .boundary = {}};
    all.motion.name = name;
    const auto read = [&](const std::string& key, Vec3& number, std::optional<VectorFormula>& formula) {
        if (!o.has_formula(key)) {
            number = o.vec3(key, Vec3{0, 0, 0});
            return;
        }
        formula = o.formulas(key);
        number = value_at_start(*formula);
    };
    read("r", all.boundary.r, all.motion.r);
    if (all.motion.r && !finite((*all.motion.r)(0)))
        o.fail("r", "r must be finite at t = 0, got " + described(*o.find("r")));
    if (all.motion.r && o.has("v")) o.fail("v", "v must not be given if r is a formula");
    read("v", all.boundary.v, all.motion.v);
    return all;
}

/// Reads the keys of a boundary that may be a tool: omega, mass, inertia, free and F.
void read_tool(ObjectReader& o, NamedBoundary& tool)
{
    Boundary& b = tool.boundary;
    if (o.has_formula("omega")) {
        tool.motion.omega = o.formulas("omega");
        b.omega = value_at_start(*tool.motion.omega);
    } else {
        b.omega = o.vec3("omega", Vec3{0, 0, 0});
    }
    if (!o.has("mass")) return;
    b.mass = o.positive("mass");
    b.inertia = o.not_negative("inertia", 0);
    if (b.inertia > 0 && tool.motion.omega)
        o.fail("omega", "omega must be three numbers if inertia is positive");
    b.free = o.flags("free", {true, true, true});
    if (tool.motion.v && !finite((*tool.motion.v)(0)))
        o.fail("v", "v must be finite at t = 0 if the boundary has a mass");
    if (o.has_formula("F")) {
        tool.motion.F = o.formulas("F");
        b.F = value_at_start(*tool.motion.F);
    } else {
        b.F = o.vec3("F", Vec3{0, 0, 0});
    }
}

/// The sides of a box as planes, without those that `open` lists
std::vector<NamedBoundary> read_box(ObjectReader& o, const NamedBoundary& box)
{
    const Vec3 low = o.vec3("low"), high = o.vec3("high");
    const double widths[] = {high.x - low.x, high.y - low.y, high.z - low.z};
    for (int k = 0; k < 3; ++k)
        if (!(widths[k] > 0))
            o.fail("high", std::string("high must be above low along ") + "xyz"[k] + ", got " +
                               described(*o.find("high")));
    const std::pair<std::string, Vec3> sides[] = {{"-x", {1, 0, 0}},  {"+x", {-1, 0, 0}}, {"-y", {0, 1, 0}},
                                                  {"+y", {0, -1, 0}}, {"-z", {0, 0, 1}},  {"+z", {0, 0, -1}}};
    std::set<std::string> open;
    const io::Json::List& listed = o.list("open", false);
    for (std::size_t k = 0; k < listed.size(); ++k) {
        const auto is = [&](const auto& side) {
            return listed[k].string() != nullptr && side.first == *listed[k].string();
        };
        if (std::none_of(std::begin(sides), std::end(sides), is) || !open.insert(*listed[k].string()).second)
            o.fail("open", k,
                   "open must list some of -x, +x, -y, +y, -z, +z, each once, got " + described(listed[k]));
    }
    std::vector<NamedBoundary> all;
    for (const auto& [side, normal] : sides) {
        if (open.contains(side)) continue;
        NamedBoundary plane = box;
        plane.name = plane.motion.name = box.name + side;
        plane.boundary.axis = normal;
        const Vec3 corner = side[0] == '-' ? low : high;
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

}  // namespace

std::vector<NamedBoundary> read_boundary(ObjectReader& o, const std::string& name)
{
    const std::string type = o.one_of("type", {"plane", "box", "cylinder", "cone", "sphere"});
    NamedBoundary one = read_motion(o, name);
    if (type == "box") return read_box(o, one);
    read_tool(o, one);
    Boundary& b = one.boundary;
    if (type == "plane") {
        b.axis = o.direction("normal");
        return {one};
    }
    b.inside = o.flag("inside", false);
    if (type == "sphere") {
        b.shape = Boundary::Shape::sphere;
        b.radius = o.positive("radius");
    } else if (type == "cylinder") {
        b.shape = Boundary::Shape::cylinder;
        b.axis = o.direction("axis");
        b.radius = o.positive("radius");
    } else {
        b.shape = Boundary::Shape::cone;
        b.axis = o.direction("axis");
        const double half = o.number("half_angle");
        if (!(half > 0 && half < M_PI / 2))
            o.fail("half_angle", "half_angle must be between 0 and pi/2, got " + io::shortest(half));
        b.cosine = std::cos(half), b.sine = std::sin(half);
    }
    return {one};
}

}  // namespace hilda::granular
