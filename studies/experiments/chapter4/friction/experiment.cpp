// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/experiments/chapter4/friction/experiment.hpp"

#include "contact/surfaces/plane.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::studies::friction {

namespace {

bool is_at_a_time(const std::vector<double>& times, long n, double h)
{
    return std::any_of(times.begin(), times.end(), [&](double t) { return std::lround(t / h) == n; });
}

}  // namespace

void add_frame(run::Snapshots& to, const contact::Scene& scene, const std::vector<contact::Motion>& bodies)
{
    std::vector<run::Snapshots::ContactData> contacts;
    for (size_t k = 0; k < scene.pair.size(); ++k) {
        const contact::Scene::Pair& p = scene.pair[k];
        if (p.contact_state.N > 0)
            contacts.push_back(run::Snapshots::contact_data(static_cast<int>(k), p.i, p.contact_state,
                                                            p.wrench, p.history.deflections));
    }
    to.add(scene.t, bodies, std::move(contacts));
}

Curve simulate(const BodyOnPlane& setup, std::span<Frames> frames)
{
    contact::Scene scene;
    scene.gravity = setup.gravity;
    const int body = scene.add(setup.inertia, setup.start),
              plane = scene.add(contact::Inertia{}, setup.plane);
    scene.add(setup.name, body, setup.shape, plane, shape<contact::Plane>(), setup.normal,
              contact::friction_law(setup.friction_law).make(setup.friction));
    if (!setup.above_stability_limit) scene.check(setup.h);
    Curve curve(setup.columns);
    const long steps = std::lround(setup.end / setup.h);
    std::vector<run::EvenSelection> selections;
    for (Frames& of : frames) {
        selections.emplace_back(of.count, steps);
        of.snapshots.add_surface(body, scene.pair[0].contact.i);
        of.snapshots.add_surface(plane, scene.pair[0].contact.j);
    }
    std::vector<contact::Motion> before;
    for (long n = 0; n <= steps; ++n) {
        const double t = scene.t = static_cast<double>(n) * setup.h;
        before = scene.body;
        scene.step(setup.h);
        scene.t = t;
        setup.record(curve, Node{.scene = scene, .body = before[body], .pair = scene.pair[0]});
        for (size_t k = 0; k < frames.size(); ++k) {
            const bool is_even = selections[k].is_selected(n);
            if (is_even || is_at_a_time(frames[k].times, n, setup.h))
                add_frame(frames[k].snapshots, scene, before);
        }
    }
    return curve;
}

Measure last(const std::string& column)
{
    return [=](const Curve& curve) { return curve.last(column); };
}

Measure count(const std::string& column)
{
    return [=](const Curve& curve) {
        double rows = 0;
        for (size_t k = 0; k < curve.rows(); ++k) rows += curve.at(k, column) == 1;
        return rows;
    };
}

Measure last_rate(const std::string& column, double h)
{
    return [=](const Curve& curve) { return (curve.last(column) - curve.at(curve.rows() - 2, column)) / h; };
}

Measure first(const std::string& column, bool (*condition)(double), double from)
{
    return [=](const Curve& curve) {
        return curve.first_time([&](size_t k) { return condition(curve.at(k, column)); }, from);
    };
}

contact::FrictionParameters preset(const std::string& name, const contact::FrictionParameters& p)
{
    return name == "dissertation" ? p.as_in_dissertation() : p;
}

contact::Motion at(const lie::Vec3& r, const lie::Vec3& rdot)
{
    contact::Motion m;
    m.r = r;
    m.rdot = rdot;
    return m;
}

contact::Inertia solid_sphere(double m, double R) { return {m, 0.4 * m * R * R * lie::Mat3::Identity()}; }

}  // namespace hilda::studies::friction
