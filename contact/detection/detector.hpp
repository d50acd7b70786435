// SPDX-License-Identifier: GPL-3.0-or-later
/// Contact detection: the contact point of a pair of surfaces in a given pose.

#pragma once

#include "contact/contact_point.hpp"
#include "contact/shape.hpp"
#include "lie/state.hpp"

#include <memory>
#include <optional>

namespace hilda::contact {

using lie::Motion;

/// Contact points of an earlier instant, each in the frame of its body [m]. They are the initial guess of the
/// search.
struct PreviousPoints {
    Vec3 c_i, c_j;
};

/// Finds the contact point of one pair of surfaces. A detector has no state: the result depends on the
/// arguments only.
class Detector {
public:
    virtual ~Detector() = default;

    /// The contact point of bodies i and j at the poses r, A of bi and bj.
    ///
    /// With `from` the search starts at those points, and returns the solution found there if the surfaces
    /// overlap. Without `from`, or if that search fails, the search starts from the poses alone. If the
    /// bodies do not touch and several pairs of points have the smallest distance, any one of them is
    /// returned.
    ///
    /// Throws lie::NumericalFailure "contact_not_converged" if the bodies may be in contact and no contact
    /// point is found; NoUniqueContactPoint if the pose is the reason. The message has the residual and the
    /// number of iterations; the caller adds the names of the bodies.
    virtual ContactPoint detect(const Motion& bi, const Motion& bj, const PreviousPoints* from) const = 0;
};

/// The detector for a pair of surfaces: a closed form if there is one, otherwise Newton's method on the
/// common normal (CommonNormal). InvalidInput for a pair that has no single contact point in any pose, such
/// as two planes.
std::unique_ptr<Detector> make_detector(const Shape& i, const Shape& j);

}  // namespace hilda::contact
