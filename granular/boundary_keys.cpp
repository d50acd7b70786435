// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/boundary_keys.hpp"

#include <cmath>

namespace hilda::granular {

namespace {

Vec3 unit_vector(Keys& keys, const std::string& key)
{
    const Vec3 v = keys.vector(key);
    if (!(v.norm() > 0)) keys.refuse(key, "must not be zero", keys.raw(key));
    return (1 / v.norm()) * v;
}

/// The sides that `open` leaves
std::vector<NamedBoundary> read_box(Keys& keys, const std::string& name, const Boundary& moves)
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
        const bool known = side->is_string() && std::any_of(std::begin(sides), std::end(sides), [&](auto& s) {
                               return s.first == side->get<std::string>();
                           });
        if (!known || !open.insert(side->get<std::string>()).second)
            throw InvalidCase(place + ": must be one of -x, +x, -y, +y, -z, +z, each once, got " +
                              side->dump());
    }
    std::vector<NamedBoundary> all;
    for (const auto& [side, normal] : sides) {
        if (open.contains(side)) continue;
        Boundary b = moves;
        b.axis = normal;
        b.r += side[0] == '-' ? low : high;
        all.push_back({name + side, b});
    }
    if (all.empty()) keys.refuse("open", "must leave a side", keys.raw("open"));
    return all;
}

}  // namespace

std::vector<NamedBoundary> read_boundary(Keys& keys, const std::string& name)
{
    Boundary b;
    const std::string type = keys.text("type");
    b.r = keys.vector("r", {0, 0, 0});
    b.v = keys.vector("v", {0, 0, 0});
    if (type == "box") return read_box(keys, name, b);
    b.omega = keys.vector("omega", {0, 0, 0});
    if (type == "plane") {
        b.axis = unit_vector(keys, "normal");
        return {{name, b}};
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
    return {{name, b}};
}

}  // namespace hilda::granular
