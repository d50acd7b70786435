// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/compliant/contact_force.hpp"

#include "contact/compliant/missed_contact.hpp"
#include "contact/derivative_check.hpp"
#include "contact/evolving/contact.hpp"
#include "contact/internal_state.hpp"
#include "dae/model.hpp"

#include <algorithm>

namespace hilda::contact {

ContactForce::ContactForce(const std::string& name, const dae::Model& model, int i, const Shape& shape_i,
                           int j, const Shape& shape_j, std::shared_ptr<const NormalLaw> law,
                           std::shared_ptr<const FrictionModel> friction)
    : TrackedForce(name, model, i, j), contact(name, shape_i, shape_j, inertia(model, i), inertia(model, j),
                                               std::move(law), std::move(friction)),
      other_points(OtherPoints::of(shape_i, shape_j))
{}

ContactState ContactForce::evaluate(const lie::State& x, const ContactHistory& history) const
{
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    if (contact.has_cheap_detector()) return contact.evaluate(bi, bj, history);
    const NodePoint last = saved_point(x);
    return last.is_at(bi, bj) ? contact.evaluate_at(last.contact_point, bi, bj, history)
                              : contact.evaluate(bi, bj, history);
}

int ContactForce::internal_states() const
{
    return TrackedForce::internal_states() + node_point_states() +
           (other_points ? reals<OtherPoints::Pose>() : 0);
}

void ContactForce::save(const Instant& now, lie::State& x) const
{
    static_assert(reals<NodePoint>() == 2 * (3 + 9) + 5 * 3 + 1 + 2 * 9, "NodePoint must not have padding");
    TrackedForce::save(now, x);
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    double* const saved = x.internal_state.data() + first_of_node_point();
    if (node_point_states() > 0)
        contact::save(NodePoint{.r_i = bi.r,
                                .r_j = bj.r,
                                .A_i = bi.A,
                                .A_j = bj.A,
                                .contact_point = now.contact_state.contact_point},
                      saved);
    if (!other_points || !(now.contact_state.N > 0)) return;
    auto last = restored<OtherPoints::Pose>(saved + node_point_states());
    try {
        other_points->check(name, bi, bj, now.contact_state.contact_point, last);
    } catch (const lie::NumericalFailure& e) {
        rethrow(e, x);
    }
    contact::save(last, saved + node_point_states());
}

bool ContactForce::is_active(const lie::State& x) const
{
    return constraint == nullptr || dae::Model::mode(*constraint, x) == EvolvingContact::fallback_active;
}

bool ContactForce::is_near_contact(const lie::State& x) const
{
    return is_active(x) && contact.is_near_contact(motion(x, i), motion(x, j), saved_history(x));
}

double ContactForce::potential_energy(const lie::State& x) const
{
    if (!is_active(x)) return 0;
    return contact.energy(at(x).contact_state, motion(x, i), motion(x, j));
}

std::string ContactForce::start_error(const lie::State& x) const
{
    if (constraint != nullptr) return {};  // the surfaces are checked when the fallback becomes active
    return contact.start_error(motion(x, i), motion(x, j));
}

ContactState ContactForce::loaded_state(const lie::State& x) const
{
    return contact.state_at_largest_compression(motion(x, i), motion(x, j), saved_history(x), model.weight());
}

double ContactForce::stable_step_with(const lie::State& x, lie::LoadEvaluation evaluation,
                                      std::span<const int> near) const
{
    try {
        return contact.stable_step(loaded_state(x), motion(x, i), motion(x, j),
                                   contacts(x, Counted::near, near), lie::damping_factor(evaluation));
    } catch (const lie::NumericalFailure& e) {
        rethrow(e, x);
    }
}

void ContactForce::check_derivatives(const lie::State& x, dae::DerivativeFindings& out) const
{
    TrackedForce::check_derivatives(x, out);
    const NormalLaw& law = *contact.law;
    if (!is_active(x) || !out.is_next(typeid(law))) return;
    try {
        check_normal_law(law, contact.normal_input(loaded_state(x).contact_point, motion(x, i), motion(x, j)),
                         label(), out);
    } catch (const lie::NumericalFailure&) {  // no contact point
    }
}

ContactForce::NodePoint ContactForce::saved_point(const lie::State& x) const
{
    return restored<NodePoint>(x.internal_state.data() + first_of_node_point());
}

ContactPoint ContactForce::node_point(const lie::State& x) const
{
    return contact.has_cheap_detector() ? contact.contact_point(motion(x, i), motion(x, j), {})
                                        : saved_point(x).contact_point;
}

bool ContactForce::is_stable(const lie::State& x, double h, lie::LoadEvaluation evaluation,
                             std::span<const int> touching) const
{
    if (!is_active(x) || !is_touching(x)) return true;
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    const ContactState now = contact.state_without_history(node_point(x), bi, bj);
    return contact.is_stable(h, lie::damping_factor(evaluation), now, bi, bj,
                             contacts(x, Counted::touching, touching));
}

void ContactForce::check_step(const lie::State& before, const lie::State& after) const
{
    if (!is_active(before) || is_touching(before)) return;
    check_for_missed_contact(
        contact, label(),
        {motion(before, i), motion(after, i), motion(before, j), motion(after, j), before.t, after.t},
        node_point(before), saved_history(before));
}

double ContactForce::overlap(const lie::State& x) const
{
    return is_active(x) && is_touching(x) ? std::max(0., -node_point(x).gap) : 0;
}

double ContactForce::relative_overlap(const lie::State& x) const
{
    return is_active(x) && is_touching(x) ? contact.relative_overlap(node_point(x)) : 0;
}

}  // namespace hilda::contact
