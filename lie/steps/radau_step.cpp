// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/radau_step.hpp"

#include "lie/check.hpp"
#include "lie/steps/projection.hpp"
#include "lie/steps/state_numbers.hpp"
#include "lie/steps/step_control.hpp"
#include "lie/system.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hilda::lie {

namespace {

constexpr int stages = RadauStep::stages;
const double s6 = std::sqrt(6.);
// Cube roots of 81 and 9. p ± iq are the complex eigenvalues of A.
const double root_81 = std::cbrt(81.), root_9 = std::cbrt(9.), p = (12 - root_81 + root_9) / 60,
             q = std::sqrt(3.) * (root_81 + root_9) / 60;

using Weights = std::array<double, stages>;

// Weights of the stages in the error estimate, times h. RADAU5; Hairer, Wanner (1996), Sec. IV.8
const Weights error_weights = {-(13 + 7 * s6) / 3, (-13 + 7 * s6) / 3, -1. / 3};

// An adaptive step ends Newton's method if the estimated error is below this part of the tolerance.
constexpr double newton_goal = 0.01;
constexpr int most_iterations = 10;
// The length of the next step is limited so that the contraction of Newton's method stays near this value.
// It grows with h⁴ where a stiff load turns during the step: the loads across it have the error of h²k/m
// times the square of the angle.
constexpr double largest_contraction = 0.3, most_growth_of_step = 5;

/// Weights of the values at the stages in the quadratic polynomial through them
Weights through_stages(double s)
{
    const double* c = RadauStep::c;
    Weights w{};
    for (size_t i = 0; i < stages; ++i) {
        w[i] = 1;
        for (size_t j = 0; j < stages; ++j)
            if (j != i) w[i] *= (s - c[j]) / (c[i] - c[j]);
    }
    return w;
}

/// Weights of the values at the stages in the cubic polynomial through them and through 0 at s = 0
Weights from_zero(double s)
{
    Weights w = through_stages(s);
    for (size_t i = 0; i < stages; ++i) w[i] *= s / RadauStep::c[i];
    return w;
}

/// ∫ from_zero from 0 to s, by Gauss' formula with two points, which is exact for cubic polynomials
Weights integral_from_zero(double s)
{
    const double offset = s / std::sqrt(12.);
    const Weights one = from_zero(s / 2 - offset), two = from_zero(s / 2 + offset);
    Weights w{};
    for (size_t i = 0; i < stages; ++i) w[i] = s / 2 * (one[i] + two[i]);
    return w;
}

Vec3 combined(const Eigen::MatrixXd& columns, const Weights& w, Eigen::Index at)
{
    return w[0] * columns.col(0).segment<3>(at) + w[1] * columns.col(1).segment<3>(at) +
           w[2] * columns.col(2).segment<3>(at);
}

}  // namespace

const std::string RadauStep::name = "rA-radau-5";
const double RadauStep::c[] = {(4 - s6) / 10, (4 + s6) / 10, 1};
const double RadauStep::A_inverse[][stages] = {{2 + s6 / 2, (-36 + 29 * s6) / 30, (6 - 4 * s6) / 15},
                                               {(-36 - 29 * s6) / 30, 2 - s6 / 2, (6 + 4 * s6) / 15},
                                               {-1 + 8 * s6 / 3, -1 - 8 * s6 / 3, 5}};
const double RadauStep::T[][stages] = {
    {9.1232394870892942792e-2, -0.14125529502095420843, -3.0029194105147424492e-2},
    {0.24171793270710701896, 0.20412935229379993199, 0.38294211275726193779},
    {0.96604818261509293619, 1, 0}};
const double RadauStep::T_inverse[][stages] = {
    {4.3255798900631553510, 0.33919925181580986954, 0.54177053993587487119},
    {-4.1787185915519047273, -0.32768282076106238708, 0.47662355450055045196},
    {-0.50287263494578687595, 2.5719269498556054292, -0.59603920482822492497}};
const double RadauStep::mu = 30 / (6 + root_81 - root_9);
const std::complex<double> RadauStep::mu_complex = 1. / std::complex(p, -q);

RadauStep::RadauStep(const System& model, const Settings& settings)
    : LocalCoordinateStep(model, settings), tangent(model),
      N(tangent, TangentMatrix<double>::Constraints::velocity),
      N_complex(tangent, TangentMatrix<std::complex<double>>::Constraints::velocity),
      real(bodies, model.rows()), complex(bodies, model.rows()), velocity(6 * bodies), nu(model.rows()),
      error(12 * bodies), C(model.pattern())
{
    for (Stages* s : {&last, &now, &change, &residual}) {
        s->q.setZero(6 * bodies, stages);
        s->v.setZero(6 * bodies, stages);
        s->lambda.setZero(model.rows(), stages);
    }
}

int RadauStep::step(State& x, double h)
{
    x_n = x;
    Attempt attempt(x, x_n);
    copy(x, stage);
    const auto numbers = [this](const auto& block) { transfer_stages(block); };
    if (x.history.size() == 0)
        begin_run();
    else
        read_history(x, name, numbers);
    begin_internal_step();
    factor(h);
    predict(h);
    for (int k = 1; k <= settings.max_iterations; ++k) {
        iterate(h);
        real.dlambda = change.lambda.rowwise().norm();
        if (!converged(k, h * change.v.norm(), real.dlambda, h * h)) continue;
        place_stage(x, stages - 1);
        x.t = x_n.t + h;
        assemble_once(x);
        finish(x, name);
        accept_stages(h);
        write_history(x, numbers);
        return done(attempt, k);
    }
    place_stage(x, stages - 1);
    no_convergence(name, correction, x);
}

Statistics RadauStep::statistics() const
{
    Statistics all = statistics_with(K);
    all.refactorizations += N.matrix().factorizations() + N_complex.matrix().factorizations();
    return all;
}

int RadauStep::attempt(State& end, double h, double rtol, double atol, bool again, Eigen::VectorXd& tolerance,
                       double& norm)
{
    unreached = 0;
    copy(x_n, stage);
    set_tolerances(x_n, x_n, rtol, atol, tolerance);
    factor(h);
    predict(h);
    const double rounding = 10 * std::numeric_limits<double>::epsilon() / std::min(rtol, atol);
    const double goal = std::max(newton_goal, rounding);
    const int k = solve_adaptive(h, goal, tolerance);
    if (k == 0) {
        unreached = goal;
        // The next attempt has the length for the largest contraction, and at most 0.7 of the present one.
        norm = std::max(std::pow(0.8, 4) * contraction / largest_contraction, std::pow(0.8 / 0.7, 4));
        return 0;
    }
    norm = estimate(h, again, tolerance);
    if (!(norm <= 1)) return 0;
    place_stage(end, stages - 1);
    end.t = x_n.t + h;
    assemble_once(end);
    finish(end, name);
    return k;
}

void RadauStep::accept_stages(double h)
{
    std::swap(last, now);
    last_length = h;
}

void RadauStep::predict(double h)
{
    if (last_length == 0) {
        for (int i = 0; i < stages; ++i) {
            for (int n = 0; n < bodies; ++n)
                now.q.col(i).segment<6>(6 * n) << c[i] * h * x_n.body[n].rdot,
                    c[i] * h * x_n.body[n].omega_bar;
            now.lambda.col(i) = x_n.lambda;
        }
        now.v.setZero();
        return;
    }
    for (int i = 0; i < stages; ++i) {
        const double s = 1 + c[i] * h / last_length;
        const Weights w = from_zero(s), w_lambda = through_stages(s);
        now.q.col(i) = w[0] * last.q.col(0) + w[1] * last.q.col(1) + w[2] * last.q.col(2) - last.q.col(2);
        now.v.col(i) = w[0] * last.v.col(0) + w[1] * last.v.col(1) + w[2] * last.v.col(2) - last.v.col(2);
        now.lambda.col(i) = w_lambda[0] * last.lambda.col(0) + w_lambda[1] * last.lambda.col(1) +
                            w_lambda[2] * last.lambda.col(2);
        // The angles are those from the end of the last step.
        for (int n = 0; n < bodies; ++n) {
            const Eigen::Index at = 6 * n + 3;
            const Vec3 theta_end = last.q.col(stages - 1).segment<3>(at), theta = combined(last.q, w, at);
            now.q.col(i).segment<3>(at) = log(exp(-theta_end) * exp(theta));
        }
    }
}

void RadauStep::factor(double h)
{
    if (!tangent_is_current) {
        tangent.evaluate_with_velocities(x_n);
        tangent_is_current = true;
    }
    assemble(h);
    N.factor();
    N_complex.factor();
}

void RadauStep::assemble(double h)
{
    for (int n = 0; n < bodies; ++n) {
        // (μ I + ã)⁻¹ = (μ² I - μ ã + a aᵀ)/(μ (μ² + |a|²))
        const Vec3 turn = 0.5 * h * x_n.body[n].omega_bar;
        const Mat3 skew = tilde(turn), dyad = turn * turn.transpose();
        const auto inverse = [&](auto mu) {
            using Matrix = Eigen::Matrix<decltype(mu), 3, 3>;
            const Matrix sum = mu * mu * Matrix::Identity() - mu * skew + dyad;
            return Matrix(h / (mu * (mu * mu + turn.squaredNorm())) * sum);
        };
        N.rotation[n] = inverse(mu);
        N_complex.rotation[n] = inverse(mu_complex);
    }
    N.assemble(h / mu, h / mu, h / mu);
    N_complex.assemble(h / mu_complex, h / mu_complex, h / mu_complex);
}

double RadauStep::most_growth() const
{
    // At least 1: with a tight tolerance the contraction may be that of rounding errors, for any step.
    return contraction > 0
               ? std::clamp(std::pow(largest_contraction / contraction, 0.25), 1., most_growth_of_step)
               : most_growth_of_step;
}

int RadauStep::solve_adaptive(double h, double goal, const Eigen::VectorXd& tolerance)
{
    double before = 0;
    contraction = 0;
    const int most = std::min(most_iterations, settings.max_iterations);
    for (int k = 1; k <= most; ++k) {
        iterate(h);
        const double size = rms(change, tolerance);
        if (!std::isfinite(size)) {
            contraction = size;
            return 0;
        }
        // The error after an iteration is about θ/(1-θ) times its correction, with the contraction θ.
        if (k == 1) {
            if (size <= 0.01 * goal) return k;
        } else {
            const double theta = contraction = size / before;
            if (theta / (1 - theta) * size <= goal && theta < 1) return k;
            if (theta >= 0.99 || std::pow(theta, most - k) / (1 - theta) * size > goal) return 0;
        }
        before = size;
    }
    return 0;
}

void RadauStep::iterate(double h)
{
    set_residual(h);
    const auto split = [&](const Eigen::MatrixXd& from, Eigen::VectorXd& first, Eigen::VectorXcd& second) {
        const auto transformed = [&](int p) {
            return T_inverse[p][0] * from.col(0) + T_inverse[p][1] * from.col(1) +
                   T_inverse[p][2] * from.col(2);
        };
        first = transformed(0);
        second.real() = transformed(1);
        second.imag() = transformed(2);
    };
    split(residual.q, real.q, complex.q);
    split(residual.v, real.v, complex.v);
    split(residual.lambda, real.c, complex.c);
    real.solve(tangent, N, h, mu);
    complex.solve(tangent, N_complex, h, mu_complex);
    const auto join = [&](const Eigen::VectorXd& first, const Eigen::VectorXcd& second, Eigen::MatrixXd& to) {
        for (int i = 0; i < stages; ++i)
            to.col(i) = T[i][0] * first + T[i][1] * second.real() + T[i][2] * second.imag();
    };
    join(real.dq, complex.dq, change.q);
    join(real.dv, complex.dv, change.v);
    join(real.dlambda, complex.dlambda, change.lambda);
    now.q += change.q;
    now.v += change.v;
    now.lambda += change.lambda;
}

void RadauStep::set_residual(double h)
{
    for (int i = 0; i < stages; ++i) {
        place_stage(stage, i);
        stage.t = x_n.t + c[i] * h;
        model.loads(stage, loads);
        model.variation(stage, C);
        model.nu(stage, nu);
        auto q = residual.q.col(i), v = residual.v.col(i);
        const auto slope = [&](const Eigen::MatrixXd& z) {
            return (A_inverse[i][0] * z.col(0) + A_inverse[i][1] * z.col(1) + A_inverse[i][2] * z.col(2)) / h;
        };
        q = slope(now.q);
        v = slope(now.v);
        for (int n = 0; n < bodies; ++n) {
            const Motion& body = stage.body[n];
            q.segment<3>(6 * n) -= body.rdot;
            q.segment<3>(6 * n + 3) -=
                right_jacobian_inverse(now.q.col(i).segment<3>(6 * n + 3)) * body.omega_bar;
            v.segment<3>(6 * n) = mass.m[n] * v.segment<3>(6 * n) - loads.F[n];
            v.segment<3>(6 * n + 3) = (mass.J_bar[n] * v.segment<3>(6 * n + 3)).eval() - tau_bar(n, body);
            velocity.segment<6>(6 * n) << body.rdot, body.omega_bar;
        }
        C.add_transpose(1, now.lambda.col(i), v);
        for (int k = 0; k < C.rows(); ++k) residual.lambda(k, i) = C.dot(k, velocity) - nu[k];
    }
}

void RadauStep::place_stage(State& x, int i) const
{
    for (int n = 0; n < bodies; ++n) {
        const Motion& from = x_n.body[n];
        Motion& body = x.body[n];
        body.r = from.r + now.q.col(i).segment<3>(6 * n);
        body.A = from.A * exp(now.q.col(i).segment<3>(6 * n + 3));
        body.rdot = from.rdot + now.v.col(i).segment<3>(6 * n);
        body.omega_bar = from.omega_bar + now.v.col(i).segment<3>(6 * n + 3);
    }
}

template <class Scalar>
RadauStep::NewtonSystem<Scalar>::NewtonSystem(int bodies, int rows) : b(6 * bodies + rows)
{
    for (Vector* of_bodies : {&q, &v, &dq, &dv, &P_q}) of_bodies->setZero(6 * bodies);
    for (Vector* of_rows : {&c, &dlambda}) of_rows->setZero(rows);
}

template <class Scalar>
void RadauStep::NewtonSystem<Scalar>::solve(const Tangent& tangent, TangentMatrix<Scalar>& N, double h,
                                            Scalar mu)
{
    const auto times_P = [&](const Vector& from, Vector& to) {
        for (Eigen::Index n = 0; 6 * n < from.size(); ++n) {
            to.template segment<3>(6 * n) = h / mu * from.template segment<3>(6 * n);
            to.template segment<3>(6 * n + 3).noalias() =
                N.rotation[static_cast<size_t>(n)] * from.template segment<3>(6 * n + 3);
        }
    };
    // δq = P (δv - e_q);  (M + …) δv + (h/μ) Cᵀ δλ = (h/μ) (K_t P e_q - e_v);  (C + V P) δv = V P e_q - e_c
    times_P(q, P_q);
    dv = -v;
    tangent.add_stiffness(P_q, dv);
    b.head(q.size()) = h / mu * dv;
    for (Eigen::Index k = 0; k < c.size(); ++k)
        b[q.size() + k] = tangent.velocity_variation(static_cast<int>(k), P_q) - c[k];
    N.solve(b);
    dv = b.head(q.size());
    dlambda = mu / h * b.tail(c.size());
    times_P(dv, dq);
    dq -= P_q;
}

double RadauStep::estimate(double h, bool again, const Eigen::VectorXd& tolerance)
{
    // N (error) = f(x_n) + Σ e_i z_i/h with the residual of x_n, where f is v, M v̇ and 0
    const auto add_stages = [&] {
        for (int n = 0; n < bodies; ++n)
            for (size_t i = 0; i < stages; ++i) {
                const auto column = static_cast<Eigen::Index>(i);
                const double w = error_weights[i] / h;
                real.q.segment<6>(6 * n) -= w * now.q.col(column).segment<6>(6 * n);
                real.v.segment<3>(6 * n) -= w * mass.m[n] * now.v.col(column).segment<3>(6 * n);
                real.v.segment<3>(6 * n + 3) -= w * (mass.J_bar[n] * now.v.col(column).segment<3>(6 * n + 3));
            }
        real.solve(tangent, N, h, mu);
        for (int n = 0; n < bodies; ++n)
            error.segment<12>(12 * n) << real.dq.segment<6>(6 * n), real.dv.segment<6>(6 * n);
        return std::sqrt(error.cwiseQuotient(tolerance).squaredNorm() / static_cast<double>(error.size()));
    };
    for (int n = 0; n < bodies; ++n) {
        const Motion& body = x_n.body[n];
        real.q.segment<6>(6 * n) << -body.rdot, -body.omega_bar;
        real.v.segment<6>(6 * n) << -mass.m[n] * body.rddot, -mass.J_bar[n] * body.omegadot_bar;
    }
    real.c.setZero();
    const double norm = add_stages();
    if (!again || norm <= 1 || !std::isfinite(norm)) return norm;
    // The estimate again, with f at x_n + error: it is not dominated by fast modes that are excited at the
    // start.                                                      Hairer, Wanner (1996), Eq. IV.8.20
    place(stage, error);
    stage.t = x_n.t;
    model.loads(stage, loads);
    model.variation(stage, C);
    for (int n = 0; n < bodies; ++n) {
        const Motion& body = stage.body[n];
        real.q.segment<6>(6 * n) << -body.rdot,
            -(right_jacobian_inverse(theta.segment<3>(3 * n)) * body.omega_bar);
        real.v.segment<6>(6 * n) << -loads.F[n], -tau_bar(n, body);
        velocity.segment<6>(6 * n) << body.rdot, body.omega_bar;
    }
    real.dlambda += x_n.lambda;
    C.add_transpose(1, real.dlambda, real.v);
    model.nu(stage, nu);
    for (int k = 0; k < C.rows(); ++k) real.c[k] = C.dot(k, velocity) - nu[k];
    return add_stages();
}

double RadauStep::rms(const Stages& of, const Eigen::VectorXd& tolerance) const
{
    double sum = 0;
    for (int n = 0; n < bodies; ++n)
        for (int i = 0; i < stages; ++i)
            sum +=
                of.q.col(i).segment<6>(6 * n).cwiseQuotient(tolerance.segment<6>(12 * n)).squaredNorm() +
                of.v.col(i).segment<6>(6 * n).cwiseQuotient(tolerance.segment<6>(12 * n + 6)).squaredNorm();
    return std::sqrt(sum / (12. * stages * std::max(bodies, 1)));
}

void RadauStep::interpolate(State& x, double s, double h)
{
    const Weights of_v = from_zero(s), of_q = integral_from_zero(s);
    for (int n = 0; n < bodies; ++n) {
        const Motion& from = x_n.body[n];
        Motion& body = x.body[n];
        const Eigen::Index at = 6 * n;
        body.rdot = from.rdot + combined(last.v, of_v, at);
        body.omega_bar = from.omega_bar + combined(last.v, of_v, at + 3);
        body.r = from.r + h * (s * from.rdot + combined(last.v, of_q, at));
        Vec3 turn = s * from.omega_bar;
        for (int i = 0; i < stages; ++i)
            turn += of_q[static_cast<size_t>(i)] * (right_jacobian_inverse(last.q.col(i).segment<3>(at + 3)) *
                                                        (from.omega_bar + last.v.col(i).segment<3>(at + 3)) -
                                                    from.omega_bar);
        body.A = from.A * exp(h * turn);
    }
    x.t = x_n.t + s * h;
    assemble_once(x);
    finish(x, name);
}

}  // namespace hilda::lie
