// SPDX-License-Identifier: GPL-3.0-or-later
/// Rigid contacts of a multibody model: unilateral contact points with Coulomb friction.

#pragma once

#include "lie/cones/cone_rows.hpp"
#include "lie/state.hpp"

#include <string>

namespace hilda::dae {

using lie::State;

/// The contact points of one pair of bodies, or of the pairs of a group. They are cones of the equations
/// (lie::ConeRows), whose number changes. The object is constant during a run.
///
/// The key of a contact point is (first_pair + number of the pair) · 2^32 + number of the point in its pair.
class RigidContacts {
public:
    virtual ~RigidContacts() = default;

    /// Upper limit of the numbers of the pairs
    virtual int numbers() const = 0;
    /// Appends the contact points that may close in a step h [s] from x, by ascending keys. See
    /// lie::System::cones().
    virtual void add_cones(const State& x, double h, lie::ConeRows& out) const = 0;
    /// Name of the contact of a pair
    virtual std::string name_of_pair(int number) const = 0;
    /// The reason why a run cannot start in x, or an empty text
    virtual std::string start_error(const State& x) const = 0;
    /// The body with the largest speed relative to the smallest width of the bodies, of those that another
    /// bounded body can touch; body -1: none
    struct Fastest {
        double widths_per_second = 0;
        int body = -1;
    };
    virtual Fastest fastest(const State& x) const = 0;

    int first_pair = 0;      ///< set by Model
    std::string place = {};  ///< in the file from which the contacts were read, for messages
};

}  // namespace hilda::dae
