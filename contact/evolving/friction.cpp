// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/evolving/friction.hpp"

#include "lie/check.hpp"

#include <algorithm>
#include <cstring>

namespace hilda::contact {

namespace {

constexpr int numbers_of_step = 8;
constexpr double an_instant = 1e-9;  // [s]; the ways of the contact point over less are rounding

}  // namespace

EvolvingFriction::EvolvingFriction(const dae::Model& model, const EvolvingContact& contact,
                                   std::shared_ptr<const FrictionModel> friction)
    : TrackedForce(contact.name, model, contact.i, contact.j), contact(contact),
      rubbing(contact.name, contact.shape_i, contact.shape_j, inertia(model, contact.i),
              inertia(model, contact.j), std::move(friction))
{
    if (contact.friction == EvolvingContact::Friction::rolling)
        lie::reject(in_words(), "a contact that rolls ideally has no friction besides", "a friction law");
    if (contact.friction == EvolvingContact::Friction::implicit)
        lie::reject(in_words(), "a contact has friction either in its equations or as a force", "both");
}

ContactPoint EvolvingFriction::contact_point(const lie::State& x) const
{
    ContactPoint now = contact.contact_point(model.at(contact, x));
    now.gap = 0;  // but for rounding, or while a step is tried
    return now;
}

double EvolvingFriction::normal_force(const lie::State& x) const { return works(x) ? last_step(x).N : 0; }

ContactState EvolvingFriction::evaluate(const lie::State& x, const ContactHistory& history) const
{
    return rubbing.contact_state(contact_point(x), normal_force(x), motion(x, i), motion(x, j), history);
}

int EvolvingFriction::internal_states() const { return TrackedForce::internal_states() + numbers_of_step; }

EvolvingFriction::Step EvolvingFriction::last_step(const lie::State& x) const
{
    static_assert(sizeof(Step) == numbers_of_step * sizeof(double));
    Step last;
    std::memcpy(static_cast<void*>(&last),
                x.internal_state.data() + first_internal_state + TrackedForce::internal_states(),
                sizeof last);
    return last;
}

void EvolvingFriction::keep_step(const Step& last, lie::State& x) const
{
    std::memcpy(x.internal_state.data() + first_internal_state + TrackedForce::internal_states(),
                static_cast<const void*>(&last), sizeof last);
}

void EvolvingFriction::update_internal_state(lie::State& x) const
{
    if (!works(x)) {
        x.discrete_state[first_discrete_state] = 0;
        std::fill_n(x.internal_state.begin() + first_internal_state, internal_states(), 0.);
        return;
    }
    Step last{.N = contact.multipliers(model.at(contact, x), x.lambda).F_N};
    const bool goes_on = recall(x).touching;
    const double h = x.t - time_of_history(x);
    keep_step(last, x);
    const Instant now = at(x);
    if (now.contact_state.N > 0) {
        const SlidingDisplacement& slip = now.contact_state.slip;
        const Rates mean = goes_on && h > an_instant ? mean_rates(slip, h) : TrackedForce::speeds(now, x);
        last.psi = mean.psi;
        last.s = components(mean.s, slip.n, slip.u);
        last.p_i = components(mean.p_i, slip.n, slip.u), last.p_j = components(mean.p_j, slip.n, slip.u);
        keep_step(last, x);
    }
    keep(now, x);
}

Rates EvolvingFriction::speeds(const Instant& now, const lie::State& x) const
{
    if (!now.is_saved) return TrackedForce::speeds(now, x);
    const Step last = last_step(x);
    const Vec3 &n = now.contact_state.slip.n, &u = now.contact_state.slip.u;
    return {.s = tangent(last.s, n, u),
            .p_i = tangent(last.p_i, n, u),
            .p_j = tangent(last.p_j, n, u),
            .psi = last.psi};
}

double EvolvingFriction::stable_step(const lie::State& x) const
{
    if (dae::Model::mode(contact, x) == dae::Constraint::fallback_active)
        return std::numeric_limits<double>::infinity();
    double weight = 0;  // that may rest on the contact: the springs of a Hertzian patch grow with its force
    for (const double m : model.mass().m) weight += m * model.gravity.norm();
    const double N = std::max(normal_force(x), weight);
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    const ContactState now = rubbing.contact_state(contact_point(x), N, bi, bj, {});
    return rubbing.stable_step(now, {.rigid = true}, bi, bj, contacts_of(i, x), contacts_of(j, x));
}

}  // namespace hilda::contact
