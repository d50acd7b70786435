// SPDX-License-Identifier: GPL-3.0-or-later
// The part of UnilateralStep that is an impact.
#include "contact/evolving/unilateral.hpp"
#include "dae/start.hpp"

#include <algorithm>

namespace hilda::contact {

using lie::State;

/// The velocities of x jump where contact c meets, h being the length of a whole step.
void UnilateralStep::collide(State& x, TrackedContact& c, double h)
{
    const Unilateral& how = c.contact->unilateral;
    const double approach = std::max(0., -separation_speed(c, x));
    if (++c.closings == most_meetings) c.held = true;
    dae::Model::set_mode(*c.contact, x, dae::Constraint::active);
    if (!determined(c, x)) {
        hand_over(c, x, approach);
        restart(x);
        return;
    }
    dae::project_positions(model, K, x);
    before = x;
    const size_t told = happened.size();
    jump(x, nullptr, 0);  // compression
    const double compression = force(c, x, x.lambda);
    dae::solve_accelerations(model, K, x);
    const double F_N = force(c, x, x.lambda);

    // Free of c, the gap would have the acceleration -F_N/m with m = compression/approach.
    double& rebounded = x.internal_state[c.contact->first_internal_state + EvolvingContact::rebounded];
    const double rebound = c.held || x.t - rebounded < h ? 0 : how.restitution * approach;
    const bool flies = rebound > 0 && 2 * rebound * compression > h * approach * F_N;
    if (flies) {
        if (how.impact == Unilateral::Impact::newton) {
            x = before;
            happened.resize(told);
            jump(x, &c, rebound);
        }
        dae::Model::set_mode(*c.contact, x, dae::Constraint::inactive);
        if (how.impact == Unilateral::Impact::poisson) {
            before = x;
            push(c, how.restitution * compression, before);
            jump(x, nullptr, 0);
        }
    }
    happened.insert(happened.begin() + static_cast<std::ptrdiff_t>(told),
                    {.type = flies ? ContactEvent::Type::impact : ContactEvent::Type::closing,
                     .t = x.t,
                     .contact = c.number,
                     .speed = approach});
    c.last = c.before = {};
    if (flies) rebounded = x.t;
    restart(x);
}

/// Whether the force of c is determined together with those of all that is closed
bool UnilateralStep::determined(const TrackedContact& c, State& x)
{
    constexpr double singular = 1e-11;  // reciprocal condition of the scaled K
    double condition = 0;
    try {
        K.assemble(x);
        condition = K.reciprocal_condition();
    } catch (const lie::SingularMatrix&) {
    }
    if (condition > singular) return true;
    if (!c.contact->has_fallback())
        throw lie::NumericalFailure("contact_rank",
                                    "contact '" + c.contact->name +
                                        "' presses where other constraints hold already, so that its "
                                        "force is not determined");
    return false;
}

/// An impulse along the normal, which the next jump takes with it
void UnilateralStep::push(const TrackedContact& c, double impulse, const State& x)
{
    const dae::Constraint::At at = model.at(*c.contact, x);
    const ContactPoint contact_point = c.contact->contact_point(at);
    const auto add = [&](int body, const lie::Motion& motion, const Vec3& C, double sign) {
        if (body == dae::ground) return;
        const Vec3 P = sign * impulse * contact_point.n;
        momentum.segment<3>(6 * body) += P;
        momentum.segment<3>(6 * body + 3) += motion.A.transpose() * (C - motion.r).cross(P);
    };
    add(c.contact->i, at.bi, contact_point.C_i, 1);
    add(c.contact->j, at.bj, contact_point.C_j, -1);
}

/// The velocities of x jump so that all closed contacts and other constraints hold them, but for the one that rebounds,
/// which separates at this speed. Contacts that would have to pull are opened. x.lambda are the impulses.
void UnilateralStep::jump(State& x, const TrackedContact* rebounding, double speed)
{
    for (TrackedContact* pulling = nullptr;; pulling = nullptr) {
        K.assemble(x);
        v.setZero();
        for (int b = 0; b < model.bodies(); ++b)
            v.segment<6>(6 * b) << model.mass().m[b] * x.body[b].rdot,
                model.mass().J_bar[b] * x.body[b].omega_bar;
        v.head(momentum.size()) += momentum;
        model.nu(x, K.constraint_part(v));
        if (rebounding != nullptr)
            K.constraint_part(v).segment<3>(rebounding->contact->first_row) +=
                speed * rebounding->contact->contact_point(model.at(*rebounding->contact, x)).n;
        K.solve_refined(v);
        x.lambda = K.constraint_part(v);
        double largest = 0, least = 0;
        for (TrackedContact& c : contact) {
            if (!closed(c, x)) continue;
            const double P = force(c, x, x.lambda);
            largest = std::max(largest, std::abs(P));
            if (&c != rebounding && c.contact->unilateral.enabled && !c.held && P < least)
                least = P, pulling = &c;
        }
        if (pulling == nullptr || least > -rounding * largest) break;
        dae::Model::set_mode(*pulling->contact, x, dae::Constraint::inactive);
        happened.push_back(
            {.type = ContactEvent::Type::lift_off, .t = x.t, .contact = pulling->number, .speed = 0});
    }
    for (int b = 0; b < model.bodies(); ++b) {
        x.body[b].rdot = v.segment<3>(6 * b);
        x.body[b].omega_bar = v.segment<3>(6 * b + 3);
    }
    momentum.setZero();
}

}  // namespace hilda::contact
