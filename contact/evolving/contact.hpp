// SPDX-License-Identifier: GPL-3.0-or-later
/// Evolving contact: a contact constraint whose contact points are unknowns of the equations of motion.
/// Source: Fang (2022), Secs. 5.1 and 5.3. Corrections to the printed equations: docs/theory/corrections.md.

#pragma once

#include "contact/detection/common_normal.hpp"
#include "contact/detection/detector.hpp"
#include "contact/detection/other_points.hpp"
#include "contact/evolving/implicit_friction.hpp"
#include "contact/internal_state.hpp"
#include "contact/shape.hpp"
#include "dae/constraints/contact_constraint.hpp"

namespace hilda::contact {

/// Behaviour of a contact that can open: lift-off under tension and rebound at an impact.
struct Unilateral {
    bool enabled = false;    ///< false: a bilateral constraint, which also transmits tension
    double restitution = 0;  ///< coefficient of restitution e, from 0 to 1
    enum class Impact {
        newton,  ///< v⁺ = -e v⁻ for the normal velocity of the contact points
        poisson  ///< the normal impulse of restitution is e times that of compression
    } impact = Impact::newton;
};

/// Contact constraint between two smooth surfaces, with the contact points as unknowns.
///
/// The contact points ᾱ_i, ᾱ_j ∈ R³ [m], relative to the centres of mass and in the body frames, are six
/// algebraic variables. The seven position rows are
///
///     Ψ = r_i + A_i ᾱ_i - r_j - A_j ᾱ_j           3 rows: the contact points coincide                 (5.12)
///     N = L Tᵀ (A_i n̄_i + A_j n̄_j)                2 rows: the normals are opposite                    (5.17)
///     G = G_i(ᾱ_i)/|∇G_i|,  G_j(ᾱ_j)/|∇G_j|       2 rows: the points lie on the surfaces              (5.27)
///
/// n̄ = σ ∇G/|∇G| is the outward unit normal of a body in its frame, with σ of Surface::sigma(). The
/// columns of T (3 × 2, global axes) are an orthonormal basis of the plane perpendicular to A_i n̄_i at the
/// last node. T is constant during a step. L is the smaller size of the two surfaces [m]. All rows are
/// lengths, so the conditioning does not depend on the size of the bodies. Seven rows with six algebraic
/// variables remove one degree of freedom: the relative motion along the normal.
///
/// (5.17) uses the global x and y axes in place of T. That choice is singular for a normal in the
/// xy-plane. It is available as NormalRows::fixed_xy for comparison.
///
/// The multipliers λ_Ψ, λ_N, λ_G are forces [N]. If the relative curvature K_i + K_j is regular in the
/// tangent plane,
///
///     λ_N = 0,    λ_Ψ = F_N A_i n̄_i,    λ_G = -F_N (σ_i, σ_j)
///
/// with the normal force F_N, positive in compression. The force on body i is -λ_Ψ. λ_N = 0 holds because n̄
/// is parallel to ∇G.
///
/// A pair that may have several contact points is watched by OtherPoints in all modes but fallback_active.
/// Its failure "contact_not_unique" ends the run also with a fallback, which has the force of one point as
/// well.
///
/// For an active contact update_mode() throws lie::NumericalFailure: "contact_lost" if
/// n_i · n_j ≥ -½, and "contact_singular" if the smaller eigenvalue of K_i + K_j in the tangent plane, times
/// L, is at most 1e-6. With a fallback it returns fallback_active instead.
class EvolvingContact final : public dae::ContactConstraint {
public:
    enum class NormalRows { tangent, fixed_xy };
    enum class Friction {
        none,  ///< the constraint has no friction; an EvolvingFriction can add friction as a force
        /// Ideal rolling: two nonholonomic rows make the tangential velocities of the material points in
        /// contact equal.
        rolling,
        /// Friction by ImplicitFriction: the same two rows, regularised and bounded, and two more rows if
        /// there is rolling resistance
        implicit
    };

    /// A contact between bodies i and j of the model; one of them may be dae::ground. Throws
    /// lie::InvalidInput if neither surface has a size, if the restitution is outside [0, 1], or if
    /// make_detector() rejects the pair.
    EvolvingContact(int i, const Shape& shape_i, int j, const Shape& shape_j,
                    Friction friction = Friction::none, NormalRows normal_rows = NormalRows::tangent,
                    const Unilateral& unilateral = {});
    /// The same with implicit friction. Also throws lie::InvalidInput for invalid parameters of the friction.
    EvolvingContact(int i, const Shape& shape_i, int j, const Shape& shape_j,
                    const ImplicitFriction& friction, NormalRows normal_rows = NormalRows::tangent,
                    const Unilateral& unilateral = {});

    Size size() const override
    {
        const int tangential_rows = friction == Friction::none ? 0 : law.has_rolling_resistance() ? 4 : 2;
        return {.position_rows = 7,
                .velocity_rows = tangential_rows,
                .algebraic_variables = 6,
                .bounded_pairs = is_regularised() ? tangential_rows / 2 : 0,
                .may_be_inactive = unilateral.enabled || fallback};
    }
    bool is_regularised() const { return friction == Friction::implicit; }
    using Mat32 = Eigen::Matrix<double, 3, 2>;
    /// The internal state of the contact at the last node
    struct NodeState {
        Mat32 T;              ///< tangent basis
        double last_rebound;  ///< time of the last rebound [s]; -∞ before the first one
        // With implicit friction only, else zero:
        double t;  ///< time of the node [s]
        /// Elastic displacement along T [m]: S of sliding, Z of rolling; 1 if slipping, else 0
        struct Pair {
            Eigen::Matrix<double, 2, 1, Eigen::DontAlign> S;
            double slipping;
        } sliding, rolling;
    };
    static_assert(reals<NodeState>() == 6 + 2 + 2 * 3, "NodeState must not have padding");
    int internal_states() const override
    {
        return reals<NodeState>() + (other_points ? reals<OtherPoints::Pose>() : 0);
    }

    /// Modes of the contact. `active` and `inactive` alternate in a unilateral contact.
    enum Mode {
        active = Constraint::active,
        inactive = 1,        ///< an open unilateral contact; it may become active again
        fallback_active = 2  ///< replaced by a contact force until the end of the run
    };
    int mode_if_redundant() const override { return fallback ? fallback_active : active; }

    void phi(const Arguments& x, double* out) const override;
    void variation(const Arguments& x, Derivatives& out) const override;
    void gamma(const Arguments& x, double* out) const override;
    unsigned nonzero(int row) const override;
    void set_pairs(const Arguments& x, lie::BoundedPair* out) const override;
    void set_static_pairs(const Arguments& x, const bool* at_rest, double* internal_state) const override;
    void check_derivatives(dae::DerivativeFindings& out) const override;
    void update_alpha(const Arguments& x, bool global_search, double* alpha) const override;
    int update_mode(const Arguments& x, bool start, double* internal_state) const override;
    std::string start_error(const Arguments& x) const override;
    /// The mode is fallback_active if start_error() has a reason and there is a fallback. A unilateral
    /// contact starts inactive if it has a gap, or if its gap is zero and changes.
    int start(const Arguments& x, double* alpha) const override;
    /// |gap|, at most 1e-6 L
    Violation position_violation(const Arguments& x, double tolerance) const override;
    /// Normal velocity, and the slip velocity of ideal rolling [m/s]
    Violation velocity_violation(const Arguments& x, double tolerance) const override;
    std::string label() const override { return "contact '" + name + "'"; }
    std::string row_name(int row) const override;

    /// Signed distance of the two bodies in these poses, without α [m]. Throws lie::NumericalFailure.
    double distance(const Motion& bi, const Motion& bj) const
    {
        return detector->detect(bi, bj, nullptr).gap;
    }
    /// Signed distance of the two bodies at the points α [m], negative for an overlap
    double gap(const Arguments& x) const { return contact_point(x).gap; }
    /// Time derivative of the gap [m/s]
    double separation_speed(const Arguments& x) const;

    /// The contact point at α of x. The normal is that of surface j, which points into body i; the gap is the
    /// component of C_i - C_j along it.
    ContactPoint contact_point(const Arguments& x) const;
    /// The multipliers of this contact, extracted from those of the model
    struct Multipliers {
        using Vec2 = Eigen::Vector2d;

        Vec3 Psi = Vec3::Zero();                  ///< λ_Ψ [N, global axes]
        Vec2 N = Vec2::Zero(), G = Vec2::Zero();  ///< λ_N, λ_G [N]
        /// λ of the two rows of ideal rolling or of implicit sliding friction, along T' [N]
        Vec2 rolling = Vec2::Zero();
        double F_N = 0;                  ///< normal force λ_Ψ · n_i [N]
        Vec3 tangential = Vec3::Zero();  ///< λ_Ψ - F_N n_i [N]; zero up to rounding
        Vec3 friction = Vec3::Zero();    ///< friction force of these rows on body i [N, global axes]
        Vec2 resistance = Vec2::Zero();  ///< λ_R, rolling resistance of implicit friction [N]
    };
    Multipliers multipliers(const Arguments& x, const Eigen::VectorXd& lambda) const;

    const Shape shape_i, shape_j;
    const double L;  ///< smaller size of the two surfaces [m]
    const Friction friction;
    const ImplicitFriction law;  ///< used if friction == Friction::implicit
    const NormalRows normal_rows;
    const Unilateral unilateral;
    /// Whether a ContactForce replaces this constraint when the contact point is not unique or the multiplier
    /// is indeterminate. To be set before the contact is added to a model.
    bool fallback = false;

private:
    EvolvingContact(int i, const Shape& shape_i, int j, const Shape& shape_j, Friction friction,
                    const ImplicitFriction& law, NormalRows normal_rows, const Unilateral& unilateral);

    struct Side;
    Mat32 tangents(const Arguments& x) const;
    /// T' = (I - n nᵀ) T: the tangent basis of the node projected on the tangent plane of the normal n
    Mat32 projected_tangents(const Arguments& x, const Vec3& n) const;
    enum RowPair { sliding_pair = 0, rolling_pair = 1 };
    /// (K_i + K_j)⁻¹ in the tangent plane of the normal n, as a 3 × 3 matrix in global axes [m]. Its
    /// eigenvalues, the lever arms 1/κ, are limited to 10 L.
    Mat3 lever_arms(const Mat3& K_sum, const Vec3& n) const;
    void update_friction(const Arguments& x, bool start, NodeState& state) const;

    CommonNormal common_normal;
    std::unique_ptr<Detector> detector;
    const std::unique_ptr<const OtherPoints> other_points;  ///< nullptr for a pair with one contact point
};

}  // namespace hilda::contact
