// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-moreau-1: Moreau-Jean time stepping for rigid contacts with Coulomb friction, with joints at position
/// level.                          Moreau (1988); Jean (1999); Acary, Brogliato (2008), Numerical Methods for
///                                 Nonsmooth Dynamical Systems, Ch. 10
///
///     M ṙ_{n+1} + h Φ_rᵀ λ - Σ_c C_cᵀ p_c = M ṙ_n + h F_n,     r_{n+1} = r_n + h ṙ_{n+1}
///     J_r(θ)⁻¹ J̄ ω̄_{n+1} + h Π̄ᵀ λ - Σ_c C_cᵀ p_c = J_r(-θ')⁻¹ J̄ ω̄_n + h n̄_n
///     θ = h ω̄_{n+1},  θ' = h ω̄_n,    A_{n+1} = A_n exp(θ̃)
///     Φ(r_{n+1}, A_{n+1}, t_{n+1}) = 0,     C_b v_{n+1} = ν for nonholonomic rows
///     p_c ∈ K_μ,   û_c = u_c + (μ |u_t| + β) n ∈ K_μ*,   p_c · û_c = 0,   u_c = C_c v_{n+1}
///     β = max(g, 0)/h, or e u_n(v_n) < 0 if the contact closes within the step and if this is smaller
///
/// All rows, the gaps g and the loads are those of t_n. An overlap g < 0 does not enter β: g/h would throw
/// the bodies apart. It is removed at the end of the step by OverlapCorrection, which does not change
/// velocities.
///
/// The rotations are those of rA-half-1-momentum: the angular momentum J_r(θ)⁻¹ J̄ ω̄_{n+1} at the beginning
/// of the step and J_r(-θ')⁻¹ J̄ ω̄_n at the end of the step before belong to the node t_n. They contain the
/// gyroscopic torque. For a free body the angular momentum of the nodes is constant to rounding.
///
/// The unknowns are z = (h v_{n+1}, h² λ). The iteration has the frozen matrix of t_n. Its right side
/// receives -Φ of the iterate, and the difference of the angular momenta J_r(θ)⁻¹ J̄ θ and J̄ θ. Each
/// iteration solves the cone problem again, from its last impulses. Without contact points in reach the
/// matrix is the saddle matrix K.
///
/// The impulses are those of the step to t_{n+1}: λ, r̈ = (ṙ_{n+1} - ṙ_n)/h, ω̄̇ and State::cone_forces of
/// the result are mean values over the step. μ is μ_s for a contact point that did not slip in the step
/// before or is new, and μ_k otherwise. r, A, ṙ, ω̄ and λ are of order 1.

#include "lie/check.hpp"
#include "lie/cones/contact_step.hpp"
#include "lie/cones/overlap_correction.hpp"
#include "lie/schemes.hpp"
#include "lie/steps/saddle_step.hpp"
#include "lie/system.hpp"

#include <string>

namespace hilda::lie {
namespace {

class Moreau1 final : public SaddleStep {
public:
    Moreau1(const System& model, const Settings& settings)
        : SaddleStep(model, settings), contacts(model, of_settings * settings.tolerance, name),
          overlaps(model, settings.tolerance), right(K.size()), before(K.size())
    {}

    int step(State& x, double h) override
    {
        x_n = x;
        Attempt attempt(x, x_n);
        contacts.find(x_n, h);
        set_known_part(h);
        x.t = x_n.t + h;
        int iterations = 0;
        do iterations += solve(x, h);
        while (misses_contacts(x));
        accept(x, h);
        return done(attempt, iterations);
    }

    Statistics statistics() const override
    {
        Statistics all = statistics_with(K);
        contacts.count(all);
        all.overlap = overlaps.remaining();
        all.cone_iterations += overlaps.solver().iterations();
        all.cone_factorizations += overlaps.solver().factorizations();
        return all;
    }

private:
    void set_known_part(double h)
    {
        model.loads(x_n, loads);
        b.setZero();
        for (int i = 0; i < bodies; ++i) {
            const Motion& body = x_n.body[i];
            b.segment<3>(6 * i) = h * mass.m[i] * body.rdot + h * h * loads.F[i];
            b.segment<3>(6 * i + 3) = h * h * loads.n_bar[i] - momentum(i, -h * body.omega_bar);
        }
    }

    /// The solution z with the contact points found, and its poses and velocities in x. Returns the number of
    /// iterations.
    int solve(State& x, double h)
    {
        if (contacts.empty()) {
            K.set_shift(shift(h));
            K.assemble(x_n);
        }
        predict(h, h * h, h * h);
        place_increments(x);
        set_right_side(x, h);
        for (int k = 1; k <= most_iterations; ++k) {
            if (!(contacts.empty() ? correct(k, x, h) : solve_contacts(k, x, h))) continue;
            place_increments(x);
            for (int i = 0; i < bodies; ++i) {
                x.body[i].rdot = z.segment<3>(6 * i) / h;
                x.body[i].omega_bar = z.segment<3>(6 * i + 3) / h;
            }
            return k;
        }
        no_convergence(name, correction, x);
    }

    bool misses_contacts(const State& x)
    {
        return model.has_cones() && contacts.add_missed(x, overlaps.find(x));
    }

    /// The right side of M z_b + C_bᵀ z_λ - h Σ Cᵀ p = …, C_b z_b = … at the iterate
    void set_right_side(const State& x, double h)
    {
        right = b;
        for (int i = 0; i < bodies; ++i) {
            const Vec3 theta = z.segment<3>(6 * i + 3);
            right.segment<3>(6 * i + 3) -= momentum(i, theta) - mass.J_bar[i] * theta;
        }
        if (model.rows() == 0) return;
        const Rows& C = contacts.empty() ? K.rows() : contacts.rows();
        auto of_rows = constraint_part(right);
        model.phi(x, of_rows);
        for (int k = 0; k < C.position_rows(); ++k) of_rows[k] = C.dot(k, z) - of_rows[k];
        if (C.velocity_rows == 0) return;
        auto nu = constraint_part(e);
        model.nu(x, nu);
        of_rows.tail(C.velocity_rows) = h * nu.tail(C.velocity_rows);
    }

    /// A correction of z without contact points. Returns whether it was the last one.
    bool correct(int k, State& x, double h)
    {
        K.multiply(z, e);
        e = right - e;
        K.solve(e);
        z += e;
        if (converged(k, length_of_motion(e), constraint_part(e), 1)) return true;
        place_increments(x);
        set_right_side(x, h);
        return false;
    }

    /// The solution z of the cone problem, and the right side at its poses. Returns whether the right side
    /// has changed by less than the tolerance. z itself may change more: friction can clamp bodies with
    /// joints in several ways.
    bool solve_contacts(int k, State& x, double h)
    {
        z = h * contacts.solve(k == 1, right);
        place_increments(x);
        before = right;
        set_right_side(x, h);
        e = right - before;
        for (int i = 0; i < bodies; ++i) {
            e.segment<3>(6 * i) /= mass.m[i];
            e.segment<3>(6 * i + 3) = J_bar_inverse[i] * e.segment<3>(6 * i + 3);
        }
        return converged(k, e.norm(), constraint_part(e), 0);
    }

    void accept(State& x, double h)
    {
        for (int i = 0; i < bodies; ++i) {
            Motion& body = x.body[i];
            const Motion& before = x_n.body[i];
            body.rddot = (body.rdot - before.rdot) / h;
            body.omegadot_bar = (body.omega_bar - before.omega_bar) / h;
            body.A = orthonormalised(body.A);
        }
        refuse_whole_turns(x, h, name);
        if (contacts.empty()) K.minimise_multipliers(z);
        x.lambda = constraint_part(z) / (h * h);
        contacts.set_forces(x);
        if (model.has_cones() && !overlaps.correct(x, h))
            throw NumericalFailure("cones_not_solved",
                                   std::string(name) +
                                       ": the overlaps of bodies cannot be corrected with closed joints; "
                                       "reduce the step");
    }

    /// Tolerance of the contact law [m/s] for Settings::tolerance [m]
    static constexpr double of_settings = 0.1;
    static constexpr const char* name = "rA-moreau-1";

    ContactStep contacts;
    OverlapCorrection overlaps;
    Eigen::VectorXd right, before;
};

const bool registered_moreau_1 = register_scheme<Moreau1>(
    {.name = "rA-moreau-1",
     .description = "Moreau-Jean time stepping for rigid contacts with Coulomb friction",
     .order = 1,
     .order_lambda = 1,
     .formulation = "rA",
     .unknowns = "h v, h^2 lambda, impulses",
     .uses = newton_options,
     .source = "Moreau (1988), Jean (1999); Acary, Brogliato (2008)",
     .supports = {Feature::nonholonomic, Feature::redundant, Feature::cones, Feature::history},
     .energy_drifts = true});

}  // namespace
}  // namespace hilda::lie
