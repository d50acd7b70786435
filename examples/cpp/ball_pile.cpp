// SPDX-License-Identifier: GPL-3.0-or-later
/// Four rigid balls with friction: three on a floor, one on top of them. contact::RigidContacts finds the
/// contacts of the balls, and the scheme rA-moreau-1 solves for the impulses of each step; no stiffness is
/// needed.
///
/// With α the angle between the vertical and a line of centres, balance of one lower ball gives the friction
/// between the balls F = N tan(α/2), so the pile is in equilibrium only for μ >= tan(α/2); balance of the top
/// ball gives N = W/3.

#include "contact/rigid/rigid_contacts.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"
#include "dae/model.hpp"
#include "dae/start.hpp"
#include "lie/schemes.hpp"
#include "run/simulation.hpp"

#include <cmath>
#include <cstdio>
#include <numbers>

using namespace hilda;
using lie::Vec3;

namespace {

constexpr double R = 0.1, m = 1, W = m * 9.81;
constexpr double apart = 2.1 * R;  // distance of the lower centres: these balls do not touch each other [m]
const double sine = apart / std::sqrt(3.) / (2 * R);  // of α

/// Adds the bodies 0 to 2, the lower balls, and 3, the top ball, with their contacts. Returns the state at
/// rest.
lie::State build(dae::Model& model, double mu)
{
    lie::State x;
    for (int k = 0; k < 4; ++k) {
        model.add({"ball " + std::to_string(k), m, 0.4 * m * R * R * lie::Mat3::Identity()});
        const double angle = 2 * std::numbers::pi * k / 3;
        lie::Motion at;
        at.r = k < 3 ? Vec3(2 * R * sine * std::cos(angle), 2 * R * sine * std::sin(angle), R)
                     : Vec3(0, 0, R + 2 * R * std::sqrt(1 - sine * sine));
        x.body.push_back(at);
    }
    const contact::Shape sphere{std::make_shared<contact::Sphere>(R)},
        plane{std::make_shared<contact::Plane>()};  // through the origin, normal z

    // A group has many pairs of bodies. The shape of the first and that of the second body of all pairs are
    // given in the body frames. Only pairs that are close to each other are examined.
    contact::ContactPairs on_floor, on_each_other;
    on_floor.first = {0, 1, 2, 3}, on_floor.second = {dae::ground};
    on_each_other.first = on_each_other.second = {0, 1, 2, 3};
    on_each_other.each_two = true;
    for (contact::ContactPairs* pairs : {&on_floor, &on_each_other}) {
        pairs->is_group = true;
        pairs->index();
    }
    // Coefficients of friction: static, kinetic. The coefficient of restitution is 0.
    model.contact(std::make_unique<contact::RigidContacts>("ball-floor", model, on_floor, sphere, plane,
                                                           contact::RigidLaw{.mu_s = 0.6, .mu_k = 0.6}));
    model.contact(std::make_unique<contact::RigidContacts>("ball-ball", model, on_each_other, sphere, sphere,
                                                           contact::RigidLaw{.mu_s = mu, .mu_k = mu}));
    dae::start(model, x);
    return x;
}

/// Compares the normal forces of all touching pairs with statics. Returns whether they agree.
bool check_forces(const dae::Model& model, const lie::State& x)
{
    bool agree = true;
    int touching = 0;
    std::vector<contact::LoadedPoint> points;
    for (const auto& element : model.rigid_contacts()) {
        const auto& contacts = dynamic_cast<const contact::RigidContacts&>(*element);
        // Pairs that may touch within a step have a force, which may be zero.
        contacts.for_touching_pairs(x, [&](int pair) {
            contacts.points(x, pair, points);  // one point for two balls, up to eight for bodies with edges
            const double N = points.empty() ? 0 : points[0].N;
            if (!(N > 1e-6 * W)) return;
            const double exact = contacts.pairs().pair(pair).second == dae::ground ? W + W / 3 : W / 3;
            std::printf("  %s: normal force %.4f N, by statics %.4f N\n", contacts.name_of_pair(pair).c_str(),
                        N, exact);
            agree = agree && std::abs(N - exact) < 1e-3 * W;
            ++touching;
        });
    }
    return agree && touching == 6;
}

}  // namespace

int main()
{
    const double limit = std::tan(0.5 * std::asin(sine));
    std::printf("the pile is in equilibrium for mu >= %.4f\n", limit);
    bool passed = true;
    for (const double mu : {0.4, 0.25}) {
        dae::Model model;  // with gravity (0, 0, -9.81)
        const lie::State start = build(model, mu);
        run::Simulation simulation({.model = model,
                                    .start = start,
                                    .scheme = lie::scheme("rA-moreau-1"),
                                    .grid = lie::TimeGrid::over(0.5, 1e-3)});
        const run::Outcome outcome = simulation.run();
        if (outcome.failed()) {
            std::printf("FAILED: %s: %s\n", outcome.status.c_str(), outcome.message.c_str());
            return 1;
        }
        const lie::State& end = simulation.state();
        const double fall = start.body[3].r.z() - end.body[3].r.z();
        std::printf("mu = %.2f: the top ball has moved down by %.1e m\n", mu, fall);
        passed = passed && (mu > limit ? std::abs(fall) < 1e-6 : fall > 0.1 * R);
        if (mu > limit) passed = check_forces(model, end) && passed;
    }
    if (!passed) std::printf("FAILED: the pile does not behave as statics says\n");
    return passed ? 0 : 1;
}
