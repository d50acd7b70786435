// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/boundary_keys.hpp"

#include "io/error.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

namespace {

Vec3 unit_vector(Keys& keys, const std::string& key)
{
    const Vec3 v = keys.vector(key);
    if (!(v.norm() > 0)) keys.refuse(key, "must not be zero", keys.raw(key));
    return (1 / v.norm()) * v;
}

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
NamedBoundary read_motion(Keys& keys, const std::string& name)
{
    NamedBoundary all{.name = name, .boundary = {}};
    all.motion.name = name;
    const auto read = [&](const std::string& key, Vec3& number, std::optional<VectorFormula>& formula) {
        if (!keys.has_formula(key)) {
            number = keys.vector(key, {0, 0, 0});
            return;
        }
        formula = keys.formulas(key);
        number = value_at_start(*formula);
    };
    read("r", all.boundary.r, all.motion.r);
    if (all.motion.r && !finite((*all.motion.r)(0)))
        keys.refuse("r", "must be finite at t = 0", keys.raw("r"));
    if (all.motion.r && keys.has("v")) keys.refuse("v", "must not be given if r is a formula", keys.raw("v"));
    read("v", all.boundary.v, all.motion.v);
    return all;
}

/// Reads the keys of a boundary that may be a tool: omega, mass, inertia, free and F.
void read_tool(Keys& keys, NamedBoundary& tool)
{
    Boundary& b = tool.boundary;
    if (keys.has_formula("omega")) {
        tool.motion.omega = keys.formulas("omega");
        b.omega = value_at_start(*tool.motion.omega);
    } else {
        b.omega = keys.vector("omega", {0, 0, 0});
    }
    if (!keys.has("mass")) return;
    b.mass = keys.positive("mass");
    b.inertia = keys.not_negative("inertia");
    if (b.inertia > 0 && tool.motion.omega)
        keys.refuse("omega", "must be three numbers if inertia is positive", keys.raw("omega"));
    b.free = keys.flags("free", {true, true, true});
    if (tool.motion.v && !finite((*tool.motion.v)(0)))
        keys.refuse("v", "must be finite at t = 0 if the boundary has a mass", keys.raw("v"));
    if (keys.has_formula("F")) {
        tool.motion.F = keys.formulas("F");
        b.F = value_at_start(*tool.motion.F);
    } else {
        b.F = keys.vector("F", {0, 0, 0});
    }
}

/// The sides of a box as planes, without those that `open` lists
std::vector<NamedBoundary> read_box(Keys& keys, const NamedBoundary& box)
{
    const Vec3 low = keys.vector("low"), high = keys.vector("high");
    const double widths[] = {high.x - low.x, high.y - low.y, high.z - low.z};
    for (int k = 0; k < 3; ++k)
        if (!(widths[k] > 0))
            keys.refuse("high", std::string("must be above low along ") + "xyz"[k], keys.raw("high"));
    const std::pair<std::string, Vec3> sides[] = {{"-x", {1, 0, 0}},  {"+x", {-1, 0, 0}}, {"-y", {0, 1, 0}},
                                                  {"+y", {0, -1, 0}}, {"-z", {0, 0, 1}},  {"+z", {0, 0, -1}}};
    std::set<std::string> open;
    for (const auto& [side, place] : keys.list("open")) {
        const std::string name = side->is_string() ? side->get<std::string>() : "";
        const bool known =
            std::any_of(std::begin(sides), std::end(sides), [&](auto& s) { return s.first == name; });
        if (!known || !open.insert(name).second)
            throw io::InvalidInput(place + ": must be one of -x, +x, -y, +y, -z, +z, each once, got " +
                                   side->dump());
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
    if (all.empty()) keys.refuse("open", "must not contain all six sides", keys.raw("open"));
    return all;
}

}  // namespace

std::vector<NamedBoundary> read_boundary(Keys& keys, const std::string& name)
{
    const std::string type = keys.text("type");
    NamedBoundary one = read_motion(keys, name);
    if (type == "box") return read_box(keys, one);
    read_tool(keys, one);
    Boundary& b = one.boundary;
    if (type == "plane") {
        b.axis = unit_vector(keys, "normal");
        return {one};
    }
    b.inside = keys.flag("inside");
    if (type == "sphere") {
        b.shape = Boundary::Shape::sphere;
        b.radius = keys.positive("radius");
    } else if (type == "cylinder") {
        b.shape = Boundary::Shape::cylinder;
        b.axis = unit_vector(keys, "axis");
        b.radius = keys.positive("radius");
    } else if (type == "cone") {
        b.shape = Boundary::Shape::cone;
        b.axis = unit_vector(keys, "axis");
        const double half = keys.number("half_angle");
        if (!(half > 0 && half < M_PI / 2)) keys.refuse("half_angle", "must be in (0, pi/2) rad", half);
        b.cosine = std::cos(half), b.sine = std::sin(half);
    } else {
        keys.refuse("type", "must be one of plane, box, cylinder, cone, sphere", type);
    }
    return {one};
}

}  // namespace hilda::granular
