// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/compliant/missed_contact.hpp"

#include "contact/detection/passage.hpp"
#include "io/error.hpp"

#include <sstream>

namespace hilda::contact {

namespace {

constexpr double short_motion = 0.1;  // relative to the smaller size: contact cannot be missed
constexpr double deeper = 2;  // an overlap within the step relative to that at its end: the bodies separate

Passage passage_of(const StepOfPair& s, double arm_i, double arm_j)
{
    return {s.i_begin, s.i_end, s.j_begin, s.j_end, s.t_end - s.t_begin, arm_i, arm_j};
}

}  // namespace

bool cannot_miss_contact(const CompliantContact& contact, const StepOfPair& step, double arm_i, double arm_j)
{
    return !(passage_of(step, arm_i, arm_j).length() > short_motion * contact.smaller_of_sizes());
}

void check_for_missed_contact(const CompliantContact& contact, const std::string& label,
                              const StepOfPair& step, const ContactPoint& at, const ContactHistory& history)
{
    const double size = contact.smaller_of_sizes();
    const Passage passage =
        passage_of(step, (at.C_i - step.i_begin.r).norm(), (at.C_j - step.j_begin.r).norm());
    if (!(passage.length() > short_motion * size) || at.gap > passage.length()) return;
    const auto gap = [&](const Motion& bi, const Motion& bj) { return contact.gap(bi, bj, history); };
    const double gap_end = gap(step.i_end, step.j_end);
    if (at.gap + gap_end > passage.length()) return;
    const double s = passage.first_overlap(at.gap, size, gap);
    if (!(s < 1) || (gap_end < 0 && passage.deepest(s, gap) > deeper * gap_end)) return;
    std::ostringstream what;
    what.precision(2);
    what << label << ": the bodies pass through each other between t = " << io::shortest(step.t_begin)
         << " s and " << io::shortest(step.t_end) << " s, with no node at the compression; use a step below "
         << (step.t_end - step.t_begin) * short_motion * size / passage.length() << " s";
    throw lie::NumericalFailure("contact_missed", what.str());
}

}  // namespace hilda::contact
