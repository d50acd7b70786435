// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/soft_friction.hpp"

#include "contact/compliant/manifold_force.hpp"
#include "contact/evolving/contact.hpp"
#include "contact/friction/laws/spring.hpp"
#include "contact/friction/tracked_force.hpp"
#include "dae/model.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace hilda::contact {

namespace {

constexpr double largest_lag = 0.05;    // [rad]
constexpr double smallest_slip = 1e-6;  // [m/s]; a slower contact sticks
constexpr double rolls = 5e-3;  // a contact with less slip, relative to the velocities of its surfaces, rolls

/// The warning, or an empty text if the spring is stiff enough
std::string warning(const std::string& name, const ContactPoint& at, const Motion& bi, const Motion& bj,
                    double bound, double K_E)
{
    const Vec3 C = at.C(), v = dae::velocity_at(bi, C - bi.r) - dae::velocity_at(bj, C - bj.r);
    const double slip = (v - at.n * at.n.dot(v)).norm(),
                 omega_n = at.n.dot(bi.A * bi.omega_bar - bj.A * bj.omega_bar),
                 lag = friction_lag(omega_n, bound, K_E, slip);
    const double surfaces =
        std::max(bi.omega_bar.norm() * (C - bi.r).norm(), bj.omega_bar.norm() * (C - bj.r).norm());
    if (!(lag > largest_lag) || slip < rolls * surfaces) return {};
    std::ostringstream what;
    what.precision(3);
    what << "contact '" << name << "': the friction spring is too soft for a spin of " << std::abs(omega_n)
         << " rad/s: its deflection mu N/K_E = " << bound / K_E << " m turns with "
         << std::abs(omega_n) * bound / K_E << " m/s, " << lag
         << " of the slip velocity; K_E should be above " << K_E * lag / largest_lag << " N/m";
    return what.str();
}

}  // namespace

double friction_lag(double omega_n, double bound, double K_E, double slip)
{
    return slip > smallest_slip ? std::abs(omega_n) * bound / (K_E * slip) : 0;
}

std::vector<std::string> soft_friction_warnings(const dae::Model& model, const lie::State& x)
{
    std::vector<std::string> all;
    const auto add = [&](std::string what) {
        if (!what.empty()) all.push_back(std::move(what));
    };
    std::vector<LoadedPoint> points;
    model.for_forces(x, [&](const dae::Force& force, int) {
        if (const auto* several = dynamic_cast<const ManifoldForce*>(&force)) {
            const auto* law = dynamic_cast<const SlidingFriction*>(several->contact.friction.get());
            if (law == nullptr) return;
            several->points(x, points);
            double N = 0;
            for (const LoadedPoint& p : points) N += p.N;
            const auto most =
                std::max_element(points.begin(), points.end(),
                                 [](const LoadedPoint& a, const LoadedPoint& b) { return a.N < b.N; });
            if (most != points.end())
                add(warning(several->name, most->at, dae::motion(x, several->i), dae::motion(x, several->j),
                            law->p.mu_k * N, law->p.K_E));
            return;
        }
        const auto* f = dynamic_cast<const TrackedForce*>(&force);
        if (f == nullptr || !f->is_active(x)) return;
        const auto* law = dynamic_cast<const SlidingFriction*>(&f->law());
        if (law == nullptr) return;
        const ContactState now = f->at(x).contact_state;
        if (!(now.N > 0)) return;
        add(warning(f->name, now.contact_point, dae::motion(x, f->i), dae::motion(x, f->j),
                    law->p.mu_k * now.N, law->springs(now).K_slide));
    });
    for (const auto& constraint : model.general_constraints()) {
        const auto* c = dynamic_cast<const EvolvingContact*>(constraint.get());
        if (c == nullptr || !c->is_regularised() || dae::Model::inactive(*c, x)) continue;
        const auto at = model.arguments(*c, x);
        add(warning(c->name, c->contact_point(at), at.bi, at.bj,
                    c->law.mu_k * std::max(0., c->multipliers(at, x.lambda).F_N), c->law.K_E));
    }
    return all;
}

}  // namespace hilda::contact
