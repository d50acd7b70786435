// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies of random types that fall on a floor and on each other: the contact law, overlaps, energy.
#include <catch2/catch.hpp>

#include "tests/contact/rigid/rigid_models.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

using namespace hilda;

namespace rigid_tests {

namespace {

struct Thrown {
    std::string text;
    double mu, e;
    std::vector<double> mass;
};

/// Two to five boxes, thin boxes, balls, capsules, double cones and plates above each other, rotated and
/// moving, on a plane or a large box
Thrown thrown(unsigned seed)
{
    std::mt19937 random(seed);
    const auto between = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random()) / 4294967296.;
    };
    const auto choose = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    const auto direction = [&] {
        const double x = between(-1, 1), y = between(-1, 1), z = between(-1, 1);
        return Vec3(x, y, z + 1e-3).normalized();
    };
    Thrown all;
    all.mu = std::vector{0., 0.1, 0.5, 1.}[static_cast<std::size_t>(choose(4))];
    all.e = std::vector{0., 0., 0., 0.5}[static_cast<std::size_t>(choose(4))];
    std::vector<std::string> surfaces, bodies, contacts;
    double z = 0.05;
    for (int k = 2 + choose(4); k > 0; --k) {
        const double L = between(0.05, 0.4), r = between(0.1, 0.4) * L;
        std::string shape = ball_shape(L);
        const int type = choose(6);
        if (type == 0 || type == 1) {
            Vec3 lengths(between(0.05, 0.5), between(0.05, 0.5), between(0.05, 0.5));
            if (type == 1) lengths[choose(3)] *= 0.1;
            lengths *= L / lengths.norm();
            shape = box_shape(lengths);
            surfaces.push_back(box_surface(lengths));
        } else if (type == 2) {
            surfaces.push_back(ball_surface(r));
        } else if (type == 3) {
            surfaces.push_back(R"({"type": "capsule", "length": )" + number(L) + R"(, "radius": )" +
                               number(r) + '}');
        } else if (type == 4) {
            surfaces.push_back(R"({"type": "convex", "vertices": [)" +
                               joined({list(Vec3(L, 0, 0)), list(Vec3(-L, 0, 0)), list(Vec3(0, r, 0)),
                                       list(Vec3(0, -r, r)), list(Vec3(0, -r, -r))}) +
                               "]}");
        } else {
            const std::string a = number(L / 2), b = number(r);
            surfaces.push_back(R"({"type": "polygon", "vertices": [[-)" + a + ", -" + b + "], [" + a + ", -" +
                               b + "], [" + a + ", " + b + "], [-" + a + ", " + b + R"(]], "radius": )" +
                               number(0.02 * L) + '}');
        }
        const double size = 1.1 * L;
        z += size;
        const Vec3 axis = direction();
        const std::string name = "b" + std::to_string(bodies.size());
        all.mass.push_back(std::pow(10, between(-1, 1)));
        bodies.push_back(body(name, all.mass.back(), shape, Vec3(between(-0.1, 0.1), between(-0.1, 0.1), z),
                              Vec3(between(-1, 1), between(-1, 1), between(-3, 0.5)),
                              between(0, 10) * direction(),
                              R"(, "axis_angle": [)" + number(axis[0]) + ", " + number(axis[1]) + ", " +
                                  number(axis[2]) + ", " + number(between(0, 3)) + ']'));
        z += size + 0.01;
    }
    const std::string floor = choose(3) == 0
                                  ? R"({"type": "box", "lengths": [20, 20, 1], "position": [0, 0, -0.5]})"
                                  : R"({"type": "plane"})";
    for (std::size_t k = 0; k < bodies.size(); ++k) {
        const std::string name = "b" + std::to_string(k);
        contacts.push_back(contact_of(name, "ground", surfaces[k], floor, all.mu, all.e));
        for (std::size_t l = 0; l < k; ++l)
            contacts.push_back(
                contact_of(name, "b" + std::to_string(l), surfaces[k], surfaces[l], all.mu, all.e));
    }
    all.text = model(joined(bodies), joined(contacts));
    return all;
}

/// Largest violation [m/s] of Coulomb's and Signorini's law for the rows of the beginning of the step and e =
/// 0
double violation(const lie::ConeRows& rows, const State& x, double h)
{
    double largest = 0;
    for (const lie::ConeRows::Cone& c : rows.cone) {
        Vec3 u = Vec3::Zero(), F = Vec3::Zero();
        const auto add = [&](int b, const lie::ConeRows::Mat36& C) {
            if (b < 0) return;
            const lie::Motion& of = x.body[static_cast<std::size_t>(b)];
            u += C.leftCols<3>() * of.rdot + C.rightCols<3>() * of.omega_bar;
        };
        add(c.i, c.C_i), add(c.j, c.C_j);
        for (const lie::ConeForce& f : x.cone_forces)
            if (f.key == c.key) F = c.axes.transpose() * f.F;
        const double u_n = u[0] + std::max(c.gap, 0.) / h, u_t = std::hypot(u[1], u[2]),
                     F_t = std::hypot(F[1], F[2]);
        largest = std::max(largest, -u_n);
        CHECK(F_t <= c.mu_s * F[0] + 1e-4);
        if (F[0] < 1e-3) continue;
        largest = std::max(largest, u_n);
        if (F_t < 0.999 * c.mu_s * F[0]) largest = std::max(largest, u_t);  // sticks
        if (c.mu_s > 0 && u_t > 1e-5)
            CHECK(F[1] * u[1] + F[2] * u[2] < -0.999 * F_t * u_t);  // opposes the slip
    }
    return largest;
}

}  // namespace

TEST_CASE("thrown bodies satisfy the contact law and do not overlap (long)", "[contact][rigid]")
{
    const double h = 1e-3;
    for (unsigned seed = 1; seed <= 40; ++seed) {
        CAPTURE(seed);
        const Thrown scene = thrown(seed);
        Run r(scene.text, h);
        const double start = r.energy();
        double overlap = 0, law = 0, energy = start;
        lie::ConeRows rows;
        for (int n = 0; n < 700; ++n) {
            r.system().cones(r.state(), h, rows);
            r.step();
            if (scene.e == 0) law = std::max(law, violation(rows, r.state(), h));
            r.system().cones(r.state(), 0, rows);
            for (const auto& c : rows.cone) overlap = std::max(overlap, -c.gap / c.size);
            energy = std::max(energy, r.energy());
        }
        CHECK(overlap < 1e-6);
        CHECK(law < 1e-6);
        CHECK(energy - start < 2e-3 * start);
        CHECK(r.statistics().friction_relaxed == 0);
    }
}

}  // namespace rigid_tests
