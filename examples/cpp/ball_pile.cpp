// SPDX-License-Identifier: GPL-3.0-or-later
/// Four rigid balls with friction: three on a floor, one on top of them. contact::DviScene finds the contacts
/// of free bodies by itself and solves for the impulses of each step; no stiffness is needed.
///
/// With α the angle between the vertical and a line of centres, balance of one lower ball gives the friction
/// between the balls F = N tan(α/2), so the pile is in equilibrium only for μ >= tan(α/2); balance of the top
/// ball gives N = W/3.

#include "contact/scenes/dvi/dvi_scene.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

using namespace hilda;
using lie::Vec3;

namespace {

constexpr double R = 0.1, m = 1, W = m * 9.81;
constexpr double apart = 2.1 * R;  // distance of the lower centres: these balls do not touch each other [m]
const double sine = apart / std::sqrt(3.) / (2 * R);  // of α

contact::DviScene pile(double mu)
{
    contact::DviScene scene;  // with gravity (0, 0, -9.81)
    // Pairs whose gap is below this are candidates for contact [m].
    scene.neighbors.margin = 0.2 * R;

    // Bodies have a type; contacts are defined between types. A type without mass is fixed. `reach` is the
    // radius of a sphere about the centre of mass that contains the body; without it, as for the floor, the
    // body is unbounded.
    contact::BodyType floor, ball;
    floor.shape = {std::make_shared<contact::Plane>()};  // through the origin of the body, normal z
    ball.inertia = {m, 0.4 * m * R * R * lie::Mat3::Identity()};
    ball.shape = {std::make_shared<contact::Sphere>(R)};
    ball.reach = R;
    const int of_floor = scene.add(floor), of_ball = scene.add(ball);
    scene.set_contact_law("ball-floor", of_ball, of_floor, {.mu = 0.6});
    scene.set_contact_law("ball-ball", of_ball, of_ball, {.mu = mu});

    // add_body() adds a body of a type and returns its number: the floor is 0, the lower balls are 1 to 3,
    // the top ball is 4.
    scene.add_body(of_floor, {});
    lie::Motion at;
    for (int k = 0; k < 3; ++k) {
        const double angle = 2 * std::numbers::pi * k / 3;
        at.r = {2 * R * sine * std::cos(angle), 2 * R * sine * std::sin(angle), R};
        scene.add_body(of_ball, at);
    }
    at.r = {0, 0, R + 2 * R * std::sqrt(1 - sine * sine)};
    scene.add_body(of_ball, at);
    return scene;
}

}  // namespace

int main()
{
    const double limit = std::tan(0.5 * std::asin(sine));
    std::printf("the pile is in equilibrium for mu >= %.4f\n", limit);
    bool passed = true;
    for (const double mu : {0.4, 0.25}) {
        contact::DviScene scene = pile(mu);
        const double top = scene.body[4].r.z();
        while (scene.t < 0.5) scene.step(1e-3);

        const double fall = top - scene.body[4].r.z();
        std::printf("mu = %.2f: the top ball has moved down by %.1e m\n", mu, fall);
        passed = passed && (mu > limit ? std::abs(fall) < 1e-4 : fall > 0.1 * R);
        if (mu < limit) continue;

        // The list has all candidates; pairs that do not touch have N = 0. N() is the normal component of the
        // force on body i.
        int touching = 0;
        for (const auto& pair : scene.neighbors.pair()) {
            const double N = pair.state.N();
            if (!(N > 1e-6 * W)) continue;
            const double exact = std::min(pair.i, pair.j) == 0 ? W + W / 3 : W / 3;
            std::printf("  bodies %d and %d: normal force %.4f N, by statics %.4f N\n", pair.i, pair.j, N,
                        exact);
            passed = passed && std::abs(N - exact) < 1e-3 * W;
            ++touching;
        }
        passed = passed && touching == 6;
    }
    if (!passed) std::printf("FAILED: the pile does not behave as statics says\n");
    return passed ? 0 : 1;
}
