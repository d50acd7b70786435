// SPDX-License-Identifier: GPL-3.0-or-later
// Impacts of UnilateralStep: compression, restitution, closing.
#include "contact/evolving/unilateral.hpp"
#include "dae/model.hpp"
#include "lie/steps/accelerations.hpp"
#include "lie/steps/projection.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::contact {

using lie::State;

/// Impact of contact c in x: computes the velocity jump and decides between rebound and closing. h: the whole
/// step.
void UnilateralStep::resolve_impact(State& x, TrackedContact& c, double h)
{
    const Unilateral& unilateral = c.contact->unilateral;
    const double approach = std::max(0., -separation_speed(c, x));
    if (++c.impacts == max_impacts) c.stays_active = true;
    dae::Model::set_mode(*c.contact, x, EvolvingContact::active);
    if (!force_is_determined(c, x)) {
        switch_to_fallback(c, x, approach);
        restart(x);
        return;
    }
    lie::project_positions(model, K, x);
    before_impact = x;
    const size_t events_before = event_log.size();
    solve_velocity_jump(x, nullptr, 0);  // compression: all active constraints hold
    const EvolvingContact::Multipliers compressed = impulse(c, x);
    const double compression = compressed.F_N;
    lie::solve_accelerations(model, K, x);
    const double F_N = force(c, x, x.lambda);

    // Without c the gap would have the acceleration -F_N/m with the effective mass m = compression/approach.
    // The contact separates if the time of flight 2 m rebound/F_N is longer than a step.
    const auto node_state = [&] {
        return x.internal_state.data() + dae::Model::place(*c.contact).internal_state;
    };
    auto state = restored<EvolvingContact::NodeState>(node_state());
    const double rebound =
        c.stays_active || x.t - state.last_rebound < h ? 0 : unilateral.restitution * approach;
    const bool separates = rebound > 0 && 2 * rebound * compression > h * approach * F_N;
    if (separates) {
        const bool newton = unilateral.impact == Unilateral::Impact::newton;
        const auto rebound_with = [&](double speed) {
            x = before_impact;
            event_log.resize(events_before);
            solve_velocity_jump(x, &c, speed);
        };
        if (c.contact->friction == EvolvingContact::Friction::rolling) {
            rebound_with(rebound);
            const double speed = rolling_rebound(c, compressed, impulse(c, x), rebound);
            if (speed != rebound) rebound_with(speed);
        } else if (newton) {
            rebound_with(rebound);
        }
        dae::Model::set_mode(*c.contact, x, EvolvingContact::inactive);
        if (!newton && c.contact->friction != EvolvingContact::Friction::rolling) {
            before_impact = x;
            add_impulse(c, unilateral.restitution * compression, before_impact);
            solve_velocity_jump(x, nullptr, 0);
        }
    }
    event_log.insert(event_log.begin() + static_cast<std::ptrdiff_t>(events_before),
                     {.type = separates ? ContactEvent::Type::impact : ContactEvent::Type::closing,
                      .t = x.t,
                      .contact = c.number,
                      .speed = approach});
    c.last_node = c.previous_node = {};
    if (separates) {
        state.last_rebound = x.t;
        save(state, node_state());
    }
    restart(x);
}

/// Impulses of contact c in the last velocity jump [N s]
EvolvingContact::Multipliers UnilateralStep::impulse(const TrackedContact& c, const State& x) const
{
    return c.contact->multipliers(model.arguments(*c.contact, x), x.lambda);
}

/// Speed of separation [m/s] after an impact of a contact with ideal rolling. `compressed` and `rebounded`
/// are its impulses without rebound and with the speed `rebound`.
///
/// The slip is zero after the impact, so that the normal impulse is P_c + q s for the speed s. The impulses
/// P_c and P_t do the work
///
///     ½ (q s² - P_c a + P_t · v_t)        a: approach speed, v_t: slip before the impact
///
/// Poisson's law has q s = e P_c and loses energy for e ≤ 1. Newton's law, s = e a, supplies energy if the
/// slip reduces P_c enough; s is then limited to the value without work.
double UnilateralStep::rolling_rebound(const TrackedContact& c,
                                       const EvolvingContact::Multipliers& compressed,
                                       const EvolvingContact::Multipliers& rebounded, double rebound) const
{
    const double q = (rebounded.F_N - compressed.F_N) / rebound;
    if (!(q > 0)) return rebound;
    if (c.contact->unilateral.impact == Unilateral::Impact::poisson)
        return c.contact->unilateral.restitution * compressed.F_N / q;
    const dae::Constraint::Arguments at = model.arguments(*c.contact, before_impact);
    const Vec3 C = c.contact->contact_point(at).C(),
               v = dae::velocity_at(at.bi, C - at.bi.r) - dae::velocity_at(at.bj, C - at.bj.r);
    const double lost = compressed.F_N * -separation_speed(c, before_impact) - compressed.friction.dot(v);
    return q * rebound * rebound > (1 + rounding) * lost ? std::sqrt(std::max(0., lost) / q) : rebound;
}

/// Whether the multiplier of c is determined together with those of all active constraints: the scaled K of x
/// is regular. Throws lie::NumericalFailure "contact_rank" if it is not and c has no fallback.
bool UnilateralStep::force_is_determined(const TrackedContact& c, State& x)
{
    constexpr double singular = 1e-11;  // reciprocal condition number of the scaled K
    double condition = 0;
    try {
        K.assemble(x);
        condition = K.reciprocal_condition();
    } catch (const lie::SingularMatrix&) {
    }
    if (condition > singular) return true;
    if (!c.contact->fallback)
        throw lie::NumericalFailure("contact_rank",
                                    "contact '" + c.contact->name +
                                        "': its normal force is not determined, because the other active "
                                        "constraints prevent the approach already; specify a fallback");
    return false;
}

/// Adds a normal impulse of contact c [N s] to `momentum`, which the next velocity jump applies.
void UnilateralStep::add_impulse(const TrackedContact& c, double impulse, const State& x)
{
    const dae::Constraint::Arguments at = model.arguments(*c.contact, x);
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

/// Velocity jump K (v⁺, P) = (M v⁻ + impulse, ν): all active contacts and the other constraints hold after
/// it; the contact `rebounding` separates with this speed [m/s]. Contacts with a negative normal impulse
/// become inactive, the most negative first, and the jump is computed again. The impulses P [N s] are left in
/// x.lambda. Regularised rows are inactive in K here, so implicit friction has no impulse; the rows of ideal
/// rolling have one.
void UnilateralStep::solve_velocity_jump(State& x, const TrackedContact* rebounding, double speed)
{
    for (TrackedContact* tensile = nullptr;; tensile = nullptr) {
        K.assemble(x);
        v.setZero();
        lie::set_momenta(model, x, v);
        v.head(momentum.size()) += momentum;
        model.nu(x, K.constraint_part(v));
        if (rebounding != nullptr)
            K.constraint_part(v).segment<3>(dae::Model::place(*rebounding->contact).row) +=
                speed * rebounding->contact->contact_point(model.arguments(*rebounding->contact, x)).n;
        K.solve_refined(v);
        x.lambda = K.constraint_part(v);
        double largest = 0, least = 0;
        for (TrackedContact& c : contact) {
            if (!is_active(c, x)) continue;
            const double P = force(c, x, x.lambda);
            largest = std::max(largest, std::abs(P));
            if (&c != rebounding && c.contact->unilateral.enabled && !c.stays_active && P < least)
                least = P, tensile = &c;
        }
        if (tensile == nullptr || least > -rounding * largest) break;
        dae::Model::set_mode(*tensile->contact, x, EvolvingContact::inactive);
        event_log.push_back(
            {.type = ContactEvent::Type::lift_off, .t = x.t, .contact = tensile->number, .speed = 0});
    }
    lie::set_velocities(x, v);
    momentum.setZero();
}

}  // namespace hilda::contact
