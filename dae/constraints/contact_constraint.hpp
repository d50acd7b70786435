// SPDX-License-Identifier: GPL-3.0-or-later
/// A constraint with algebraic variables, modes and bounded velocity rows, as a contact has them.

#pragma once

#include "dae/constraint.hpp"
#include "lie/bounded_pair.hpp"

#include <string>

namespace hilda::dae {

class DerivativeFindings;

/// The functions that a constraint needs beyond those of Constraint if its Size has algebraic variables,
/// modes or bounded pairs.
class ContactConstraint : public Constraint {
public:
    using Constraint::Constraint;
    const ContactConstraint* as_contact() const final { return this; }

    /// Computes α at a start and returns the mode of the constraint. `alpha` is the array x.alpha. Throws
    /// lie::InvalidInput or lie::NumericalFailure if a run cannot start from x.
    virtual int start(const Arguments& x, double* alpha) const = 0;
    /// Computes α for the poses of the bodies: algebraic_variables() numbers. `alpha` may be the array
    /// x.alpha.
    ///
    /// With global_search = false the search starts from x.alpha. With global_search = true x.alpha is not
    /// used, and α depends on the poses alone. Throws lie::NumericalFailure if no α is found.
    virtual void update_alpha(const Arguments& x, bool global_search, double* alpha) const = 0;

    /// Updates the internal states as update_internal_state() does, and returns the mode with which the run
    /// continues. Throws lie::NumericalFailure if it cannot continue.
    virtual int update_mode(const Arguments& x, bool start, double* internal_state) const = 0;
    /// The same without the mode
    void update_internal_state(const Arguments& x, bool start, double* internal_state) const final
    {
        update_mode(x, start, internal_state);
    }
    /// Mode of the constraint if its rows depend linearly on those of other constraints at the start;
    /// `active` if the start then fails
    virtual int mode_if_redundant() const { return active; }

    /// K, D, mu, S, n and solved_first of the bounded pairs in an active constraint, in the order of their
    /// rows. The normal force of each pair is N = n · λ, where λ are the multipliers of the first three
    /// position rows.
    virtual void set_pairs(const Arguments& /*x*/, lie::BoundedPair* /*out*/) const {}

    /// Sets the elastic displacements of the bounded pairs at a start to those of the multipliers x.lambda.
    /// `at_rest` has a value for each pair: whether its C v is zero. The others remain without displacement.
    virtual void set_static_pairs(const Arguments& /*x*/, const bool* /*at_rest*/,
                                  double* /*internal_state*/) const
    {}

    /// Compares the functions of the surfaces with differences, see dae/start/derivative_check.hpp.
    virtual void check_derivatives(DerivativeFindings& /*out*/) const {}

    /// Violation of an active constraint by the positions or velocities of a start
    struct Violation {
        double value = 0, most = 0;  ///< measured and largest accepted value
        std::string text, unit;      ///< for the message "TEXT VALUE UNIT, at most MOST UNIT is allowed"
    };
    virtual Violation position_violation(const Arguments& x, double tolerance) const = 0;
    virtual Violation velocity_violation(const Arguments& x, double tolerance) const = 0;
};

}  // namespace hilda::dae
