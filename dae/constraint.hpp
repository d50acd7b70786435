// SPDX-License-Identifier: GPL-3.0-or-later
/// A general constraint between two bodies: position rows with algebraic variables, and velocity rows.

#pragma once

#include "dae/body.hpp"
#include "lie/rows.hpp"

#include <optional>
#include <string>

namespace hilda::dae {

/// First variation of a row: δΦ = r_i · δr_i + pi_i · δπ̄_i + r_j · δr_j + pi_j · δπ̄_j           Eq. 3.6
///
/// r_i = Φ_riᵀ (global frame) and pi_i = Π̄_iᵀ (body frame of i); the same for body j. A virtual rotation δπ̄
/// changes the orientation by δA = A δπ̄~.
struct Variation {
    Vec3 r_i, pi_i, r_j, pi_j;

    static Variation zero() { return {Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}; }
};

using Mat12 = Eigen::Matrix<double, 12, 12>;

/// Derivatives of γ: δγ = r · δr + theta · δθ + rdot · δṙ + omega · δω̄, summed over the bodies i and j
struct GammaDerivatives {
    struct OfBody {
        Vec3 r = Vec3::Zero(), theta = Vec3::Zero(), rdot = Vec3::Zero(), omega = Vec3::Zero();
    } i, j;
};

class ContactConstraint;

/// Position rows Φ(r, A, α, t) = 0 of two bodies with algebraic variables α, and velocity rows C_v v = 0.
///
///     M v̇ + Cᵀ λ = f,    Φ_αᵀ λ = 0,    Φ(r, A, α, t) = 0,    C_v v = 0     Fang (2022), Eqs. 5.31 to 5.36
///
/// v = (ṙ, ω̄) are the velocities. C = (Φ_r, Π̄) holds the derivatives of all rows, and C_v is its part for
/// the velocity rows. The constraint has fewer algebraic variables than position rows. Its velocity rows
/// are nonholonomic constraints such as rolling. They have no Φ. They may be regularised and bounded.
///
/// Derive from this class for a constraint of several rows that share a computation. A single scalar row is a
/// Block. A constraint with algebraic variables, modes or bounded rows, such as a contact, is a
/// ContactConstraint.
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

    static constexpr int active = 0;  ///< the mode of a constraint whose rows are part of the equations

    /// Arguments of an evaluation: the motions of the two bodies, and the constraint's own part of the state
    struct Arguments {
        const Motion &bi, &bj;
        double t = 0;                             ///< [s]
        const double* alpha = nullptr;            ///< algebraic_variables() numbers
        const double* internal_state = nullptr;   ///< internal_states() numbers
        int mode = active;                        ///< `active` for a constraint without modes
        const Eigen::VectorXd* lambda = nullptr;  ///< multipliers of all rows of the system, or nullptr
        int row = 0, velocity_row = 0;            ///< first position row and velocity row in lambda
    };

    /// What the constraint adds to the equations. In every function that takes a row number the position rows
    /// come first and the velocity rows follow.
    struct Size {
        int position_rows = 0;        ///< at most max_position_rows
        int velocity_rows = 0;        ///< at most max_velocity_rows
        int algebraic_variables = 0;  ///< α, fewer than position_rows
        /// Pairs of velocity rows that are regularised and bounded, see lie::BoundedPair; the first velocity
        /// rows
        int bounded_pairs = 0;
        /// Whether the constraint can be switched off. It then has a mode in State::discrete_state: `active`
        /// if its rows are part of the equations, else a number defined by the derived class. If it is not
        /// active its rows and multipliers are zero, and a step does not change its algebraic variables.
        bool may_be_inactive = false;
    };
    virtual Size size() const = 0;
    int position_rows() const { return size().position_rows; }
    int velocity_rows() const { return size().velocity_rows; }
    int algebraic_variables() const { return size().algebraic_variables; }
    int bounded_pairs() const { return size().bounded_pairs; }
    bool may_be_inactive() const { return size().may_be_inactive; }
    /// This object if the constraint has algebraic variables, modes or bounded pairs; otherwise nullptr
    virtual const ContactConstraint* as_contact() const { return nullptr; }

    /// Number of internal states in State::internal_state, such as the revolutions counted by a gear. Φ may
    /// also use them to select one of several equivalent forms of its equations, such as a tangent basis.
    virtual int internal_states() const { return 0; }
    /// Updates the internal states, at a start, where all are zero, and once per accepted step. Throws
    /// lie::NumericalFailure if the run cannot continue.
    virtual void update_internal_state(const Arguments& /*x*/, bool /*start*/,
                                       double* /*internal_state*/) const
    {}

    /// Φ: position_rows() numbers
    virtual void phi(const Arguments& x, double* out) const = 0;

    struct Derivatives {
        using BodyRows = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor, max_rows, 6>;
        using AlgebraicColumns =
            Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_position_rows, max_position_rows>;

        BodyRows C_i, C_j;           ///< (Φ_r, Π̄) of all rows for each body
        AlgebraicColumns Phi_alpha;  ///< Φ_α, position_rows() × algebraic_variables()

        void set_zero(const Constraint& c)  ///< sizes for the constraint c, and zeros
        {
            C_i.setZero(c.position_rows() + c.velocity_rows(), 6);
            C_j.setZero(c.position_rows() + c.velocity_rows(), 6);
            Phi_alpha.setZero(c.position_rows(), c.algebraic_variables());
        }
    };
    /// Derivatives of all rows. On entry the matrices have their full size and every entry is zero, or is the
    /// result of an earlier call; entries that are always zero need not be written.
    virtual void variation(const Arguments& x, Derivatives& out) const = 0;
    /// ν = -∂Φ/∂t of all rows: Φ_r ṙ + Π̄ ω̄ + Φ_α α̇ = ν. The default, zero, is for rows that do not depend
    /// explicitly on time.
    virtual void nu(const Arguments& x, double* out) const;
    /// γ of all rows: C v̇ + Φ_α α̈ = γ for a position row, C v̇ = γ for a velocity row
    virtual void gamma(const Arguments& x, double* out) const = 0;
    /// Sparsity pattern of a row: bit c (0 to 11) is clear if the derivative with respect to component c of
    /// (r_i, π̄_i, r_j, π̄_j) is zero in every state.
    virtual unsigned nonzero(int /*row*/) const { return 0b111111111111; }

    // Derivatives of one row for exact Newton matrices. The defaults are central differences with a relative
    // error of about 1e-9. They are not used for constraints with algebraic variables.

    /// ∂(r_i, pi_i, r_j, pi_j)/∂(δr_i, δθ_i, δr_j, δθ_j) with A ← A exp(δθ~)
    virtual Mat12 second_variation(const Arguments& x, int row) const;
    /// ∂ν/∂(δr_i, δθ_i, δr_j, δθ_j)
    virtual Variation nu_variation(const Arguments& x, int row) const;
    /// Derivatives of γ by the positions and velocities of both bodies
    virtual GammaDerivatives gamma_variation(const Arguments& x, int row) const;

    /// Reason why a run cannot start from x, in the form "what is wrong, got value". An empty string if it
    /// can.
    virtual std::string start_error(const Arguments& /*x*/) const { return {}; }
    /// The two points that the constraint refers to; none for a constraint on orientations
    virtual std::optional<PointPair> points() const { return {}; }

    /// Kind and name for messages
    virtual std::string label() const { return "constraint '" + name + "'"; }
    /// Name of a row for messages
    virtual std::string row_name(int row) const { return "row " + std::to_string(row + 1); }

    int i, j;  ///< body numbers, or `ground`
    std::string name;

    /// The part of a constraint in the rows and in the state of its model, see Model::place()
    struct Place {
        int row = 0, velocity_row = 0;      ///< numbers of its first position row and velocity row
        int alpha = 0, internal_state = 0;  ///< indices of its first number in State
        int discrete_state = -1;            ///< index of its mode in State; -1: it is always active
    };

private:
    friend class Model;
    Place place;
};

}  // namespace hilda::dae
