// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/evolving/friction.hpp"

#include "contact/internal_state.hpp"
#include "dae/model.hpp"
#include "lie/check.hpp"

#include <algorithm>

namespace hilda::contact {

namespace {

constexpr double min_interval = 1e-9;  // [s]; displacements over less time are rounding errors

}  // namespace

EvolvingFriction::EvolvingFriction(const dae::Model& model, const EvolvingContact& contact,
                                   std::shared_ptr<const FrictionModel> friction)
    : TrackedForce(contact.name, model, contact.i, contact.j), contact(contact),
      friction_pair(contact.name, contact.shape_i, contact.shape_j, inertia(model, contact.i),
                    inertia(model, contact.j), std::move(friction))
{
    if (contact.friction == EvolvingContact::Friction::rolling)
        lie::reject(label(), "a contact with ideal rolling cannot have another friction law", "one");
    if (contact.friction == EvolvingContact::Friction::implicit)
        lie::reject(label(), "friction must be either implicit or a force of the contact", "both");
}

ContactPoint EvolvingFriction::contact_point(const lie::State& x) const
{
    ContactPoint now = contact.contact_point(model.arguments(contact, x));
    now.gap = 0;  // nonzero only by rounding and during the iterations of a step
    return now;
}

bool EvolvingFriction::is_active(const lie::State& x) const { return !dae::Model::inactive(contact, x); }

double EvolvingFriction::normal_force(const lie::State& x) const { return is_active(x) ? last_step(x).N : 0; }

ContactState EvolvingFriction::evaluate(const lie::State& x, const ContactHistory& history) const
{
    return friction_pair.contact_state(contact_point(x), normal_force(x), motion(x, i), motion(x, j),
                                       history);
}

int EvolvingFriction::internal_states() const { return TrackedForce::internal_states() + reals<StepData>(); }

EvolvingFriction::StepData EvolvingFriction::last_step(const lie::State& x) const
{
    static_assert(reals<StepData>() == 2 + 3 * 2, "StepData must not have padding");
    return restored<StepData>(x.internal_state.data() + first_internal_state +
                              TrackedForce::internal_states());
}

void EvolvingFriction::save_step(const StepData& last, lie::State& x) const
{
    contact::save(last, x.internal_state.data() + first_internal_state + TrackedForce::internal_states());
}

void EvolvingFriction::update_internal_state(lie::State& x) const
{
    if (!is_active(x)) {
        x.discrete_state[first_discrete_state] = 0;
        std::fill_n(x.internal_state.begin() + first_internal_state, internal_states(), 0.);
        return;
    }
    StepData last{.N = contact.multipliers(model.arguments(contact, x), x.lambda).F_N};
    const bool continues = saved_history(x).touching;
    const double h = x.t - time_of_history(x);
    save_step(last, x);
    const Instant now = at(x);
    if (now.contact_state.N > 0) {
        const SlidingDisplacement& slip = now.contact_state.slip;
        const Rates mean =
            continues && h > min_interval ? mean_rates(slip, h) : TrackedForce::damper_rates(now, x);
        last.psi = mean.psi;
        last.s = components(mean.s, slip.n, slip.u);
        last.p_i = components(mean.p_i, slip.n, slip.u), last.p_j = components(mean.p_j, slip.n, slip.u);
        save_step(last, x);
    }
    save(now, x);
}

Rates EvolvingFriction::damper_rates(const Instant& now, const lie::State& x) const
{
    if (!now.is_saved) return TrackedForce::damper_rates(now, x);
    const StepData last = last_step(x);
    const Vec3 &n = now.contact_state.slip.n, &u = now.contact_state.slip.u;
    return {.s = tangent(last.s, n, u),
            .p_i = tangent(last.p_i, n, u),
            .p_j = tangent(last.p_j, n, u),
            .psi = last.psi};
}

double EvolvingFriction::stable_step_with(const lie::State& x, lie::LoadEvaluation /*evaluation*/,
                                          std::span<const int> near) const
{
    if (dae::Model::mode(contact, x) == EvolvingContact::fallback_active)
        return std::numeric_limits<double>::infinity();
    // The stiffness of Hertzian springs grows with F_N; the weight of all bodies is an estimate of the
    // largest F_N.
    const double N = std::max(normal_force(x), model.weight());
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    const ContactState now = friction_pair.contact_state(contact_point(x), N, bi, bj, {});
    return friction_pair.stable_step(now, {.rigid = true}, bi, bj, contacts(x, Counted::near, near));
}

bool EvolvingFriction::is_stable(const lie::State& x, double h, lie::LoadEvaluation /*evaluation*/,
                                 std::span<const int> touching) const
{
    const double N = normal_force(x);
    if (!(N > 0)) return true;
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    const ContactState now = friction_pair.contact_state(contact_point(x), N, bi, bj, {});
    return friction_pair.is_stable(h, 1, now, {.rigid = true}, bi, bj,
                                   contacts(x, Counted::touching, touching));
}

}  // namespace hilda::contact
