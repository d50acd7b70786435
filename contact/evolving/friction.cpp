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

Touch EvolvingFriction::touch(const lie::State& x) const
{
    Touch now = contact.touch(model.at(contact, x));
    now.gap = 0;  // but for rounding, or while a step is tried
    return now;
}

double EvolvingFriction::normal_force(const lie::State& x) const { return works(x) ? last_step(x).N : 0; }

Meeting EvolvingFriction::meet(const lie::State& x, const Memory& memory) const
{
    return rubbing.meeting(touch(x), normal_force(x), motion(x, i), motion(x, j), memory);
}

int EvolvingFriction::remembered() const { return TrackedForce::remembered() + numbers_of_step; }

EvolvingFriction::Step EvolvingFriction::last_step(const lie::State& x) const
{
    static_assert(sizeof(Step) == numbers_of_step * sizeof(double));
    Step last;
    std::memcpy(static_cast<void*>(&last),
                x.remembered.data() + first_remembered + TrackedForce::remembered(), sizeof last);
    return last;
}

void EvolvingFriction::keep_step(const Step& last, lie::State& x) const
{
    std::memcpy(x.remembered.data() + first_remembered + TrackedForce::remembered(),
                static_cast<const void*>(&last), sizeof last);
}

void EvolvingFriction::remember(lie::State& x) const
{
    if (!works(x)) {
        x.memory[first_memory] = 0;
        std::fill_n(x.remembered.begin() + first_remembered, remembered(), 0.);
        return;
    }
    Step last{.N = contact.multipliers(model.at(contact, x), x.lambda).F_N};
    const bool goes_on = recall(x).touching;
    const double h = x.t - instant_of_memory(x);
    keep_step(last, x);
    const Instant now = at(x);
    if (now.meeting.N > 0) {
        const Slip& slip = now.meeting.slip;
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
    if (!now.remembered) return TrackedForce::speeds(now, x);
    const Step last = last_step(x);
    const Vec3 &n = now.meeting.slip.n, &u = now.meeting.slip.u;
    return {.s = tangent(last.s, n, u),
            .p_i = tangent(last.p_i, n, u),
            .p_j = tangent(last.p_j, n, u),
            .psi = last.psi};
}

double EvolvingFriction::stable_step(const lie::State& x) const
{
    if (dae::Model::mode(contact, x) == dae::Constraint::handed_over)
        return std::numeric_limits<double>::infinity();
    double weight = 0;  // that may rest on the contact: the springs of a Hertzian patch grow with its force
    for (const double m : model.mass().m) weight += m * model.gravity.norm();
    const double N = std::max(normal_force(x), weight);
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    const Meeting now = rubbing.meeting(touch(x), N, bi, bj, {});
    return rubbing.stable_step(now, {.rigid = true}, bi, bj, contacts_of(i, x), contacts_of(j, x));
}

}  // namespace hilda::contact
