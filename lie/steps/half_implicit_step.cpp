// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/half_implicit_step.hpp"

#include "lie/check.hpp"
#include "lie/system.hpp"

#include <cmath>
#include <utility>

namespace hilda::lie {

HalfImplicitStep::HalfImplicitStep(const System& model, const Settings& settings, std::string name, double w,
                                   double q, ImplicitSprings::Rule rule)
    : HalfImplicitStep(model, settings, std::move(name), w, q, ImplicitSprings(model, rule))
{}

HalfImplicitStep::HalfImplicitStep(const System& model, const Settings& settings, std::string name, double w,
                                   double q, ImplicitSprings implicit_springs)
    : SaddleStep(model, settings, implicit_springs.rows()), name(std::move(name)), w(w), q(q),
      springs(std::move(implicit_springs)), C_n(K.rows()), friction(model), z_before(K.size()),
      Phi(model.rows()), lambda(K.rows().rows()), anderson(K.size(), 6 * bodies),
      corrects_velocity_rows(model.keeps_redundant_rows() && K.rows().velocity_rows > 0),
      accelerates(model.pattern().algebraic.empty() && model.pattern().regularised.empty())
{}

int HalfImplicitStep::step(State& x, double h)
{
    x_n = x;
    Attempt attempt(x, x_n);
    begin(h);
    friction.start(x_n, h);
    start_springs(x_n, h);
    K.set_shift(shift(h));
    K.assemble(x_n, friction.compliance());  // the Newton matrix of t_n (Eqs. 3.32, 3.51)
    set_known_part(h);
    predict(h);
    x.t = x_n.t + h;
    refreshed = false;
    int corrections = 0;
    for (int solved = 0; solved <= most_solved; ++solved) {
        corrections += solve(x);
        if (friction.within_bounds(K, z, w * settings.tolerance)) {
            accept(x, h);
            return done(attempt, corrections);
        }
        if (refreshed) C_n.regularise(friction.compliance());
    }
    friction.fail(K, z);
}

void HalfImplicitStep::choose_pivots(const State& x, double h)
{
    friction.start(x, h);
    start_springs(x, h);
    K.choose_pivots(x, friction.compliance());
}

void HalfImplicitStep::start_springs(const State& x, double h)
{
    if (springs.empty()) return;
    springs.start(x, h);
    K.set_springs(springs.rows(), springs.compliance());
}

HalfImplicitStep::Vec6 HalfImplicitStep::velocity(int i) const
{
    Vec6 v;
    v << x_n.body[i].rdot, x_n.body[i].omega_bar;
    return v;
}

void HalfImplicitStep::leave(State& x, double h)
{
    for (int i = 0; i < bodies; ++i) {
        x.body[i].rdot = z.segment<3>(6 * i) / h;
        x.body[i].omega_bar = z.segment<3>(6 * i + 3) / h;
    }
}

Vec3 HalfImplicitStep::known_moment(int i, double h) const
{
    return h * (mass.J_bar[i] * (velocity(i).tail<3>() - (w - 1) * h * x_n.body[i].omegadot_bar)) +
           w * h * h * tau_bar(i, node().body[i]);
}

void HalfImplicitStep::correct(int k, const State& x)
{
    if (k == 1) set_linear_residual(rows_of_node());
    set_constraint_residual(k, x, q);
    if (k == 1)
        K.solve(e);
    else
        K.solve_constraints(e);
    z += e;
}

/// Newton's method from the present z. Returns the number of corrections.
int HalfImplicitStep::solve(State& x)
{
    if (K.algebraic_part(z).size() == 0) return newton(x);
    z_start = z;
    try {
        return newton(x);
    } catch (const NumericalFailure&) {
        z = z_start;
        const int corrections = newton_with_contact_points(x);
        if (corrections == 0) throw;
        return settings.max_iterations + corrections;
    }
}

int HalfImplicitStep::newton(State& x)
{
    for (int k = 1; k <= most_iterations; ++k) {
        place(x);
        place_algebraic(x, 1 / q);
        if (k > patience && (!accelerates || (k - patience) % accelerated == 1)) refresh(x), anderson.start();
        const bool is_slow = k > patience && accelerates;
        if (is_slow) z_before = z;
        correct(refreshed || corrects_velocity_rows ? 1 : k, x);
        if (converged(k, length(), K.constraint_part(e).head(model.rows()), 1 / w)) return k;
        if (!is_slow) continue;
        anderson.accelerate(z_before, e);
        z = z_before + e;
    }
    no_convergence(name, correction, x);
}

/// Newton's method with K of t_n in which the algebraic variables follow from the poses after each
/// correction. They need no initial guess then: contact points that move far over a body in a step, as those
/// of a ball that rolls by half a radian, are found. A correction that increases |Φ| is halved.
///
/// Returns 0 if the iteration fails. It also fails if it converges slowly: the force acts along the normal of
/// t_n, and the normal turns too far in the step then, as where a contact point jumps across a flat face, and
/// the solution would gain energy.
int HalfImplicitStep::newton_with_contact_points(State& x)
try {
    place(x);
    place_algebraic(x, 1 / q);
    if (!find_contact_points(x)) return 0;
    if (refreshed) {
        refreshed = false;
        K.assemble(x_n, friction.compliance());
    }
    for (int k = 1; k <= settings.max_iterations; ++k) {
        model.phi(x, Phi);
        const double before = Phi.norm();
        z_before = z;
        correct(1, x);
        double fraction = 1;
        for (int half = 0;; ++half, fraction *= 0.5) {
            if (half > max_halvings) return 0;
            z = z_before + fraction * e;
            place(x);
            place_algebraic(x, 1 / q);
            if (!find_contact_points(x)) continue;
            model.phi(x, Phi);
            if (k == 1 || Phi.norm() < before || fraction * length() < settings.tolerance) break;
        }
        e *= fraction;
        K.algebraic_part(e) = K.algebraic_part(z) - K.algebraic_part(z_before);
        const double last = correction;
        if (converged(k, length(), K.constraint_part(e).head(model.rows()), 1 / w) && fraction == 1) return k;
        if (k == 3 && correction > slow * last) return 0;
    }
    return 0;
} catch (const NumericalFailure&) {
    return 0;
}

/// Computes the algebraic variables of x from its poses, and sets their part of z. Returns false if there are
/// none.
bool HalfImplicitStep::find_contact_points(State& x)
{
    try {
        model.update_alpha(x);
    } catch (const NumericalFailure&) {
        return false;
    }
    take_algebraic(x, q);
    return true;
}

void HalfImplicitStep::set_known_part(double h)
{
    model.loads(node(), loads);
    for (int i = 0; i < bodies; ++i) {
        b.segment<3>(6 * i) = h * mass.m[i] * (velocity(i).head<3>() - (w - 1) * h * x_n.body[i].rddot) +
                              w * h * h * loads.F[i];
        b.segment<3>(6 * i + 3) = known_moment(i, h);
    }
    K.constraint_part(b).setZero();
    K.algebraic_part(b).setZero();
    if (K.rows().velocity_rows > 0) set_nonholonomic_part(h);
    friction.set_right_side(K.constraint_part(b));
    if (!springs.empty()) set_spring_part(h);
}

void HalfImplicitStep::set_spring_part(double h)
{
    for (int i = 0; i < bodies; ++i) {
        z.segment<6>(6 * i) = h * velocity(i);
        const Motion& body = node().body[i];
        e.segment<6>(6 * i) << h * body.rdot, h * body.omega_bar;
    }
    springs.set_right_side(z, e, K.constraint_part(b).tail(K.rows().springs));
}

/// The nonholonomic rows require C_n (v + v_{n+1}) = 2 ν. This is of second order if v and v_{n+1} are the
/// velocities half a step before and after t_n.
void HalfImplicitStep::set_nonholonomic_part(double h)
{
    for (int i = 0; i < bodies; ++i) z.segment<6>(6 * i) = h * velocity(i);
    model.nu(x_n, K.constraint_part(e).head(model.rows()));
    const Rows& C = K.rows();
    for (int k = C.position_rows(); k < model.rows(); ++k)
        K.constraint_part(b)[k] = 2 * h * K.constraint_part(e)[k] - C.dot(k, z);
}

/// Initial guess from the accelerations and multipliers of the previous step                         Eq. 3.34
void HalfImplicitStep::predict(double h)
{
    for (int i = 0; i < bodies; ++i) {
        const Motion& body = x_n.body[i];
        z.segment<6>(6 * i) = h * velocity(i);
        z.segment<3>(6 * i) += h * h * body.rddot;
        z.segment<3>(6 * i + 3) += h * h * body.omegadot_bar;
    }
    K.constraint_part(z).head(model.rows()) = w * h * h * x_n.lambda;
    K.constraint_part(z).tail(K.rows().springs).setZero();
    K.algebraic_part(z).setZero();
}

/// Norm of the correction in r, θ̄ and α, the unknowns of Eqs. 3.27 and 3.43
double HalfImplicitStep::length()
{
    double sum = K.algebraic_part(e).squaredNorm() / (q * q);
    for (int i = 0; i < bodies; ++i)
        sum += e.segment<3>(6 * i).squaredNorm() / (q * q) + e.segment<3>(6 * i + 3).squaredNorm();
    return std::sqrt(sum);
}

/// Assembles K at the iterate x. Used when the iteration with K of t_n converges too slowly.
void HalfImplicitStep::refresh(const State& x)
{
    if (!refreshed) C_n = K.rows();
    refreshed = true;
    K.assemble(x, friction.compliance());
}

void HalfImplicitStep::accept(State& x, double h)
{
    place(x);
    place_algebraic(x, 1 / q);
    lambda = K.constraint_part(z) / (w * h * h);
    b.setZero();
    rows_of_node().add_transpose(1, lambda, b);
    if (K.keeps_redundant_rows()) {
        K.minimise_multipliers(z);
        lambda = K.constraint_part(z) / (w * h * h);
    }
    x.lambda = lambda.head(model.rows());
    for (int i = 0; i < bodies; ++i) {
        Motion& body = x.body[i];
        body.A = orthonormalised(body.A);
        body.rddot = (loads.F[i] - b.segment<3>(6 * i)) / mass.m[i];  // Eqs. 3.24, 3.39
        body.omegadot_bar = J_bar_inverse[i] * (tau_bar(i, node().body[i]) - b.segment<3>(6 * i + 3));
    }
    leave(x, h);
}

}  // namespace hilda::lie
