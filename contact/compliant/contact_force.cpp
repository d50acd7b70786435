// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/compliant/contact_force.hpp"

namespace hilda::contact {

ContactForce::ContactForce(const std::string& name, const dae::Model& model, int i, const Shape& shape_i,
                           int j, const Shape& shape_j, std::shared_ptr<const NormalLaw> law,
                           std::shared_ptr<const FrictionModel> friction)
    : TrackedForce(name, model, i, j), contact(name, shape_i, shape_j, inertia(model, i), inertia(model, j),
                                               std::move(law), std::move(friction))
{}

ContactState ContactForce::evaluate(const lie::State& x, const ContactHistory& history) const
{
    return contact.evaluate(motion(x, i), motion(x, j), history);
}

bool ContactForce::close(const lie::State& x) const
{
    return works(x) && contact.close(motion(x, i), motion(x, j), recall(x));
}

double ContactForce::potential_energy(const lie::State& x) const
{
    if (!works(x)) return 0;
    return contact.energy(at(x).contact_state, motion(x, i), motion(x, j));
}

std::string ContactForce::objection(const lie::State& x) const
{
    if (replaced != nullptr) return {};  // whether the surfaces fit it is asked when it works
    return contact.objection(motion(x, i), motion(x, j));
}

double ContactForce::stable_step(const lie::State& x) const
{
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    double weight = 0;  // all that may rest on the contact
    for (const double m : model.mass().m) weight += m * model.gravity.norm();
    try {
        return contact.stable_step(contact.hardest(bi, bj, recall(x), weight), bi, bj, contacts_of(i, x),
                                   contacts_of(j, x));
    } catch (const lie::NumericalFailure& e) {
        rethrow(e, x);
    }
}

}  // namespace hilda::contact
