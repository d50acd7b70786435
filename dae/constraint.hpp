// SPDX-License-Identifier: GPL-3.0-or-later
/// Several constraint rows between two bodies that bring unknowns of their own.

#pragma once

#include "dae/body.hpp"
#include "lie/system.hpp"

namespace hilda::dae {

/// Φ(r, A, α) = 0 with massless unknowns α, fewer than the rows; and after these rows some that hold velocities alone.
/// Derive for what two bodies do that no fixed row can say: a contact point that wanders over both of them.
class Constraint {
public:
    Constraint(int i, int j) : i(i), j(j) {}
    virtual ~Constraint() = default;

    static constexpr int most_rows = 8;  ///< of positions
    virtual int rows() const = 0;        ///< of positions
    virtual int velocity_rows() const { return 0; }
    /// Whether those give way in pairs, as lie::Rows::Compliant says; compliance() has K, D, S, μ, n of each pair.
    virtual bool is_regularised() const { return false; }
    int pairs() const { return is_regularised() ? velocity_rows() / 2 : 0; }
    virtual bool solved_first(int /*pair*/) const { return false; }
    virtual int unknowns() const = 0;
    /// Numbers that it keeps in State::remembered; Φ may depend on them in how it is written, not in what it says
    virtual int internal_states() const { return 0; }
    /// What it does, as State::memory has it
    enum Mode {
        active = 0,
        inactive = 1,        ///< holds nothing for a while
        fallback_active = 2  ///< holds nothing: a force does what it cannot do any more
    };
    /// Whether it is ever in another mode than the first
    virtual bool may_be_inactive() const { return false; }
    /// Whether a force stands by for it, so that it hands over instead of failing
    virtual bool has_fallback() const { return false; }

    /// Where it is evaluated: its bodies, its own unknowns, what it remembers
    struct At {
        const Motion &bi, &bj;
        double t;
        const double *alpha, *internal_state;
        bool inactive;                            ///< not in the mode `holds`
        const Eigen::VectorXd* lambda = nullptr;  ///< of the whole system
    };
    virtual void phi(const At& x, double* out) const = 0;
    /// Derivatives of all rows: (r, π̄) of each body, and Φ_α of the rows of positions
    struct Derivatives {
        Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor, 12, 6> of_i, of_j;
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_rows, most_rows> of_alpha;
    };
    /// Into matrices of their full size, all of whose entries are zero or of an earlier call
    virtual void variation(const At& x, Derivatives& out) const = 0;
    /// γ of all rows, with Φ_α α̈ on the left for rows of positions
    virtual void gamma(const At& x, double* out) const = 0;
    /// Into the pairs that give way, in the order of their rows
    virtual void compliance(const At& /*x*/, lie::Rows::Regularised* /*out*/) const {}
    /// Bit c of the first twelve is clear where derivative c of this row, (r, pi) of body i and then of j, is always zero.
    virtual unsigned nonzero(int /*row*/) const { return 0b111111111111; }

    /// α that belongs to the poses of the bodies, from what is there; `afresh`: from nothing
    virtual void update_alpha(const At& x, bool afresh, double* alpha) const = 0;
    /// What is remembered, at a start and once per accepted step. Where the constraint cannot go on from here it throws
    /// lie::NumericalFailure, or returns false if it hands over.
    virtual bool update_internal_state(const At& x, bool start, double* internal_state) const = 0;

    /// Distance of the two bodies where the rows are not quite satisfied, negative for overlap, α being that of track()
    /// [m]
    virtual double gap(const At& x) const = 0;
    /// Rate of the gap [m/s]; and whether it may open by itself, so that at a start it need not be zero
    virtual double separation_speed(const At& x) const = 0;
    virtual bool is_unilateral() const { return false; }
    virtual double velocity_error(const At& x) const = 0;
    /// What a position may be off at a start [m]
    virtual double allowance() const = 0;
    /// Why it cannot be used from here, as "what is wrong, got value"; empty when it can
    virtual std::string objection(const At& /*x*/) const { return {}; }
    virtual std::string row_name(int row) const { return "row " + std::to_string(row + 1); }

    int i, j;  ///< body numbers, or ground
    std::string name;
    int first_row = 0, first_velocity_row = 0;  ///< in the equations; these are set by the model
    int first_alpha = 0, first_discrete_state = 0, first_internal_state = 0;  ///< in the state
};

}  // namespace hilda::dae
