// SPDX-License-Identifier: GPL-3.0-or-later
/// Two bodies that stay in contact, with the contact points as unknowns: no collision is looked for.
///                                                                            Fang (2022), Secs. 5.1, 5.3

#pragma once

#include "contact/detection/common_normal.hpp"
#include "contact/detection/detector.hpp"
#include "contact/evolving/implicit_friction.hpp"
#include "contact/shape.hpp"
#include "dae/model.hpp"

namespace hilda::contact {

/// What happens where the bodies would be pulled together, and where they meet
struct Unilateral {
    bool enabled = false;    ///< else the contact holds both ways and never ends
    double restitution = 0;  ///< e, 0 … 1
    enum class Impact {
        newton,  ///< the velocity of separation is e times that of approach
        poisson  ///< the impulse of restitution is e times that of compression
    } impact = Impact::newton;
};

/// Seven rows and six massless unknowns, the contact points ᾱ_i and ᾱ_j in the frames of their bodies:
///
///     Ψ = r_i + A_i ᾱ_i - r_j - A_j ᾱ_j             the contact points coincide, three rows            (5.12)
///     N = L Tᵀ (A_i n̄_i + A_j n̄_j)                  the normals are opposite, two rows                 (5.17)
///     G = G_i(ᾱ_i)/|∇G_i|,  G_j(ᾱ_j)/|∇G_j|         the points lie on the surfaces, two rows          (5.27)
///
/// One degree of freedom less, that along the normal. n̄ is the unit normal out of the body, σ ∇G/|∇G|. T is a tangent
/// basis of A_i n̄_i at the last node, and L the smaller size of the two surfaces, so that all rows are lengths and
/// conditioning does not depend on size. (5.17) projects on the global x and y instead, and is singular for a normal
/// in that plane; NormalRows::fixed_xy shows it.
///
/// The multipliers (Ψ, N, G) are forces. Where the relative curvature K_i + K_j is regular in the tangent plane,
///
///     λ_N = 0,    λ_Ψ = F_N A_i n̄_i,    λ_G = -F_N (σ_i, σ_j)
///
/// with the normal force F_N, positive in compression: -λ_Ψ pushes body i. |λ_N| > 0 tells that the normals given are
/// not those of the surface.
class EvolvingContact final : public dae::Constraint {
public:
    enum class NormalRows { tangent, fixed_xy };
    enum class Friction {
        none,  ///< or one that a force adds
        rolling,  ///< ideal: the material points in contact have one velocity, two rows more          (non-holonomic)
        implicit  ///< that of Chapter 4 in the equations of the step: those two rows give way, and two more of rolling
    };

    /// Bodies i and j of the model, `ground` for the fixed one. InvalidInput for two planes, and for e outside 0 … 1.
    EvolvingContact(int i, const Shape& shape_i, int j, const Shape& shape_j,
                    Friction friction = Friction::none, NormalRows normal_rows = NormalRows::tangent,
                    const Unilateral& unilateral = {});
    /// With friction that is implicit
    EvolvingContact(int i, const Shape& shape_i, int j, const Shape& shape_j,
                    const ImplicitFriction& friction, NormalRows normal_rows = NormalRows::tangent,
                    const Unilateral& unilateral = {});

    int rows() const override { return 7; }
    int velocity_rows() const override
    {
        return friction == Friction::none ? 0 : law.resists_rolling() ? 4 : 2;
    }
    bool is_regularised() const override { return friction == Friction::implicit; }
    bool solved_first(int pair) const override { return pair == rolls; }
    int unknowns() const override { return 6; }
    /// T by columns, and when it last rebounded [s]; of implicit friction the instant of this [s], and of sliding and rolling
    /// S or Z along T [m] and whether it slips
    int internal_states() const override { return is_regularised() ? 14 : 7; }
    static constexpr int rebounded = 6, instant = 7, slides_by = 8, rolls_by = 11;
    bool may_be_inactive() const override { return unilateral.enabled || fallback; }
    bool has_fallback() const override { return fallback; }

    void phi(const At& x, double* out) const override;
    void variation(const At& x, Derivatives& out) const override;
    void gamma(const At& x, double* out) const override;
    unsigned nonzero(int row) const override;
    void compliance(const At& x, lie::Rows::Regularised* out) const override;
    void update_alpha(const At& x, bool afresh, double* alpha) const override;
    bool update_internal_state(const At& x, bool start, double* internal_state) const override;
    double gap(const At& x) const override { return contact_point(x).gap; }
    double separation_speed(const At& x) const override;
    bool is_unilateral() const override { return unilateral.enabled; }
    double velocity_error(const At& x) const override;
    double allowance() const override { return 1e-6 * L; }
    std::string objection(const At& x) const override;
    std::string row_name(int row) const override;

    /// The touch that α says: its points, the normal into body i, gap along it, shape operators
    ContactPoint contact_point(const At& x) const;
    /// Multipliers of this contact out of those of a model: λ_Ψ [N, global], λ_N, λ_G, those of rolling [N]
    struct Multipliers {
        using Vec2 = Eigen::Vector2d;

        Vec3 Psi = Vec3::Zero();
        Vec2 N = Vec2::Zero(), G = Vec2::Zero();
        Vec2 rolling = Vec2::Zero();     ///< or of implicit friction
        double F_N = 0;                  ///< λ_Ψ · n_i [N]
        Vec3 tangential = Vec3::Zero();  ///< λ_Ψ - F_N n_i, zero but for rounding
        Vec3 friction = Vec3::Zero();    ///< of rolling or of implicit friction, on body i [N, global]
        Vec2 resistance = Vec2::Zero();  ///< λ_R of implicit friction [N]
    };
    Multipliers multipliers(const At& x, const Eigen::VectorXd& lambda) const;

    const Shape shape_i, shape_j;
    const double L;  ///< [m]
    const Friction friction;
    const ImplicitFriction law;  ///< where friction is implicit
    const NormalRows normal_rows;
    const Unilateral unilateral;
    /// Whether a ContactForce stands by where there is no single contact point, or where the force of this contact is not
    /// determined: to be set before the contact becomes part of a model.
    bool fallback = false;

private:
    EvolvingContact(int i, const Shape& shape_i, int j, const Shape& shape_j, Friction friction,
                    const ImplicitFriction& law, NormalRows normal_rows, const Unilateral& unilateral);

    struct Side;
    using Mat32 = Eigen::Matrix<double, 3, 2>;
    Mat32 tangents(const At& x) const;
    /// T of the node, put into the plane across n
    Mat32 tangents_across(const At& x, const Vec3& n) const;
    enum Pair { slips = 0, rolls = 1 };
    /// (K_i + K_j)⁻¹ in the tangent plane of global axes, 1/κ no longer than ten times L
    Mat3 levers(const Mat3& K_sum, const Vec3& n) const;
    void update_friction(const At& x, bool start, double* internal_state) const;

    CommonNormal common_normal;
    std::unique_ptr<Detector> detector;
};

}  // namespace hilda::contact
