// SPDX-License-Identifier: GPL-3.0-or-later
// Rigid contacts of curved surfaces: a ball in a bowl, colliding ellipsoids, a row of balls.
#include <catch2/catch.hpp>

#include "tests/contact/rigid/rigid_models.hpp"

#include <cmath>
#include <utility>

using namespace hilda;

namespace rigid_tests {

namespace {

/// Linear momentum, and angular momentum of the nodes about the origin
std::pair<Vec3, Vec3> momenta(const Run& run, double h)
{
    Vec3 P = Vec3::Zero(), L = Vec3::Zero();
    for (std::size_t b = 0; b < run.state().body.size(); ++b) {
        const lie::Motion& x = run.state().body[b];
        const double m = run.system().mass().m[b];
        P += m * x.rdot;
        L += m * x.r.cross(x.rdot) + x.A * (lie::right_jacobian_inverse(-h * x.omega_bar) *
                                            (run.system().mass().J_bar[b] * x.omega_bar));
    }
    return {P, L};
}

}  // namespace

TEST_CASE("a ball that slides in a bowl converges with order one", "[contact][rigid][order]")
{
    // 1 kg, R = 0.5 m, in an ellipsoid with the semi-axes 4, 3 and 2 m, from rest at the contact point (1,
    // 1.5). The position and the normal force at 2 s are those of an ODE for the coordinates of the contact
    // point, integrated to 2e-12 m.
    const Vec3 start(0.930736435519058, 1.31529716138416, -1.19886988512596),
        end(-0.68252388691413, -1.31123546459089, -1.23253041628573);
    constexpr double N = 9.1922792041740102;
    std::vector<double> position, force;
    for (const double h : {4e-3, 2e-3, 1e-3}) {
        Run r(model(body("ball", 1, ball_shape(0.5), start),
                    contact_of("ball", "ground", ball_surface(0.5),
                               R"({"type": "ellipsoid", "semi_axes": [4, 3, 2], "concave": true})", 0)),
              h);
        r.to(2);
        position.push_back((r.body(0).r - end).norm());
        force.push_back(std::abs(r.points(0).at(0).N - N));
        CHECK(std::abs(r.points(0).at(0).at.gap) < 1e-9);
    }
    for (int n = 0; n < 2; ++n) {
        CAPTURE(n, position[n], position[n + 1], force[n], force[n + 1]);
        CHECK(std::log2(position[n] / position[n + 1]) == Approx(1).margin(0.1));
    }
    CHECK(force[2] < 2e-5);
    CHECK(force[0] == Approx(6 * force[1] - 8 * force[2]).epsilon(0.02));  // error a h + b h^2
    CHECK(position[2] < 2e-3);
}

TEST_CASE("ellipsoids that collide keep their momentum and angular momentum", "[contact][rigid]")
{
    const std::string egg = R"({"type": "ellipsoid", "semi_axes": [0.3, 0.25, 0.2]})",
                      shape = R"({"ellipsoid": [0.3, 0.25, 0.2]})";
    const double h = 2e-3;
    Run r(model(body("a", 1, shape, Vec3(-0.4, 0, 0), Vec3(1, 0.2, 0.1), Vec3(1, -2, 0.5)) + ", " +
                    body("b", 2, shape, Vec3(0.4, 0.1, 0), Vec3(-1, 0.2, 0.1), Vec3(-0.5, 1, 2)),
                contact_of("a", "b", egg, egg, 0.5, 0.3), Vec3::Zero()),
          h);
    r.step();
    const auto [first, second] = momenta(r, h);
    const Vec3 P = first, L = second;
    const double before = r.energy();
    long touching = 0;
    r.to(0.6, [&](const State& x) {
        for (const lie::ConeForce& f : x.cone_forces) touching += f.F.norm() > 0;
        const auto [P_n, L_n] = momenta(r, h);
        CHECK((P_n - P).norm() < 1e-13);
        // The force acts at one point of both bodies. The step is iterated to about 1e-10.
        CHECK((L_n - L).norm() < 1e-9);
    });
    CHECK(touching > 0);
    CHECK(r.energy() < 0.9 * before);
}

TEST_CASE("a row of balls without friction keeps its momentum and never gains energy", "[contact][rigid]")
{
    for (const double e : {0., 0.5, 1.}) {
        std::vector<std::string> bodies, contacts;
        for (int b = 0; b < 5; ++b) {
            bodies.push_back(body("b" + std::to_string(b), 1, ball_shape(0.1),
                                  Vec3(0.2 * b - (b == 0 ? 0.0205 : 0), 0, 0), Vec3(b == 0 ? 1 : 0, 0, 0)));
            if (b > 0)
                contacts.push_back(contact_of("b" + std::to_string(b - 1), "b" + std::to_string(b),
                                              ball_surface(0.1), ball_surface(0.1), 0, e));
        }
        Run r(model(joined(bodies), joined(contacts), Vec3::Zero()), 1e-3);
        double energy = r.energy();
        r.to(0.1, [&](const State&) {
            CHECK(r.energy() <= energy * (1 + 1e-10));
            energy = r.energy();
        });
        CHECK((momenta(r, 1e-3).first - Vec3(1, 0, 0)).norm() < 1e-12);
        if (e < 1)
            CHECK(energy < 0.4);
        else
            CHECK(energy == Approx(0.5).epsilon(1e-9));
    }
}

}  // namespace rigid_tests
