// SPDX-License-Identifier: GPL-3.0-or-later
/// Base class of the half-implicit schemes: loads and multipliers act at t_n, the constraints hold at
/// t_{n+1}, and the Newton matrix is K of t_n.                                    Fang (2022), Secs. 3.5, 3.6

#pragma once

#include "lie/bounded_rows.hpp"
#include "lie/steps/anderson.hpp"
#include "lie/steps/implicit_springs.hpp"
#include "lie/steps/saddle_step.hpp"

#include <string>

namespace hilda::lie {

/// With v = (ṙ, ω̄) at the beginning of the step, and the weight w of r̈_n in the velocity at its end,
///
///     M v_{n+1} + w h Cᵀ λ_n = M (v - (w - 1) h v̇_{n-1}) + w h (F_n, τ̄_n),     z = (h v_{n+1}, w h² λ_n)
///
/// w = 1 gives the scheme of first order (3.25), w = 3/2 the scheme of second order (3.35). A derived class
/// defines how the positions depend on z. To first order, δ(r, θ̄, α) = δz/q with the number q of the scheme.
class HalfImplicitStep : public SaddleStep {
public:
    int step(State& x, double h) final;

    bool is_staggered() const override { return true; }
    void fill_node(State& node, const State& after) const override { take_loads(node, after); }
    void choose_pivots(const State& x, double h) override;

protected:
    using Vec6 = Eigen::Matrix<double, 6, 1>;

    HalfImplicitStep(const System& model, const Settings& settings, std::string name, double w, double q,
                     ImplicitSprings::Rule rule = ImplicitSprings::Rule::none);

    /// Prepares the data that the scheme carries from step to step, from x_n.history or, at a start, from
    /// x_n.
    virtual void begin(double /*h*/) {}
    /// (ṙ, ω̄) of body i at the beginning of the step
    virtual Vec6 velocity(int i) const;
    /// The node t_n for the evaluation of the loads
    virtual const State& node() const { return x_n; }
    /// Sets r and A of x from x_n and z. The default takes z for the increments of the positions.
    virtual void place(State& x) const { place_increments(x); }
    /// Sets the velocities and the history of x from z.
    virtual void leave(State& x, double h);
    /// The known part of the moment equation of body i: h J̄ (ω̄ - (w - 1) h ω̄̇_{n-1}) + w h² τ̄_n
    virtual Vec3 known_moment(int i, double h) const;
    /// Correction k of z. The rows of the bodies, of the algebraic variables and the nonholonomic rows are
    /// linear in z: from the second correction on their residual is zero. k = 1 solves for the residual of
    /// all equations.
    virtual void correct(int k, const State& x);
    /// Evaluates the implicit springs in the state x, for the next assembly of K.
    void start_springs(const State& x, double h);
    /// The rows of t_n, in whose directions the multipliers act. They differ from the rows of K after a
    /// refresh.
    const Rows& rows_of_node() const { return refreshed ? C_n : K.rows(); }

    const std::string name;
    const double w, q;
    ImplicitSprings springs;

private:
    HalfImplicitStep(const System& model, const Settings& settings, std::string name, double w, double q,
                     ImplicitSprings implicit_springs);
    int solve(State& x);
    int newton(State& x);
    int newton_with_contact_points(State& x);
    bool find_contact_points(State& x);
    void set_known_part(double h);
    void set_nonholonomic_part(double h);
    void set_spring_part(double h);
    void predict(double h);
    double length();
    void refresh(const State& x);
    void accept(State& x, double h);

    static constexpr int patience = 10;     ///< corrections with K of t_n before it is refreshed
    static constexpr int most_solved = 50;  ///< solutions of the step in the search for the compliance scales
    bool refreshed = false;  ///< whether K is that of an iterate; the rows of t_n are then in C_n
    static constexpr int max_halvings = 6;  ///< of a correction
    static constexpr double slow = 0.01;    ///< ratio of two corrections with contact points from the poses
    Rows C_n;
    BoundedRows friction;
    Eigen::VectorXd z_start, z_before, Phi, lambda;
    static constexpr int accelerated = 10;  ///< accelerated corrections before K is refreshed again
    Anderson anderson;
    /// Whether each correction solves all rows. With redundant rows K differs from the matrix of the linear
    /// ones.
    const bool corrects_velocity_rows;
    /// Whether slow corrections are accelerated. With algebraic variables or friction rows, whose scale
    /// differs from that of the bodies, K is refreshed at each iterate.
    const bool accelerates;
};

}  // namespace hilda::lie
