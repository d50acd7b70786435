// SPDX-License-Identifier: GPL-3.0-or-later
/// Bodies with a compliant contact that pass through each other within one step.

#pragma once

#include "contact/compliant/contact.hpp"

#include <string>

namespace hilda::contact {

/// The motions of both bodies of a contact at the begin and at the end of a step
struct StepOfPair {
    const Motion &i_begin, &i_end, &j_begin, &j_end;
    double t_begin, t_end;
};

/// Throws NumericalFailure "contact_missed" if two bodies that are apart at the begin pass through each other
/// within the step, or separate again with no node near the largest overlap. `at` is the contact point at the
/// begin, `label` the name of the force.
void check_for_missed_contact(const CompliantContact& contact, const std::string& label,
                              const StepOfPair& step, const ContactPoint& at, const ContactHistory& history);

/// Whether no motion of the step is long enough for that, for bodies with points within the distances arm_i
/// and arm_j [m] of their centres of mass
bool cannot_miss_contact(const CompliantContact& contact, const StepOfPair& step, double arm_i, double arm_j);

}  // namespace hilda::contact
