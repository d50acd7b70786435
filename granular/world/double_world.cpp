// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/world/double_world.hpp"

namespace hilda::granular {

void DoubleWorld::find_loads(double lag)
{
    const int n = static_cast<int>(particle.size());
    F.assign(n, {0, 0, 0}), T.assign(n, {0, 0, 0});
    const auto inverse = [](const Particle& p) { return p.fixed ? 0 : 1 / p.mass; };
    const auto add_contact = [&](int i, int j, ContactPoint<double>& t) {
        if (!(t.delta > 0)) {
            history.erase({i, j});
            return;
        }
        t.h = options.h;
        History<double>& state =
            history.try_emplace({i, j}, History<double>{{0, 0, 0}, 0, {0, 0, 0}, 0, false}).first->second;
        state.age += t.h;
        const ContactForce<double> out = evaluate(law, t, state, law.resists_rotation());
        const Vec3 M = friction_torque(law, t, out.F_t).M;
        F[i] += out.F, T[i] += t.R_i * M + out.T;
        if (j >= 0) F[j] -= out.F, T[j] += t.R_j * M - out.T;
    };
    for (int i = 0; i < n; ++i) {
        const Particle& p = particle[i];
        ContactPoint<double> t{};
        for (int j = i + 1; j < n; ++j) {
            const Particle& q = particle[j];
            const Vec3 d = p.r - q.r;
            const double distance = d.norm();
            t.R_i = p.radius, t.R_j = q.radius, t.n = (1 / distance) * d;
            set_masses(t, inverse(p), inverse(q));
            t.delta = p.radius + q.radius - distance;
            set_rates(t, {p.v - q.v, p.omega, q.omega}, law.lever, lag / distance, law.resists_rotation());
            add_contact(i, j, t);
        }
        for (int b = 0; b < static_cast<int>(boundary.size()); ++b) {
            const Nearest near = nearest(boundary[b], p.r);
            t.R_i = p.radius, t.R_j = 0, t.n = near.n;
            t.R_eff = effective_radius(boundary[b], p.radius, near);
            t.m_eff = 1 / (inverse(p) + boundary[b].inverse_mass());
            t.delta = p.radius - near.distance;
            set_rates(t,
                      boundary_velocities({.boundary = boundary.data()}, static_cast<std::uint32_t>(b), p.r,
                                          near, p.v, p.omega, p.radius, lag),
                      law.lever);
            if (!p.fixed) add_contact(i, -1 - b, t);
        }
    }
}

void DoubleWorld::step(long count)
{
    const auto n = particle.size();
    const Scheme scheme = options.scheme;
    if (a.size() != n) a.assign(n, {0, 0, 0}), alpha.assign(n, {0, 0, 0});
    const bool verlet = scheme == Scheme::velocity_verlet;
    const double lag = velocity_lag(scheme) * options.h;
    const auto advance_all = [&](Part part) {
        for (std::size_t k = 0; k < n; ++k) {
            Particle& p = particle[k];
            if (p.fixed) continue;
            Vec3 acc = a[k], turn = alpha[k];
            if (part != Part::before_loads) {
                acc = (1 / p.mass) * F[k] + options.gravity;
                turn = (turns ? 2.5 / (p.mass * p.radius * p.radius) : 0) * T[k];
            }
            if (part != Part::only_loads) {
                const Increment<double> translation = increment(scheme, part, p.v, acc, a[k], options.h),
                                        rotation =
                                            increment(scheme, part, p.omega, turn, alpha[k], options.h);
                p.r += translation.dx, p.v += translation.dv, p.omega += rotation.dv;
                const auto d = rotation_increment<double>(rotation.dx, {p.e[0], {p.e[1], p.e[2], p.e[3]}});
                p.e[0] += d.e0, p.e[1] += d.e.x, p.e[2] += d.e.y, p.e[3] += d.e.z;
            }
            a[k] = acc, alpha[k] = turn;
        }
    };
    const auto move_boundaries = [&] {
        for (Boundary& b : boundary) b.r += options.h * b.v;
    };
    for (; count > 0; --count, ++step_count) {
        if (step_count == 0 || !verlet) find_loads(verlet ? 0 : lag);
        if (step_count == 0) advance_all(Part::only_loads);
        if (verlet) {
            advance_all(Part::before_loads);
            move_boundaries();
            find_loads(lag);
            advance_all(Part::after_loads);
        } else {
            advance_all(Part::whole);
            move_boundaries();
        }
    }
}

}  // namespace hilda::granular
