// SPDX-License-Identifier: GPL-3.0-or-later
/// The equations of motion in Euler parameters, F(t, y, ẏ) = 0, and their Jacobian.          Fang (2022), Eq. 2.23

#pragma once

#include "lie/euler_parameters.hpp"
#include "lie/solver/newton_matrix.hpp"
#include "lie/system.hpp"

namespace hilda::reference {

using VectorRef = Eigen::Ref<Eigen::VectorXd>;
using ConstVectorRef = Eigen::Ref<const Eigen::VectorXd>;

/// What is asked of the constraints
enum class RpForm {
    ggl,  ///< Φ = 0 and Φ̇ = 0, with multipliers μ that keep both (Gear, Gupta, Leimkuhler 1985): index 2
    baumgarte,  ///< Φ̈ + 2α Φ̇ + α² Φ = 0: index 1, drift is damped
    index1      ///< Φ̈ = 0: drift grows
};

/// Unknowns are r, p, ṙ, ṗ of each body, then λ, λ_P; with GGL also μ, μ_P. P are the rows ½(pᵀp - 1) = 0. With
///
///     A = A(p/|p|),   T = 2 G(p)/|p|²,   ω̄ = T ṗ,   ω̄̇ = T p̈,   Φ_p = Π̄ T
///
/// the equations are
///
///     ṙ - v + Φ_rᵀ μ = 0,   ṗ - u + Φ_pᵀ μ + p μ_P = 0             (v, u for ṙ, ṗ as unknowns; μ only with GGL)
///     M v̇ + Φ_rᵀ λ - F = 0,   Tᵀ (J̄ T u̇ + Π̄ᵀ λ - n̄ + ω̄ × J̄ ω̄) + p λ_P = 0
///
/// and the constraints by RpForm. The rotational one is 2.23's, 4 Gᵀ J̄ G p̈ - 8 Ġᵀ J̄ Ġ p + ..., up to a multiple
/// of p, which here makes λ_P zero. A(p/|p|) turns as Tṗ also where |p| is not one, so the Jacobian is exact
/// off the constraints too.
class RpEquations {
public:
    /// Takes from `start` what the system remembers. `alpha` [1/s] is Baumgarte's. The system must outlive the
    /// equations.
    RpEquations(const lie::System& system, const lie::State& start, RpForm form = RpForm::ggl,
                double alpha = 20);

    int size() const { return first_mu + (form == RpForm::ggl ? m + bodies : 0); }

    /// y and ẏ of a state that comes with its accelerations and multipliers; what it remembers is kept.
    void write(const lie::State& x, VectorRef y, VectorRef ydot);
    /// r, A, ṙ, ω̄ at t; the rest of x stays.
    void read(double t, const ConstVectorRef& y, lie::State& x) const;

    /// Takes over what the system remembers, and says whether the equations at y go on as they were: a driver
    /// that is swapped ends them, a turn that is counted does not.
    bool set_discrete_state(const std::vector<int>& discrete_state, double t, const ConstVectorRef& y,
                            const ConstVectorRef& ydot);

    void residual(double t, const ConstVectorRef& y, const ConstVectorRef& ydot, VectorRef F);
    /// ∂F/∂y + c_j ∂F/∂ẏ, in compressed columns of a fixed pattern, for μ = 0: they are zero but for what a
    /// step is off by, and what they add would fill the factors.
    const lie::Klu& jacobian(double t, const ConstVectorRef& y, const ConstVectorRef& ydot, double c_j);
    const lie::Klu& pattern() const { return J.compressed(); }

    /// What unknown k is, for whoever weighs errors
    enum class Kind { position, velocity, lambda, mu };
    Kind kind(int k) const;
    /// Which equation k is, for messages: rotation of body 'crank'
    std::string name(int k) const;

    const lie::System& system;
    const RpForm form;
    const double alpha;

private:
    /// A body's part of y and ẏ, and what follows from it
    struct Body {
        lie::Vec4 p, pdot, pddot;
        double p2;           ///< pᵀp
        lie::Mat34 T;        ///< δπ̄ = T δp
        lie::Vec3 rddot, w;  ///< w = T p̈
    };
    /// Where the derivatives of one entry of the constraint rows stand; -1 where it has none
    struct Slots {
        int force[3], torque;                ///< Φ_rᵀ, Φ_pᵀ beside λ
        int drift[3], turn;                  ///< the same beside μ
        int r[3], p;                         ///< Φ_r, Φ_p in the rows of Φ
        int q_r[3], q_p, qdot_r[3], qdot_p;  ///< derivatives of the rows of Φ̇ or Φ̈
    };
    struct BodySlots {
        int r_r, r_v, p_p, p_u, v_v, u_p, u_u, u_lambda, p_mu;
        int norm_p, norm_q, norm_qdot;  ///< ½(pᵀp - 1), and its derivative in time
    };
    /// Two bodies of a row: how the loads of the constraints on one change with the position of the other
    struct Pair {
        int on = 0, by = 0;
        bool nonzero[2][2] = {};  ///< quarters of the block: of r or π̄ on, by r or θ
        int slot[2][2] = {};
        lie::Mat6 value = lie::Mat6::Zero();
    };
    struct LoadSlots {
        int q, qdot;
    };

    void declare();
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
    int at(int b) const { return 14 * b; }

    const int bodies, m;
    const int first_lambda, first_mu;  ///< λ, then λ_P; μ, then μ_P

    lie::State x;
    std::vector<Body> body;
    lie::Rows C;
    lie::Loads load;
    Eigen::VectorXd by_lambda, by_mu;        ///< (Φ_rᵀ, Π̄ᵀ) λ and μ, six numbers a body
    Eigen::VectorXd velocity, acceleration;  ///< (ṙ, ω̄) and (r̈, ω̄̇)
    Eigen::VectorXd Phi, nu, gamma;

    lie::SecondVariation H;
    lie::Rows nu_change;
    lie::GammaVariation gamma_change;
    lie::LoadVariation load_change;

    lie::NewtonMatrix J;
    std::vector<Slots> slots;
    std::vector<BodySlots> body_slots;
    std::vector<Pair> pair;
    std::vector<int> pair_of;  ///< of each block of H
    std::vector<LoadSlots> load_slots;
};

}  // namespace hilda::reference
