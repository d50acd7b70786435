// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/insertion/region.hpp"

#include "granular/world/value_text.hpp"
#include "io/schema/type_schema.hpp"

#include <cmath>

namespace hilda::granular {

namespace {

/// A unit vector that is perpendicular to a unit vector
Vec3 perpendicular(const Vec3& a)
{
    const Vec3 other = std::abs(a.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}, across = a.cross(other);
    return (1 / across.norm()) * across;
}

}  // namespace

Vec3 InsertionRegion::centre(double R, Random& random) const
{
    const double a = random.number(), b = random.number(), c = random.number();
    if (shape == Shape::box)
        return {low.x + R + a * (high.x - low.x - 2 * R), low.y + R + b * (high.y - low.y - 2 * R),
                low.z + R + c * (high.z - low.z - 2 * R)};
    const Vec3 e = perpendicular(axis), f = axis.cross(e);
    const double rho = (radius - R) * std::sqrt(a), angle = 2 * M_PI * b,
                 along = shape == Shape::cylinder ? R + c * (length - 2 * R) : 0;
    return r + along * axis + (rho * std::cos(angle)) * e + (rho * std::sin(angle)) * f;
}

std::pair<Vec3, Vec3> InsertionRegion::bounds(double R) const
{
    if (shape == Shape::box) return {low, high};
    const auto across = [&](double a) { return radius * std::sqrt(std::max(0., 1 - a * a)); };
    const double more = shape == Shape::disk ? R : 0;
    const Vec3 half{across(axis.x) + more, across(axis.y) + more, across(axis.z) + more}, end = length * axis;
    const auto below = [](double a, double h) { return std::min(a, 0.) - h; };
    const auto above = [](double a, double h) { return std::max(a, 0.) + h; };
    return {r + Vec3{below(end.x, half.x), below(end.y, half.y), below(end.z, half.z)},
            r + Vec3{above(end.x, half.x), above(end.y, half.y), above(end.z, half.z)}};
}

std::string InsertionRegion::description() const
{
    using detail::shown;
    if (shape == Shape::box) return "box from " + shown(low) + " to " + shown(high);
    if (shape == Shape::disk)
        return "disk of radius " + io::shortest(radius) + " around " + shown(r) + " with the normal " +
               shown(axis);
    return "cylinder of radius " + io::shortest(radius) + " and length " + io::shortest(length) + " from " +
           shown(r) + " along " + shown(axis);
}

InsertionRegion read_region(ObjectReader o, double R)
{
    InsertionRegion region;
    const std::string type = o.one_of("type", {"box", "cylinder", "disk"});
    io::defines_type(
        o, {"Region", "type", "Type of the region."}, "region_" + type, type,
        {.description =
             type == "box" ? "A box along the axes."
             : type == "cylinder"
                 ? "A cylinder between two planes perpendicular to its axis."
                 : "A disk. The centres of the particles lie on it, and the particles within its radius.",
         .examples = {}});
    const auto at_least = [&](const char* key, double value, double least) {
        if (!(value >= least))
            o.fail(key, std::string(key) + " must be at least " + io::shortest(least) +
                            ", so that the largest particle has place, got " + io::shortest(value));
    };
    if (type == "box") {
        region.low = o.vec3("low", {"Lower corner [m], in the global frame.", "[0, 0, 0.09]"});
        region.high = o.vec3(
            "high", {"Upper corner [m], in the global frame. The box must be at least one diameter wide.",
                     "[0.03, 0.02, 0.1]"});
        for (const auto& [low, high, axis] : {std::tuple{region.low.x, region.high.x, 0u},
                                              {region.low.y, region.high.y, 1u},
                                              {region.low.z, region.high.z, 2u}})
            if (!(high - low >= 2 * R))
                o.fail("high", axis,
                       "high must be at least a diameter, " + io::shortest(2 * R) + ", above low, " +
                           io::shortest(low) + ", got " + io::shortest(high));
    } else {
        const bool is_disk = type == "disk";
        region.shape = is_disk ? InsertionRegion::Shape::disk : InsertionRegion::Shape::cylinder;
        region.r = o.vec3("r", {is_disk ? "Centre [m], in the global frame."
                                        : "Centre of its base [m], in the global frame.",
                                "[0, 0, 0.1]"});
        region.axis =
            is_disk
                ? o.direction("normal", {"Normal of the disk, in the global frame [-].", "[0, 0, 1]"})
                : o.direction("axis", {"Direction from the base to the other end, in the global frame [-].",
                                       "[0, 0, 1]"});
        region.radius = o.positive(
            "radius", {is_disk ? "Radius of the disk [m]." : "Radius of the cylinder [m].", "0.04"});
        at_least("radius", region.radius, R);
        if (!is_disk) {
            region.length =
                o.positive("length", {"Length along the axis, at least one diameter [m].", "0.02"});
            at_least("length", region.length, 2 * R);
        }
    }
    o.finish();
    return region;
}

}  // namespace hilda::granular
