// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/experiments/chapter8/contact_scenes.hpp"

#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"

namespace hilda::studies {

namespace {

using contact::BodyType;
using contact::Inertia;
using contact::Shape;
using lie::Mat3;
using lie::Motion;
using lie::Vec3;

void check(const char* where, int balls, double R, double m)
{
    if (balls < 1) lie::reject(where, "there must be a ball", balls);
    if (!(R > 0) || !std::isfinite(R)) lie::reject(where, "a radius must be positive", R);
    if (!(m > 0) || !std::isfinite(m)) lie::reject(where, "a mass must be positive", m);
}

BodyType ball(double m, double R)
{
    return {.inertia = {m, 0.4 * m * R * R * Mat3::Identity()},
            .shape = {std::make_shared<contact::Sphere>(R)},
            .reach = R};
}

BodyType fixed(const Shape& shape)
{
    BodyType k;
    k.shape = shape;
    return k;
}

}  // namespace

ContactScene scene(const Pile& pile)
{
    const double R = pile.R;
    check("studies::Pile", pile.balls, R, pile.m);
    // Balls at half density fill a third of 2π/3 · 4 · 3 · 2 s³; and the sharpest curvature of the bowl is 1/s.
    const double s = R * std::max(1.5, std::cbrt(0.5 * pile.balls));
    const auto bowl = std::make_shared<contact::Ellipsoid>(s * Vec3(4, 3, 2), true);

    ContactScene of;
    of.R = R;
    of.m = pile.m;
    of.kind = {fixed({bowl}), ball(pile.m, R)};
    enum { in_bowl, a_ball };
    of.interaction = {{"ball-bowl", a_ball, in_bowl, pile.mu}, {"ball-ball", a_ball, a_ball, pile.mu}};
    of.body.push_back({in_bowl, {}});

    // Layers of squares, each over the gaps of the one below, a little apart
    constexpr double apart = 1.02;
    const double pitch = 2.1 * R * apart, rise = std::sqrt(4 * R * R * apart * apart - 0.5 * pitch * pitch);
    const auto has_room = [&](const Vec3& c) {
        return bowl->value(c) < 0 && (bowl->project(c) - c).norm() > apart * R;
    };
    int missing = pile.balls;
    for (int layer = 0; missing > 0; ++layer) {
        const double z = -2 * s + R + layer * rise, shift = layer % 2 == 0 ? 0 : 0.5;
        const int columns = static_cast<int>(std::ceil(4 * s / pitch));
        for (int y = -columns; y <= columns; ++y)
            for (int x = -columns; x <= columns && missing > 0; ++x) {
                const Vec3 c((x + shift) * pitch, (y + shift) * pitch, z);
                if (!has_room(c)) continue;
                Motion start;
                start.r = c;
                of.body.push_back({a_ball, start});
                --missing;
            }
    }
    return of;
}

double RollingChain::push() const
{
    const double c = mu_between * R / rho();
    double P = 0;
    for (int k = 0; k < balls; ++k) P = (m * 9.81 * std::sin(slope) + (1 + c) * P) / (1 - c);
    return P;
}

ContactScene scene(const RollingChain& chain)
{
    const double R = chain.R;
    check("studies::RollingChain", chain.balls, R, chain.m);
    ContactScene of;
    of.R = R;
    of.m = chain.m;
    of.gravity = 9.81 * Vec3(-std::sin(chain.slope), 0, -std::cos(chain.slope));
    enum { left, right, rolling, pushing };
    const auto wall = [](double angle) {
        return fixed({std::make_shared<contact::Plane>(), Vec3::Zero(), lie::exp(Vec3(angle, 0, 0))});
    };
    of.kind = {wall(RollingChain::wall), wall(-RollingChain::wall), ball(chain.m, R)};
    of.interaction = {{"ball-left", rolling, left, chain.mu_wall},
                      {"ball-right", rolling, right, chain.mu_wall},
                      {"ball-ball", rolling, rolling, chain.mu_between}};
    of.body = {{left, {}}, {right, {}}};
    Motion start;
    start.r = {0, 0, R / std::cos(RollingChain::wall)};
    start.rdot = {chain.speed, 0, 0};
    start.omega_bar = {0, chain.speed / chain.rho(), 0};
    for (int b = 0; b < chain.balls; ++b) {
        of.body.push_back({rolling, start});
        start.r.x() += 2 * R;
    }
    if (chain.speed > 0) {
        BodyType k = ball(chain.m, R);
        k.inertia = {};
        of.kind.push_back(k);
        of.interaction.push_back({"push", rolling, pushing, chain.mu_between});
        start.r.x() = -2 * R;
        start.omega_bar.setZero();
        of.body.push_back({pushing, start});
    }
    return of;
}

std::vector<contact::Candidate> touching(const ContactScene& of, double gap)
{
    std::vector<Vec3> centre;
    std::vector<double> reach;
    for (const auto& b : of.body) {
        centre.push_back(b.start.r);
        reach.push_back(of.kind[b.kind].reach);
    }
    contact::BroadPhase cells;
    std::vector<contact::Candidate> out;
    for (const contact::Candidate& c : cells.find(centre, reach, gap)) {
        const auto &i = of.body[c.i], &j = of.body[c.j];
        bool meet = false;
        for (const auto& m : of.interaction)
            meet = meet || (m.kind_i == i.kind && m.kind_j == j.kind) ||
                   (m.kind_i == j.kind && m.kind_j == i.kind);
        if (!meet) continue;
        const auto detector = contact::make_detector(of.kind[i.kind].shape, of.kind[j.kind].shape);
        if (detector->detect(i.start, j.start, nullptr).gap < gap) out.push_back(c);
    }
    return out;
}

contact::DviScene rigid(const ContactScene& of)
{
    contact::DviScene scene;
    scene.gravity = of.gravity;
    scene.neighbors.margin = 0.2 * of.R;
    for (const BodyType& k : of.kind) scene.add(k);
    for (const auto& m : of.interaction) scene.between(m.name, m.kind_i, m.kind_j, {.mu = m.mu});
    for (const auto& b : of.body) scene.enter(b.kind, b.start);
    return scene;
}

contact::Scene compliant(const ContactScene& of, const Compliance& how)
{
    contact::Scene scene;
    scene.gravity = of.gravity;
    for (const BodyType& k : of.kind) scene.add(k);
    const auto law =
        std::make_shared<contact::Hooke>(contact::Hooke::rebounding(how.stiffness, how.restitution, of.m));
    for (const auto& m : of.interaction) {
        const auto friction = m.mu > 0 ? contact::friction_law("slide-roll-spin")
                                             .make({.mu_s = m.mu, .mu_k = m.mu, .K_E = how.stiffness})
                                       : contact::frictionless();
        scene.between(m.name, m.kind_i, m.kind_j, law, friction);
    }
    for (const auto& b : of.body) scene.enter(b.kind, b.start);
    return scene;
}

}  // namespace hilda::studies
