// SPDX-License-Identifier: GPL-3.0-or-later
// Limits of stability of structures without mortar: they stand on one side of the limit and fall on the
// other.
#include <catch2/catch.hpp>

#include "tests/contact/rigid/rigid_models.hpp"

#include <cmath>
#include <vector>

using namespace hilda;

namespace rigid_tests {

namespace {

constexpr double at_rest = 1e-10, fallen = 0.02;  // displacements [m]

/// The largest displacement of a body until t_end, or until the structure has fallen
double largest_displacement(const std::string& text, double t_end)
{
    constexpr double h = 1e-3;
    Run r(text, h);
    const State start = r.state();
    double largest = 0;
    while (r.state().t < t_end - 0.5 * h && largest < fallen) {
        r.step();
        for (std::size_t b = 0; b < start.body.size(); ++b)
            largest = std::max(largest, (r.state().body[b].r - start.body[b].r).norm());
    }
    CHECK(r.statistics().friction_relaxed == 0);
    return largest;
}

// Five boxes of length 0.2 m, each shifted over the one below by `factor` of the largest shifts, on a table
std::string harmonic_stack(double factor)
{
    const Vec3 lengths(0.2, 0.2, 0.05);
    std::vector<std::string> bodies, contacts;
    double x = -0.1;
    for (int k = 0; k < 5; ++k) {  // from below
        x += factor * 0.1 / (5 - k);
        const std::string name = "b" + std::to_string(k);
        bodies.push_back(body(name, 1, box_shape(lengths), Vec3(x, 0, 0.025 + 0.05 * k)));
        contacts.push_back(
            k == 0 ? contact_of(name, "ground", box_surface(lengths),
                                R"({"type": "box", "lengths": [1, 1, 1], "position": [-0.5, 0, -0.5]})", 0.5)
                   : contact_of(name, "b" + std::to_string(k - 1), box_surface(lengths), box_surface(lengths),
                                0.5));
    }
    return model(joined(bodies), joined(contacts));
}

// The quadrilateral (x, z) as a prism of width 0.2 m along y, of density 1000 kg/m³
struct Prism {
    Prism(std::vector<Eigen::Vector2d> corners) : corner(std::move(corners))
    {
        double area = 0, xx = 0, zz = 0, xz = 0;
        for (std::size_t k = 0; k < corner.size(); ++k) {
            const Eigen::Vector2d &a = corner[k], &b = corner[(k + 1) % corner.size()];
            const double cross = a.x() * b.y() - b.x() * a.y();
            area += cross / 2;
            centre += cross / 6 * (a + b);
            xx += cross / 12 * (a.x() * a.x() + a.x() * b.x() + b.x() * b.x());
            zz += cross / 12 * (a.y() * a.y() + a.y() * b.y() + b.y() * b.y());
            xz += cross / 24 * (a.x() * b.y() + 2 * a.x() * a.y() + 2 * b.x() * b.y() + b.x() * a.y());
        }
        centre /= area;
        mass = 1000 * width * std::abs(area);
        const double of_area = 1000 * width * (area > 0 ? 1 : -1);
        xx = of_area * xx - mass * centre.x() * centre.x();
        zz = of_area * zz - mass * centre.y() * centre.y();
        xz = of_area * xz - mass * centre.x() * centre.y();
        const double yy = mass * width * width / 12;
        inertia << yy + zz, 0, -xz, 0, xx + zz, 0, -xz, 0, yy + xx;
    }
    std::string body(const std::string& name) const
    {
        std::string rows;
        for (int k = 0; k < 3; ++k) rows += (k > 0 ? ", " : "") + list(inertia.row(k));
        return R"({"name": ")" + name + R"(", "mass": )" + number(mass) + R"(, "inertia": [)" + rows +
               R"(], "r": )" + list(Vec3(centre.x(), 0, centre.y())) + '}';
    }
    std::string surface() const
    {
        std::vector<std::string> vertices;
        for (const Eigen::Vector2d& c : corner)
            for (const double y : {-width / 2, width / 2})
                vertices.push_back(list(Vec3(c.x() - centre.x(), y, c.y() - centre.y())));
        return R"({"type": "convex", "vertices": [)" + joined(vertices) + "]}";
    }

    static constexpr double width = 0.2;
    std::vector<Eigen::Vector2d> corner;
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();
    double mass = 0;
    Eigen::Matrix3d inertia;
};

// A semicircular arch of n voussoirs with the thickness t and the mean radius 1 m
std::string arch(int n, double t, double mu)
{
    std::vector<std::string> bodies, contacts;
    std::vector<Prism> voussoir;
    const auto at = [&](double r, int k) {
        const double angle = std::numbers::pi * k / n;
        return Eigen::Vector2d(-r * std::cos(angle), r * std::sin(angle));
    };
    for (int k = 0; k < n; ++k) {
        voussoir.push_back(
            {{at(1 - t / 2, k), at(1 + t / 2, k), at(1 + t / 2, k + 1), at(1 - t / 2, k + 1)}});
        const std::string name = "v" + std::to_string(k);
        bodies.push_back(voussoir.back().body(name));
        if (k == 0 || k == n - 1) contacts.push_back(on_floor(name, voussoir.back().surface(), mu));
        if (k > 0)
            contacts.push_back(contact_of(name, "v" + std::to_string(k - 1), voussoir.back().surface(),
                                          voussoir[static_cast<std::size_t>(k) - 1].surface(), mu));
    }
    return model(joined(bodies), joined(contacts));
}

// Cylinders along y, or balls: their centres, and the friction between them and on the floor
std::string pile(const std::vector<Vec3>& centres, bool cylinders, double mutual, double on_the_floor)
{
    const std::string surface =
        cylinders ? R"({"type": "capsule", "length": 0.5, "radius": 0.1, "axis": [0, 1, 0]})"
                  : ball_surface(0.1);
    const std::string shape = cylinders ? R"({"cylinder": [0.1, 0.5], "axis": "y"})" : ball_shape(0.1);
    std::vector<std::string> bodies, contacts;
    for (std::size_t k = 0; k < centres.size(); ++k) {
        const std::string name = "b" + std::to_string(k);
        bodies.push_back(body(name, 1, shape, centres[k]));
        contacts.push_back(on_floor(name, surface, on_the_floor));
        for (std::size_t l = 0; l < k; ++l)
            contacts.push_back(contact_of(name, "b" + std::to_string(l), surface, surface, mutual));
    }
    return model(joined(bodies), joined(contacts));
}

// Two cards of height 1 m with rounded edges that lean on each other at `angle` from the vertical
std::string card_house(double angle, double mu_floor)
{
    const double R = 1e-4;
    const std::string surface =
        R"({"type": "polygon", "vertices": [[-0.5, -0.3], [0.5, -0.3], [0.5, 0.3], [-0.5, 0.3]], "radius": )" +
        number(R) + R"(, "axis_angle": [0, 1, 0, 1.5707963267948966]})";
    const auto card = [&](const std::string& name, double side) {
        const Vec3 centre(side * (0.5 * std::sin(angle) + R), 0, 0.5 * std::cos(angle) + R);
        return body(name, 0.1, box_shape(Vec3(2 * R, 0.6, 1)), centre, Vec3::Zero(), Vec3::Zero(),
                    about_y(-side * angle));
    };
    return model(card("left", -1) + ", " + card("right", 1),
                 joined({on_floor("left", surface, mu_floor), on_floor("right", surface, mu_floor),
                         contact_of("left", "right", surface, surface, 0.5)}));
}

// A ladder of 1 m as a thin capsule at `angle` from the floor against the wall x = 0
std::string ladder(double angle, double mu_floor, double mu_wall)
{
    const double R = 1e-4;
    const std::string surface = R"({"type": "capsule", "length": 1, "radius": 0.0001, "axis": [1, 0, 0]})";
    const Vec3 centre(-R - 0.5 * std::cos(angle), 0, R + 0.5 * std::sin(angle));
    return model(
        body("ladder", 1, box_shape(Vec3(1, 0.3, 0.01)), centre, Vec3::Zero(), Vec3::Zero(), about_y(-angle)),
        on_floor("ladder", surface, mu_floor) +
            R"(, {"name": "wall", "body_i": "ladder", "body_j": "ground", "surface_i": )" + surface +
            R"(, "surface_j": {"type": "plane", "normal": [-1, 0, 0]}, )" + dvi(mu_wall, 0) + "}");
}

}  // namespace

TEST_CASE("a harmonic stack stands with 0.99 of the largest shifts and falls with 1.01", "[contact][rigid]")
{
    CHECK(largest_displacement(harmonic_stack(0.99), 2) < at_rest);
    CHECK(largest_displacement(harmonic_stack(1.01), 2) >= fallen);
}

TEST_CASE("a semicircular arch stands above its least thickness and falls below it (long)",
          "[contact][rigid]")
{
    // limits of the equilibrium of its joints, by linear programming
    for (const auto& [n, least] : {std::pair{12, 0.1048567963}, {27, 0.1067209148}}) {
        CAPTURE(n);
        CHECK(largest_displacement(arch(n, 1.01 * least, 0.8), 1) < at_rest);
        CHECK(largest_displacement(arch(n, 0.99 * least, 0.8), 1) >= fallen);
    }
}

TEST_CASE("a thick arch slides apart below its least friction (long)", "[contact][rigid]")
{
    CHECK(largest_displacement(arch(12, 0.2, 1.01 * 0.3108787537), 1) < at_rest);
    CHECK(largest_displacement(arch(12, 0.2, 0.99 * 0.3108787537), 1) >= fallen);
}

TEST_CASE("three cylinders and four balls stand with enough friction (long)", "[contact][rigid]")
{
    const double to_centre = 0.2 / std::sqrt(3.);
    const std::vector<Vec3> cylinders = {{-0.1, 0, 0.1}, {0.1, 0, 0.1}, {0, 0, 0.1 + 0.1 * std::sqrt(3.)}},
                            balls = {{to_centre, 0, 0.1},
                                     {-to_centre / 2, 0.1, 0.1},
                                     {-to_centre / 2, -0.1, 0.1},
                                     {0, 0, 0.1 + 0.2 * std::sqrt(2. / 3)}};
    for (const bool of_cylinders : {true, false}) {
        CAPTURE(of_cylinders);
        // tan 15° between cylinders and a third of it on the floor; balls: tan(asin(1/√3)/2) and a quarter
        const double mutual = of_cylinders ? 0.2679491924 : 0.3178372452,
                     floor = of_cylinders ? 0.08931639748 : 0.0794593113;
        const auto& centres = of_cylinders ? cylinders : balls;
        const auto displacement = [&](double between, double below) {
            return largest_displacement(pile(centres, of_cylinders, between, below), 1);
        };
        CHECK(displacement(1.02 * mutual, 1.02 * floor) < at_rest);
        CHECK(displacement(0.98 * mutual, 0.5) >= fallen);
        CHECK(displacement(0.6, 0.98 * floor) >= fallen);
    }
}

TEST_CASE("a house of two cards stands with enough friction on the floor", "[contact][rigid]")
{
    const double needed = std::tan(20 * degree) / 2;
    CHECK(largest_displacement(card_house(20 * degree, 1.01 * needed), 1) < at_rest);
    CHECK(largest_displacement(card_house(20 * degree, 0.99 * needed), 1) >= fallen);
}

TEST_CASE("a ladder stands above its least angle and slides below it", "[contact][rigid]")
{
    const double least = std::atan((1 - 0.3 * 0.2) / (2 * 0.3));
    CHECK(largest_displacement(ladder(1.01 * least, 0.3, 0.2), 1) < at_rest);
    CHECK(largest_displacement(ladder(0.99 * least, 0.3, 0.2), 1) >= fallen);
}

}  // namespace rigid_tests
