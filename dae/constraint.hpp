// SPDX-License-Identifier: GPL-3.0-or-later
/// A general constraint between two bodies: position rows with algebraic variables, and velocity rows.

#pragma once

#include "dae/body.hpp"
#include "lie/rows.hpp"

namespace hilda::dae {

/// Position rows Φ(r, A, α) = 0 of two bodies with algebraic variables α, and velocity rows C_v v = 0.
///
///     M v̇ + Cᵀ λ = f,    Φ_αᵀ λ = 0,    Φ(r, A, α) = 0,    C_v v = 0        Fang (2022), Eqs. 5.31 to 5.36
///
/// v = (ṙ, ω̄) are the velocities. C = (Φ_r, Π̄) holds the derivatives of all rows, and C_v is its part for
/// the velocity rows. The constraint has fewer algebraic variables than position rows. Its velocity rows
/// are nonholonomic constraints such as rolling. They have no Φ. They may be regularised, as friction rows
/// are. No row depends explicitly on time: ν = 0.
///
/// Use this class for a constraint that needs variables of its own, such as the contact points of two bodies
/// in contact. A single scalar row without such variables is a Block.
///
/// A constraint is constant during a run. Everything that changes is in State: the algebraic variables, the
/// internal states, the mode and the multipliers.
class Constraint {
public:
    /// i and j are different bodies; one of them may be `ground`.
    Constraint(int i, int j) : i(i), j(j) {}
    virtual ~Constraint() = default;

    static constexpr int max_position_rows = 8;
    static constexpr int max_velocity_rows = 4;
    /// 12 = 8 position rows + 4 velocity rows
    static constexpr int max_rows = max_position_rows + max_velocity_rows;

    /// Number of position rows, at most max_position_rows. In every function that takes a row number the
    /// position rows come first and the velocity rows follow.
    virtual int position_rows() const = 0;
    /// Number of velocity rows, at most max_velocity_rows
    virtual int velocity_rows() const { return 0; }
    /// Number of algebraic variables α, smaller than position_rows()
    virtual int algebraic_variables() const = 0;

    /// Whether the velocity rows are regularised in pairs, see lie::Rows::Regularised. The normal force of
    /// each pair is N = n · λ, where λ are the multipliers of the first three position rows.
    virtual bool is_regularised() const { return false; }
    int regularised_pairs() const { return is_regularised() ? velocity_rows() / 2 : 0; }
    /// Whether the compliance scale of this pair is determined before those of the pairs for which the
    /// function returns false; see lie::BoundedRows
    virtual bool solved_first(int /*pair*/) const { return false; }

    /// Number of internal states in State::internal_state. Φ may use them to select one of several equivalent
    /// forms of its equations, such as a tangent basis. The solutions of Φ = 0 must not depend on them.
    virtual int internal_states() const { return 0; }

    /// Mode of the constraint, stored in State::discrete_state. If the constraint is not active its rows and
    /// multipliers are zero, and a step does not change its algebraic variables.
    enum Mode {
        active = 0,          ///< its rows are part of the equations
        inactive = 1,        ///< an open unilateral constraint; it may become active again
        fallback_active = 2  ///< replaced by a force until the end of the run
    };
    /// Whether the mode can differ from `active`. If it cannot, no mode is stored.
    virtual bool may_be_inactive() const { return false; }
    /// Whether a force can replace the constraint (fallback). Without a fallback the constraint throws
    /// lie::NumericalFailure if it fails.
    virtual bool has_fallback() const { return false; }

    /// Arguments of an evaluation: the motions of the two bodies, and the constraint's own part of the state
    struct Arguments {
        const Motion &bi, &bj;
        double t;                                 ///< [s]
        const double *alpha, *internal_state;     ///< algebraic_variables() and internal_states() numbers
        bool inactive;                            ///< whether the mode differs from `active`
        const Eigen::VectorXd* lambda = nullptr;  ///< multipliers of all rows of the system, or nullptr
    };

    /// Φ: position_rows() numbers
    virtual void phi(const Arguments& x, double* out) const = 0;

    struct Derivatives {
        using BodyRows = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor, max_rows, 6>;
        using AlgebraicColumns =
            Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_position_rows, max_position_rows>;

        BodyRows C_i, C_j;           ///< (Φ_r, Π̄) of all rows for each body
        AlgebraicColumns Phi_alpha;  ///< Φ_α, position_rows() × algebraic_variables()
    };
    /// Derivatives of all rows. On entry the matrices have their full size and every entry is zero, or is the
    /// result of an earlier call; entries that are always zero need not be written.
    virtual void variation(const Arguments& x, Derivatives& out) const = 0;
    /// γ of all rows: C v̇ + Φ_α α̈ = γ for a position row, C v̇ = γ for a velocity row
    virtual void gamma(const Arguments& x, double* out) const = 0;
    /// K, D, mu, S and n of the regularised pairs, in the order of their rows
    virtual void regularisation(const Arguments& /*x*/, lie::Rows::Regularised* /*out*/) const {}
    /// Sparsity pattern of a row: bit c (0 to 11) is clear if the derivative with respect to component c of
    /// (r_i, π̄_i, r_j, π̄_j) is zero in every state.
    virtual unsigned nonzero(int /*row*/) const { return 0b111111111111; }

    /// Computes α for the poses of the bodies: algebraic_variables() numbers. `alpha` may be the array
    /// x.alpha.
    ///
    /// With global_search = false the search starts from x.alpha. With global_search = true x.alpha is not
    /// used, and α depends on the poses alone. Throws lie::NumericalFailure if no α is found.
    virtual void update_alpha(const Arguments& x, bool global_search, double* alpha) const = 0;
    /// Updates the internal states, at a start and once per accepted step. Returns true if the constraint can
    /// continue from x. If it cannot, returns false with a fallback, and throws lie::NumericalFailure without
    /// one.
    virtual bool update_internal_state(const Arguments& x, bool start, double* internal_state) const = 0;

    /// Signed distance of the two bodies at the points α [m], negative for an overlap
    virtual double gap(const Arguments& x) const = 0;
    /// Time derivative of the gap [m/s]
    virtual double separation_speed(const Arguments& x) const = 0;
    /// Whether the constraint can open. A unilateral constraint may start with a positive gap.
    virtual bool is_unilateral() const { return false; }
    /// Magnitude of the velocity that violates the active constraint [m/s]
    virtual double velocity_error(const Arguments& x) const = 0;
    /// Largest |gap| of an active constraint at a start [m]
    virtual double position_tolerance() const = 0;
    /// Reason why a run cannot start from x, in the form "what is wrong, got value". An empty string if it
    /// can.
    virtual std::string start_error(const Arguments& /*x*/) const { return {}; }
    /// Name of a row for messages
    virtual std::string row_name(int row) const { return "row " + std::to_string(row + 1); }

    int i, j;  ///< body numbers, or `ground`
    std::string name;

    // set by the model
    int first_row = 0, first_velocity_row = 0;  ///< numbers of the first position row and velocity row
    int first_alpha = 0;                        ///< index into State::alpha
    int first_discrete_state = 0;               ///< index into State::discrete_state
    int first_internal_state = 0;               ///< index into State::internal_state
};

}  // namespace hilda::dae
