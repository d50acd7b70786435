// SPDX-License-Identifier: GPL-3.0-or-later
/// Forces of one kind between many pairs of bodies that act only while the bodies are close to each other.

#pragma once

#include "dae/force.hpp"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace hilda::dae {

/// A group of pairs of bodies. Only the forces of near pairs exist as objects, see NearForces. A pair has a
/// number, which does not change. Numbers without a pair are permitted.
///
/// The force of a pair has one discrete state. It is passive, has no load while the bounding spheres of the
/// bodies do not overlap, and its internal states are then those of a start.
class ForceGroup {
public:
    virtual ~ForceGroup() = default;

    virtual int numbers() const = 0;  ///< the numbers of the pairs are below this
    virtual long pairs() const = 0;   ///< number of pairs
    virtual bool has_pair(int number) const = 0;
    virtual std::array<int, 2> bodies(int number) const = 0;  ///< of a pair
    /// Makes the force of a pair.
    virtual std::unique_ptr<Force> force(int number) const = 0;
    /// The force of some pair, for what all have in common. It does not belong to a state.
    virtual const Force& example() const = 0;
    /// Radius of the bounding sphere of a body about its centre of mass [m]: infinite for an unbounded body,
    /// negative for a body without a pair
    virtual double reach(int body) const = 0;
    /// Writes the numbers of all pairs, ascending, whose bodies may come into contact while no body moves by
    /// more than its `motion` [m] from these positions.
    virtual void find(const std::vector<Motion>& body, std::span<const double> motion,
                      std::vector<int>& numbers) const = 0;

    std::string place;  ///< its location in the model file, or an empty string
};

}  // namespace hilda::dae
