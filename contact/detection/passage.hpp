// SPDX-License-Identifier: GPL-3.0-or-later
/// Bodies that pass through each other within a step, while neither end of the step has an overlap.

#pragma once

#include "lie/state.hpp"

#include <functional>

namespace hilda::contact {

using lie::Motion;
using lie::Vec3;

/// The relative motion of two surfaces over a step h, on the cubic paths of both bodies.
///
/// The distance of the surfaces changes by at most the length of their relative motion: the displacement of
/// the centres, and the turn of each body times the distance of its point of contact. A step whose gaps at
/// both ends together exceed the length has no contact.
class Passage {
public:
    /// i and j at both ends; arm_i, arm_j: distances of the nearest points from the centres [m]
    Passage(const Motion& i_begin, const Motion& i_end, const Motion& j_begin, const Motion& j_end, double h,
            double arm_i, double arm_j);

    double length() const { return bound; }  ///< of the relative motion [m]

    /// The distance of the surfaces for two poses [m]
    using Gap = std::function<double(const Motion& i, const Motion& j)>;
    /// The first place s, from 0 to 1, with an overlap; 1 if there is none. The search advances by the gap
    /// over the length (conservative advancement, Mirtich 1996), and by at least a thousandth of `size`, the
    /// smaller size of the surfaces [m].
    double first_overlap(double gap_begin, double size, const Gap& gap) const;
    /// The smallest gap at 16 places from s to the end [m]
    double deepest(double s, const Gap& gap) const;

private:
    const Motion &i_begin, &i_end, &j_begin, &j_end;
    const double h;
    double bound;
};

}  // namespace hilda::contact
