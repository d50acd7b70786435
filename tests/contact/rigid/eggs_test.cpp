// SPDX-License-Identifier: GPL-3.0-or-later
// Smooth convex bodies among boxes: an ellipsoid on a box, ellipsoids, superquadrics and boxes in a bin.
#include <catch2/catch.hpp>

#include "tests/contact/rigid/rigid_models.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace rigid_tests {

TEST_CASE("an ellipsoid that lands on a box settles on its flat side (long)", "[contact][rigid]")
{
    const Vec3 table(0.4, 0.4, 0.1), axes(0.06, 0.05, 0.03);
    const std::string surface = R"({"type": "ellipsoid", "semi_axes": )" + list(axes) + '}';
    Run r(model(body("table", 5, box_shape(table), Vec3(0, 0, 0.05)) + ", " +
                    body("egg", 0.5, R"({"ellipsoid": )" + list(axes) + '}', Vec3(0.02, 0.01, 0.16),
                         Vec3(0.05, 0, 0), Vec3(0.5, 0.3, 0), about_y(0.3)),
                on_floor("table", box_surface(table), 0.5) + ", " +
                    contact_of("egg", "table", surface, box_surface(table), 0.5)),
          1e-3);
    double rise = 0, before = r.energy();
    r.to(4, [&](const State&) {
        const double now = r.energy();
        rise = std::max(rise, now - before);
        before = now;
    });
    CHECK(rise < 1e-5);
    CHECK(r.statistics().overlap < 1e-6);
    CHECK(r.points(1).size() == 1);
    // it rocks on the box, without rolling resistance
    CHECK(r.body(1).r.z() > 0.1 + 0.03 - 1e-7);
    CHECK(r.body(1).r.z() < 0.1 + 0.05);
    CHECK((r.body(0).r - Vec3(0, 0, 0.05)).norm() < 1e-8);
}

TEST_CASE("eggs and superquadrics fall into a bin of boxes (long)", "[contact][rigid]")
{
    std::vector<std::string> bodies, contacts;
    const std::string egg = R"({"type": "ellipsoid", "semi_axes": [0.03, 0.04, 0.05]})",
                      stone = R"({"type": "superquadric", "semi_axes": [0.04, 0.03, 0.03], "exponent": 4})",
                      box = box_surface(Vec3(0.06, 0.05, 0.04));
    const std::string surfaces[] = {egg, stone, box};
    const std::string shapes[] = {R"({"ellipsoid": [0.03, 0.04, 0.05]})", box_shape(Vec3(0.08, 0.06, 0.06)),
                                  box_shape(Vec3(0.06, 0.05, 0.04))};
    constexpr int n = 6;
    const auto fixed = [](const Vec3& lengths, const Vec3& at) {
        return R"({"type": "box", "lengths": )" + list(lengths) + R"(, "position": )" + list(at) + '}';
    };
    const std::string bin[] = {
        fixed(Vec3(0.6, 0.6, 0.2), Vec3(0, 0, -0.1)), fixed(Vec3(0.2, 0.6, 1), Vec3(0.2, 0, 0.5)),
        fixed(Vec3(0.2, 0.6, 1), Vec3(-0.2, 0, 0.5)), fixed(Vec3(0.6, 0.2, 1), Vec3(0, 0.2, 0.5)),
        fixed(Vec3(0.6, 0.2, 1), Vec3(0, -0.2, 0.5))};
    for (int k = 0; k < n; ++k) {
        const std::string name = "b" + std::to_string(k);
        bodies.push_back(body(name, 0.3, shapes[k % 3],
                              Vec3(0.01 * (k % 2), 0.012 * (k % 3), 0.08 + 0.11 * k), Vec3(0, 0, -0.5),
                              Vec3(1, k, 2), about_y(0.4 * k)));
        int w = 0;
        for (const std::string& side : bin)
            contacts.push_back(contact_of(name, "ground", surfaces[k % 3], side, 0.4)
                                   .replace(10, name.size() + 7, name + "-wall" + std::to_string(w++)));
        for (int l = 0; l < k; ++l)
            contacts.push_back(
                contact_of(name, "b" + std::to_string(l), surfaces[k % 3], surfaces[l % 3], 0.4));
    }
    Run r(model(joined(bodies), joined(contacts)), 1e-3);
    const double before = r.energy();
    r.to(3);
    CHECK(r.statistics().overlap < 1e-6);
    double kinetic = 0;
    for (int k = 0; k < n; ++k) {
        CHECK(r.body(k).r.z() > 0.01);
        kinetic += 0.15 * r.body(k).rdot.squaredNorm();
    }
    CHECK(kinetic < 1e-3);
    CHECK(r.energy() < before);
}

}  // namespace rigid_tests
