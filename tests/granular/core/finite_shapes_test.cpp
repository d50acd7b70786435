// SPDX-License-Identifier: GPL-3.0-or-later
// Finite surfaces of revolution: distance, normal, curvature and the number of contacts, against sampled
// points.
#include "granular/backend/split_mix.hpp"
#include "granular/core/boundary.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <numbers>
#include <string>
#include <vector>

using namespace hilda::granular;
using Shape = Boundary::Shape;

namespace finite_shapes_test {

namespace {

constexpr double pi = std::numbers::pi;
const Vec3 axis = (1 / std::sqrt(14.)) * Vec3{1, -2, 3}, place = {0.3, -0.2, 0.1};

/// Point of a profile in the meridian half-plane with the normal towards the particles
struct Sample {
    double rho, z, n_rho, n_z;
};

struct Case {
    std::string name;
    Boundary b;
    std::vector<Sample> profile;
    bool is_signed;  ///< whether points behind the surface have a negative distance
};

/// Points of the line from a to b, with the normal on its left
void add_line(std::vector<Sample>& to, std::array<double, 2> a, std::array<double, 2> b)
{
    constexpr int n = 4000;
    const double x = b[0] - a[0], y = b[1] - a[1], l = std::hypot(x, y);
    for (int k = 0; k <= n; ++k) to.push_back({a[0] + k * x / n, a[1] + k * y / n, -y / l, x / l});
}

Case frustum_case(std::string name, double r0, double r1, bool inside, std::int32_t flags)
{
    Case c{std::move(name), frustum(place, axis, 0.8, r0, r1), {}, inside == false && flags == 0};
    // r in the middle, as that of a tool
    c.b.inside = inside ? 1 : 0, c.b.flags = flags, c.b.from -= 0.3, c.b.to -= 0.3;
    const double low = c.b.from, high = c.b.to;
    if (inside) {
        add_line(c.profile, {r0, low}, {r1, high});
        return c;
    }
    if ((flags & open_second_end) == 0 && r1 > 0) add_line(c.profile, {0, high}, {r1, high});
    add_line(c.profile, {r1, high}, {r0, low});
    if ((flags & open_first_end) == 0 && r0 > 0) add_line(c.profile, {r0, low}, {0, low});
    return c;
}

Case disk_case(std::string name, std::int32_t flags)
{
    Case c{std::move(name), {}, {}, false};
    c.b.shape = Shape::disk, c.b.r = place, c.b.axis = axis, c.b.radius = 0.5, c.b.flags = flags;
    add_line(c.profile, {0, 0}, {0.5, 0});
    return c;
}

Case torus_case(std::string name, bool inside)
{
    Case c{std::move(name), {}, {}, true};
    c.b.shape = Shape::torus, c.b.r = place, c.b.axis = axis, c.b.radius = 0.2, c.b.second_radius = 0.5;
    c.b.inside = inside ? 1 : 0;
    for (int k = 0; k < 12000; ++k) {
        const double angle = 2 * pi * k / 12000, sign = inside ? -1 : 1;
        c.profile.push_back({0.5 + 0.2 * std::cos(angle), 0.2 * std::sin(angle), sign * std::cos(angle),
                             sign * std::sin(angle)});
    }
    return c;
}

std::vector<Case> cases()
{
    const std::int32_t open = open_first_end | open_second_end;
    return {frustum_case("cylinder", 0.4, 0.4, false, 0),
            frustum_case("widening", 0.2, 0.6, false, 0),
            frustum_case("narrowing", 0.5, 0.1, false, 0),
            frustum_case("flat", 0.9, 0.05, false, 0),
            frustum_case("pointed", 0, 0.6, false, 0),
            frustum_case("open shell", 0.2, 0.5, false, open),
            frustum_case("cup", 0.3, 0.5, false, open_second_end),
            frustum_case("pipe", 0.5, 0.3, false, open | two_sided_surface),
            frustum_case("hopper", 0.2, 0.6, true, open),
            frustum_case("silo", 0.2, 0.6, true, open_first_end),
            disk_case("disk", 0),
            disk_case("two-sided disk", two_sided_surface),
            torus_case("tyre", false),
            torus_case("hose", true)};
}

/// Coordinates of a point in its meridian half-plane
std::array<double, 2> meridian(const Boundary& b, const Vec3& at)
{
    const Vec3 d = at - b.r;
    const double z = d.dot(b.axis);
    return {(d - z * b.axis).norm(), z};
}

/// The closest point of a profile to (rho, z)
const Sample& closest(const std::vector<Sample>& profile, double rho, double z)
{
    return *std::min_element(profile.begin(), profile.end(), [&](const Sample& a, const Sample& b) {
        return std::hypot(a.rho - rho, a.z - z) < std::hypot(b.rho - rho, b.z - z);
    });
}

constexpr double spacing = 4e-4;  // of the samples, at most

}  // namespace

TEST_CASE("the distance of a finite surface is that of its closest sampled point", "[granular][shapes]")
{
    hilda::granular::Random random(3);
    for (const Case& c : cases()) {
        int contacts = 0, none = 0;
        for (int k = 0; k < 400; ++k) {
            const Vec3 at = c.b.r + random.number(0, 1.3) * random.direction();
            const auto [rho, z] = meridian(c.b, at);
            const Sample& s = closest(c.profile, rho, z);
            const double sampled = std::hypot(s.rho - rho, s.z - z);
            double front = -1;  // height above the face of the closest sample, at an edge above one of two
            for (const Sample& o : c.profile)
                if (std::hypot(o.rho - s.rho, o.z - s.z) < 1e-12)
                    front = std::max(front, (rho - s.rho) * o.n_rho + (z - s.z) * o.n_z);
            INFO(c.name << " at rho = " << rho << ", z = " << z);
            const Nearest near = nearest(c.b, at);
            if (near.distance == no_contact_distance) {
                // behind the surface, or beside a closed end, which is a surface of its own
                const bool beside = c.name == "silo" && s.z > c.b.to - spacing && z > s.z - spacing;
                CHECK((front < 1e-3 * sampled + spacing || beside));
                ++none;
                continue;
            }
            ++contacts;
            const bool two_sided = (c.b.flags & two_sided_surface) != 0;
            const double sign = !two_sided && near.distance < 0 ? -1 : 1;
            CHECK(sampled >= std::abs(near.distance) - 1e-12);
            CHECK(sampled <= std::hypot(near.distance, spacing) + 1e-12);
            if (!two_sided && sampled > 0.01) CHECK(sign * front > -spacing);
            // point - distance n is on the surface
            const auto [rho_on, z_on] = meridian(c.b, at - near.distance * near.n);
            const Sample& on = closest(c.profile, rho_on, z_on);
            CHECK(std::hypot(on.rho - rho_on, on.z - z_on) < spacing);
            CHECK(near.n.norm() == Approx(1).epsilon(1e-12));
        }
        INFO(c.name);
        CHECK(contacts > 50);
        CHECK((none == 0) == (c.is_signed || (c.b.flags & two_sided_surface) != 0));
    }
}

TEST_CASE("the normal of a finite surface is the gradient of its distance", "[granular][shapes]")
{
    hilda::granular::Random random(5);
    for (const Case& c : cases()) {
        int compared = 0, curved = 0;
        for (int k = 0; k < 600; ++k) {
            const Vec3 at = c.b.r + random.number(0, 1.3) * random.direction();
            constexpr double e = 1e-6;
            const auto slope = [&](const Vec3& direction) {
                return (nearest(c.b, at + e * direction).distance -
                        nearest(c.b, at - e * direction).distance) /
                       (2 * e);
            };
            const Nearest near = nearest(c.b, at);
            if (near.distance == no_contact_distance || near.distance < 0.01) continue;
            if (meridian(c.b, at)[0] < 1e-2) continue;  // the differences are across the axis
            const Vec3 gradient = {slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})};
            if (!(gradient.norm() < 10)) continue;  // beside the end of the contact
            INFO(c.name << " at distance " << near.distance);
            CHECK((gradient - near.n).norm() < 1e-6);
            ++compared;
            // curvature of the faces; the edges have none of their own
            const Vec3 on = at - near.distance * near.n;
            const auto bend = [&](const Vec3& direction) {
                const Vec3 p = on + 2e-5 * near.n, d = 1e-5 * direction;
                return (nearest(c.b, p + d).n - nearest(c.b, p - d).n).dot(direction) / 2e-5;
            };
            if (near.curvature == 0 || std::abs(near.curvature) > 100) continue;
            const double half_divergence = 0.5 * (bend({1, 0, 0}) + bend({0, 1, 0}) + bend({0, 0, 1}));
            // at the height ε above the surface a principal curvature κ is κ/(1 + ε κ)
            CHECK(half_divergence == Approx(near.curvature).epsilon(1e-2).margin(1e-3));
            ++curved;
        }
        INFO(c.name);
        CHECK(compared > 30);
        CHECK((curved > 10) == (c.b.shape != Shape::disk));
    }
}

TEST_CASE("the normal turns continuously around the edges of a solid", "[granular][shapes]")
{
    for (const Case& c : cases()) {
        if (c.b.shape != Shape::frustum || !c.is_signed) continue;
        // along the curve at the distance 0.05 from the solid, by steps along the surface
        const Vec3 e = (1 / std::sqrt(5.)) * Vec3{2, 1, 0};
        constexpr double far = 0.05, step = 1e-3;
        Vec3 at = c.b.r + 1.2 * c.b.axis + 0.01 * e, last = {0, 0, 0};
        double largest = 0;
        int steps = 0;
        while (steps < 4000) {
            const Nearest near = nearest(c.b, at);
            at += (far - near.distance) * near.n;
            const Nearest there = nearest(c.b, at);
            if (steps > 0) largest = std::max(largest, (there.n - last).norm());
            last = there.n;
            const Vec3 around = c.b.axis.cross(e);
            Vec3 along = around.cross(there.n);
            at += (step / along.norm()) * along;
            if (++steps > 10 && meridian(c.b, at)[0] < 2e-3) break;
        }
        INFO(c.name << ": " << steps << " steps, largest change " << largest);
        CHECK(steps > 500);
        CHECK(steps < 4000);
        CHECK(largest < 1.2 * step / far);
    }
}

TEST_CASE("the bound of the distance is below all contacts and changes by at most 1 m per m",
          "[granular][shapes][neighbours]")
{
    hilda::granular::Random random(7);
    for (const Case& c : cases())
        for (int k = 0; k < 2000; ++k) {
            const Vec3 p = c.b.r + random.number(0, 1.5) * random.direction(),
                       q = p + random.number(0, 0.3) * random.direction();
            INFO(c.name);
            CHECK(std::abs(distance_bound(c.b, p) - distance_bound(c.b, q)) <= (p - q).norm() + 1e-14);
            CHECK(distance_bound(c.b, p) <= nearest(c.b, p).distance + 1e-14);
        }
}

TEST_CASE("inside a closed frustum there is one contact for each local minimum of the distance",
          "[granular][shapes]")
{
    hilda::granular::Random random(11);
    for (const auto& [r0, r1] : {std::pair{0.4, 0.4}, {0.2, 0.6}, {0.5, 0.1}}) {
        Boundary side = frustum({0, 0, 0}, {0, 0, 1}, 0.8, r0, r1), low, high;
        side.inside = 1;
        low.shape = high.shape = Shape::disk, low.flags = high.flags = without_edge;
        low.radius = r0, high.radius = r1, high.r = {0, 0, 0.8}, high.axis = {0, 0, -1};
        std::vector<Sample> profile;
        add_line(profile, {0, 0}, {r0, 0}), add_line(profile, {r0, 0}, {r1, 0.8});
        add_line(profile, {r1, 0.8}, {0, 0.8});
        profile.erase(std::unique(profile.begin(), profile.end(),
                                  [](const Sample& a, const Sample& b) {
                                      return std::hypot(a.rho - b.rho, a.z - b.z) < 1e-12;
                                  }),
                      profile.end());
        int found = 0;
        for (int k = 0; k < 2000; ++k) {
            const double z = random.number(0, 0.8), rho = random.number(0, r0 + (r1 - r0) * z / 0.8),
                         R = random.number(0.02, 0.15);
            int minima = 0, contacts = 0;
            bool doubtful = false;  // the distance or the place of a minimum is at its limit
            const auto distance = [&](std::size_t s) {
                return std::hypot(profile[s].rho - rho, profile[s].z - z);
            };
            for (std::size_t s = 1; s + 1 < profile.size(); ++s) {
                if (!(distance(s) < distance(s - 1) && distance(s) <= distance(s + 1))) continue;
                minima += distance(s) < R;
                doubtful = doubtful || std::abs(distance(s) - R) < 1e-5;
            }
            for (const auto& [edge_rho, edge_z] : {std::pair{r0, 0.}, {r1, 0.8}})
                for (const std::size_t s : {std::size_t{0}, profile.size() - 1})
                    doubtful = doubtful || std::abs(edge_rho - rho) < 1e-3 || std::abs(edge_z - z) < 1e-3 ||
                               distance(s) < R + 1e-3;
            const double t = side.sine * (rho - r0) + side.cosine * z;
            doubtful = doubtful || std::abs(t) < 1e-3 || std::abs(t - 0.8 / side.cosine) < 1e-3;
            if (doubtful) continue;
            for (const Boundary* b : {&side, &low, &high})
                contacts += nearest(*b, {rho * 0.6, rho * 0.8, z}).distance < R;
            INFO(r0 << " to " << r1 << ", rho " << rho << ", z " << z << ", R " << R);
            CHECK(contacts == minima);
            found += minima;
        }
        CHECK(found > 300);
    }
}

}  // namespace finite_shapes_test
