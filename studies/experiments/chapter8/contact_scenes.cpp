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
    if (balls < 1) lie::reject(where, "the number of balls must be at least 1", balls);
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
    // Balls at half density fill a third of the volume 2π/3 · 4 · 3 · 2 s³ of the bowl; its largest curvature
    // is 1/s.
    const double s = R * std::max(1.5, std::cbrt(0.5 * pile.balls));
    const auto bowl = std::make_shared<contact::Ellipsoid>(s * Vec3(4, 3, 2), true);

    ContactScene setup;
    setup.R = R;
    setup.m = pile.m;
    setup.body_types = {fixed({bowl}), ball(pile.m, R)};
    enum { in_bowl, a_ball };
    setup.interaction = {{"ball-bowl", a_ball, in_bowl, pile.mu}, {"ball-ball", a_ball, a_ball, pile.mu}};
    setup.body.push_back({in_bowl, {}});

    // Square layers, each above the gaps of the layer below, with a small clearance
    constexpr double spacing = 1.02;
    const double pitch = 2.1 * R * spacing,
                 rise = std::sqrt(4 * R * R * spacing * spacing - 0.5 * pitch * pitch);
    const auto has_room = [&](const Vec3& c) {
        return bowl->value(c) < 0 && (bowl->project(c) - c).norm() > spacing * R;
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
                setup.body.push_back({a_ball, start});
                --missing;
            }
    }
    return setup;
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
    ContactScene setup;
    setup.R = R;
    setup.m = chain.m;
    setup.gravity = 9.81 * Vec3(-std::sin(chain.slope), 0, -std::cos(chain.slope));
    enum { left, right, rolling, pushing };
    const auto wall = [](double angle) {
        return fixed({std::make_shared<contact::Plane>(), Vec3::Zero(), lie::exp(Vec3(angle, 0, 0))});
    };
    setup.body_types = {wall(RollingChain::wall), wall(-RollingChain::wall), ball(chain.m, R)};
    setup.interaction = {{"ball-left", rolling, left, chain.mu_wall},
                         {"ball-right", rolling, right, chain.mu_wall},
                         {"ball-ball", rolling, rolling, chain.mu_between}};
    setup.body = {{left, {}}, {right, {}}};
    Motion start;
    start.r = {0, 0, R / std::cos(RollingChain::wall)};
    start.rdot = {chain.speed, 0, 0};
    start.omega_bar = {0, chain.speed / chain.rho(), 0};
    for (int b = 0; b < chain.balls; ++b) {
        setup.body.push_back({rolling, start});
        start.r.x() += 2 * R;
    }
    if (chain.speed > 0) {
        BodyType k = ball(chain.m, R);
        k.inertia = {};
        setup.body_types.push_back(k);
        setup.interaction.push_back({"push", rolling, pushing, chain.mu_between});
        start.r.x() = -2 * R;
        start.omega_bar.setZero();
        setup.body.push_back({pushing, start});
    }
    return setup;
}

std::vector<contact::Candidate> contact_pairs(const ContactScene& setup, double gap)
{
    std::vector<Vec3> centre;
    std::vector<double> reach;
    for (const auto& b : setup.body) {
        centre.push_back(b.start.r);
        reach.push_back(setup.body_types[b.type].reach);
    }
    contact::BroadPhase cells;
    std::vector<contact::Candidate> out;
    for (const contact::Candidate& c : cells.find(centre, reach, gap)) {
        const auto &i = setup.body[c.i], &j = setup.body[c.j];
        bool interacts = false;
        for (const auto& m : setup.interaction)
            interacts = interacts || (m.type_i == i.type && m.type_j == j.type) ||
                        (m.type_i == j.type && m.type_j == i.type);
        if (!interacts) continue;
        const auto detector =
            contact::make_detector(setup.body_types[i.type].shape, setup.body_types[j.type].shape);
        if (detector->detect(i.start, j.start, nullptr).gap < gap) out.push_back(c);
    }
    return out;
}

contact::Scene compliant(const ContactScene& setup, const Compliance& compliance)
{
    contact::Scene scene;
    scene.gravity = setup.gravity;
    for (const BodyType& k : setup.body_types) scene.add(k);
    const auto law = std::make_shared<contact::Hooke>(
        contact::Hooke::with_restitution(compliance.stiffness, compliance.restitution, setup.m));
    for (const auto& m : setup.interaction) {
        const auto friction = m.mu > 0 ? contact::friction_law("slide-roll-spin")
                                             .make({.mu_s = m.mu, .mu_k = m.mu, .K_E = compliance.stiffness})
                                       : contact::frictionless();
        scene.set_contact_law(m.name, m.type_i, m.type_j, law, friction);
    }
    for (const auto& b : setup.body) scene.add_body(b.type, b.start);
    return scene;
}

}  // namespace hilda::studies
