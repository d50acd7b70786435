// SPDX-License-Identifier: GPL-3.0-or-later
/// Contact detection: the contact point of a pair of surfaces in a given pose.

#pragma once

#include "contact/contact_point.hpp"
#include "contact/detection/manifold.hpp"
#include "contact/shape.hpp"
#include "lie/state.hpp"

#include <memory>
#include <optional>

namespace hilda::contact {

using lie::Motion;

/// Contact points of an earlier time, each in the frame of its body [m]. They are the initial guess of the
/// search.
struct PreviousPoints {
    Vec3 c_i, c_j;
};

/// Finds the contact point of one pair of surfaces. A detector has no state: the result depends on the
/// arguments only.
class Detector {
public:
    virtual ~Detector() = default;

    /// The contact point of bodies i and j at the poses (r, A) of bi and bj.
    ///
    /// An iterative detector starts from the points `from`. If the surfaces overlap at the solution, it
    /// returns this solution. If `from` is nullptr, if the search fails or if its solution has a gap, the
    /// detector may also search from the poses alone. Detectors in closed form do not use `from`. If the
    /// bodies are separated and several pairs of points have the smallest distance, one of these pairs is
    /// returned.
    ///
    /// Throws lie::NumericalFailure "contact_not_converged" if the bodies may be in contact and no contact
    /// point is found, and the derived NoUniqueContactPoint if the pose has no unique contact point. The
    /// message states the reason. The caller adds the name of the contact.
    virtual ContactPoint detect(const Motion& bi, const Motion& bj, const PreviousPoints* from) const = 0;

    /// Sets `out` to the contact points with a gap below `reach` [m]: several of two bodies with edges, the
    /// one of detect() of others. If the bodies are exchanged, the points are the same bit by bit, with the
    /// opposite normals. Throws as detect().
    virtual void detect_all(const Motion& bi, const Motion& bj, double reach, Manifold& out) const;

    /// Whether detect() takes less time than to store a contact point in the state, and does not use `from`
    virtual bool is_cheap() const { return false; }
};

/// The detector for a pair of surfaces: a closed form if there is one, otherwise Newton's method on the
/// common normal (CommonNormal). A ball counts as a polytope beside one. Throws lie::InvalidInput for a pair
/// that has no single contact point in any pose, such as two planes, for a pair without a detector, such as
/// a disk and a sphere, and for a shape without a surface or with an invalid pose.
std::unique_ptr<Detector> make_detector(const Shape& i, const Shape& j);

}  // namespace hilda::contact
