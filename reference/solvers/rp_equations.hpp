// SPDX-License-Identifier: GPL-3.0-or-later
/// Equations of motion in Euler parameters, F(t, y, ẏ) = 0, and their Jacobian.         Fang (2022), Eq. 2.23

#pragma once

#include "lie/euler_parameters.hpp"
#include "lie/solver/newton_matrix.hpp"
#include "lie/system.hpp"

namespace hilda::reference {

using VectorRef = Eigen::Ref<Eigen::VectorXd>;
using ConstVectorRef = Eigen::Ref<const Eigen::VectorXd>;

/// Form of the constraint equations (index reduction and stabilisation)
enum class RpForm {
    ggl,  ///< Φ = 0 and Φ̇ = 0 with additional multipliers μ (Gear, Gupta, Leimkuhler 1985): index 2
    baumgarte,  ///< Φ̈ + 2α Φ̇ + α² Φ = 0 (Baumgarte 1972): index 1, the drift is damped
    index1      ///< Φ̈ = 0: index 1, the drift grows
};

/// Residual and Jacobian of the equations of motion.
///
/// The unknowns y are r - r_0, p, ṙ, ṗ of each body (14 numbers), then λ and λ_P, and with RpForm::ggl also
/// μ and μ_P. λ_P and μ_P belong to the normalisation ½(pᵀp - 1) = 0 of each body.
///
/// r_0 is the origin of the unknowns. It is zero unless all bodies are far from the origin of the model at
/// the start compared with their distances from each other; it is then near them. The predictions and
/// differences of y would otherwise lose the digits of r_0.
///
/// With
///
///     A = A(p/|p|),   T = 2 G(p)/|p|²,   ω̄ = T ṗ,   ω̄̇ = T p̈,   Φ_p = Π̄ T
///
/// the equations are
///
///     ṙ - v + Φ_rᵀ μ = 0,   ṗ - u + ρ⁻² Φ_pᵀ μ + p μ_P = 0      (v, u for ṙ, ṗ as unknowns; μ only with GGL)
///     M v̇ + Φ_rᵀ λ - F = 0,   Tᵀ (J̄ T u̇ + Π̄ᵀ λ - n̄ + ω̄ × J̄ ω̄) + p λ_P = 0
///
/// followed by the constraint equations of RpForm. The rotational equation is that of 2.23, 4 Gᵀ J̄ G p̈ - 8
/// Ġᵀ J̄ Ġ p + ..., up to a multiple of p. With this choice λ_P = 0 in the solution. ω̄ = T ṗ is the angular
/// velocity of A(p/|p|) for any |p|, so the Jacobian is exact off the constraint |p| = 1 as well.
///
/// y and F have the unit of length ρ, and multipliers and rows of Φ units with which all numbers are those of
/// a model of 1 m. The units are powers of two.
class RpEquations {
public:
    /// Copies the internal and discrete states of `start`. `alpha` [1/s] is the parameter of Baumgarte's
    /// stabilisation. The system must outlive the equations.
    RpEquations(const lie::System& system, const lie::State& start, RpForm form = RpForm::ggl,
                double alpha = 20);

    int size() const { return first_mu + (form == RpForm::ggl ? m + bodies : 0); }

    /// Computes y and ẏ from a state with accelerations and multipliers (μ = 0), and copies its internal and
    /// discrete states. y and ẏ have size() components.
    void write(const lie::State& x, VectorRef y, VectorRef ydot);
    /// Sets t, r, A, ṙ, ω̄ of x from y. The other members of x are unchanged.
    void read(double t, const ConstVectorRef& y, lie::State& x) const;

    /// Replaces the discrete states. Returns whether constraint derivatives and loads at (t, y, ẏ) are
    /// unchanged: false after a change of the branch of a driver, true after a turn has been counted.
    bool set_discrete_state(const std::vector<int>& discrete_state, double t, const ConstVectorRef& y,
                            const ConstVectorRef& ydot);

    /// Replaces the internal states, which must not change the solutions.
    void set_internal_state(const std::vector<double>& internal_state) { x.internal_state = internal_state; }

    /// F(t, y, ẏ), size() components
    void residual(double t, const ConstVectorRef& y, const ConstVectorRef& ydot, VectorRef F);
    /// ∂F/∂y + c_j ∂F/∂ẏ in compressed columns with a fixed pattern, evaluated with μ = 0. μ is zero up to
    /// the error of a step, and the terms omitted would increase the fill-in of the factors.
    const lie::Klu& jacobian(double t, const ConstVectorRef& y, const ConstVectorRef& ydot, double c_j);
    const lie::Klu& pattern() const { return J.compressed(); }

    /// Type of an unknown; IdaSolver selects the error weights by it
    enum class UnknownType { position, velocity, lambda, mu };
    UnknownType unknown_type(int k) const;
    /// Name of equation k for messages, e.g. rotation of body 'crank'
    std::string name(int k) const;

    const lie::System& system;
    const RpForm form;
    const double alpha;
    const lie::Vec3 origin;  ///< r_0 [m]
    /// ρ [m], the unit of length of y and F: 1, or a mean radius of gyration of the bodies if that is beyond
    /// 1 cm to 100 m
    const double length;

private:
    /// Unknowns of a body and quantities derived from them
    struct Body {
        lie::Vec4 p, pdot, pddot;
        double p2;           ///< pᵀp
        lie::Mat34 T;        ///< δπ̄ = T δp
        lie::Vec3 rddot, w;  ///< w = T p̈, equal to ω̄̇
    };
    /// Handles of the Jacobian blocks of one entry of the constraint rows; -1 if the block is zero
    struct Slots {
        int force[3], torque;                ///< Φ_rᵀ, Φ_pᵀ, columns of λ
        int mu_force[3], mu_torque;          ///< Φ_rᵀ, Φ_pᵀ, columns of μ
        int r[3], p;                         ///< Φ_r, Φ_p in the rows of Φ
        int q_r[3], q_p, qdot_r[3], qdot_p;  ///< derivatives of the rows of Φ̇ or Φ̈ by q and q̇
    };
    /// Handles of the Jacobian blocks of one body
    struct BodySlots {
        int r_r, r_v, p_p, p_u, v_v, u_p, u_u, u_lambda, p_mu;
        int norm_p, norm_q, norm_qdot;  ///< rows of ½(pᵀp - 1) and of its time derivative
    };
    /// Derivative of the constraint forces on one body by the position of another body of the same row
    struct Pair {
        int on = 0, by = 0;
        bool nonzero[2][2] = {};  ///< 3×3 quarters of the 6×6 block: (force, torque) by (r, θ̄)
        int slot[2][2] = {};
        lie::Mat6 value = lie::Mat6::Zero();
    };
    /// Handles of the Jacobian blocks of a load variation
    struct LoadSlots {
        int q, qdot;
    };

    void residual_in_SI(double t, const ConstVectorRef& y, const ConstVectorRef& ydot, VectorRef F);
    void declare_pattern();
    void declare_entry(int k, int n);
    void find_pairs();
    void declare_pairs();
    void evaluate(double t, const ConstVectorRef& y, const ConstVectorRef& ydot);
    void add_bodies(const ConstVectorRef& y, double c_j);
    void add_rows(double c_j);
    void add_pairs();
    void add_loads();
    template <class Block>
    void add(int handle, const Eigen::MatrixBase<Block>& block)
    {
        J.add(handle, block.eval());
    }
    void add(int handle, double entry) { J.add(handle, entry); }
    int offset(int b) const { return 14 * b; }
    void set_units(const lie::State& at);
    /// y in SI units; `work` keeps it
    Eigen::Map<const Eigen::VectorXd> in_SI(const ConstVectorRef& y, Eigen::VectorXd& work) const;
    bool has_units() const { return length != 1; }

    const int bodies, m;
    const double mu_of_rotation;       ///< 1/ρ² [1/m²]
    const int first_lambda, first_mu;  ///< λ, then λ_P; μ, then μ_P
    /// Units of y, and factors of F; with has_units()
    Eigen::VectorXd unit_of_unknown, factor_of_equation;
    Eigen::VectorXd y_SI, ydot_SI;

    lie::State x;
    std::vector<Body> body;
    lie::Rows C;
    lie::Loads load;
    Eigen::VectorXd force_lambda, force_mu;  ///< (Φ_rᵀ, Π̄ᵀ) λ and (Φ_rᵀ, Π̄ᵀ) μ, six numbers per body
    Eigen::VectorXd velocity, acceleration;  ///< (ṙ, ω̄) and (r̈, ω̄̇)
    Eigen::VectorXd Phi, nu, gamma;

    lie::SecondVariation H;
    lie::Rows d_nu;
    lie::GammaVariation d_gamma;
    lie::LoadVariation d_load;

    lie::NewtonMatrix J;
    std::vector<Slots> slots;
    std::vector<BodySlots> body_slots;
    std::vector<Pair> pair;
    std::vector<int> pair_of;  ///< index of the pair of each block of H
    std::vector<LoadSlots> load_slots;
};

}  // namespace hilda::reference
