// SPDX-License-Identifier: GPL-3.0-or-later
/// Half-implicit schemes in the rotational coordinates q = p (Euler parameters) or q = ε (Euler angles).
///                                                                             Fang (2022), Secs. 3.5, 3.9
///
///     M r̈_n + Φ_rᵀ λ_n = F_n                                                                      (a)
///     Tᵀ J̄ T q̈_n + Φ_qᵀ λ_n (+ p λ^P_n) = Tᵀ (n̄ - ω̄ × J̄ ω̄ - J̄ Ṫ q̇)_n,   Φ_q = Π̄ T              (b)
///     ṙ_{n+1/2} = ṙ_{n-1/2} + h r̈_n,    r_{n+1} = r_n + h ṙ_{n+1/2},    likewise q                    (c)
///     Φ(r_{n+1}, q_{n+1}, t_{n+1}) = 0,    (pᵀp - 1)/2 = 0 at t_{n+1}                               (d)
///
/// with δπ̄ = T δq: T = 2G for p, T = B for ε. The gyroscopic term of p is 2Gᵀ(-ω̄ × J̄ ω̄) instead of the
/// 8 Ġᵀ J̄ Ġ p of Eq. 2.25. The two differ by a multiple of p, which changes λ^P only; with the form above
/// λ^P is zero. The unknowns are z = (r_{n+1} - r_n, q_{n+1} - q_n, h²λ_n, h²λ^P_n). The Newton matrix is
/// that of (a), (b), (d), evaluated once per step at t_n:
///
///     | M    0     Φ_rᵀ  0 |
///     | 0   TᵀJ̄T   Φ_qᵀ  p |
///     | Φ_r Φ_q    0     0 |
///     | 0    pᵀ    0     0 |
///
/// Plain start: ṙ_{-1/2} = ṙ_0. The half-step velocities are stored as those of the following node, and its
/// loads are evaluated with them. Order 1.
///
/// Start with a half step: ṙ_{-1/2} = ṙ_0 - (h/2) r̈_0. The velocities of a node are the means of those half
/// a step before and after it. The loads at t_n are evaluated with the extrapolated velocity 1.5 ṙ_{n-1/2} -
/// 0.5 ṙ_{n-3/2}. Order 2 in all quantities.
///
/// In p the scheme is rA-half-1 with another map from the velocity to the rotation. Since G(a) b = -G(b) a,
///
///     ω̄_{n+1/2} = 2G(p_n) ṗ_{n+1/2} = 2G(p_{n+1}) ṗ_{n+1/2}
///
/// and ½G times (b) is J̄ (ω̄_{n+1/2} - ω̄_{n-1/2})/h + Π̄ᵀλ = τ̄. The rotation angle of the step is 2
/// asin(h|ω̄|/2) instead of h|ω̄|.

#pragma once

#include "lie/check.hpp"
#include "lie/schemes.hpp"
#include "lie/solver/newton_matrix.hpp"
#include "lie/steps/newton_step.hpp"

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

namespace hilda::reference {

using lie::Mat3;
using lie::Vec3;

/// The Euler angles of a body are near their singularity.
class SingularParametrisation : public lie::NumericalFailure {
public:
    SingularParametrisation(const std::string& what, double phi)
        : NumericalFailure("singular_parametrisation", what), phi(phi)
    {}

    double phi;  ///< the second of the angles [rad]
};

/// The schemes NAME-half-1 (plain start) and NAME-half-1-kick (start with a half step) for Coordinates =
/// EulerParameters (NAME = rp) or EulerAngles (NAME = reps)
template <class Coordinates, bool kick>
class HalfImplicit final : public lie::NewtonStep {
public:
    HalfImplicit(const lie::System& model, const lie::Settings& settings)
        : NewtonStep(model, settings), C(model.pattern()), part(model.bodies()), Ct_lambda(6 * model.bodies())
    {
        const int bodies = model.bodies();
        for (int i = 0; i < bodies; ++i) {
            for (int c = 0; c < 3; ++c) part[i].at_m[c] = N.declare(at_r(i) + c, at_r(i) + c, 1, 1);
            part[i].at_mass = N.declare(at_q(i), at_q(i), k, k);
            if (!Coordinates::unit_length) continue;
            part[i].at_column = N.declare(at_q(i), at_norm(i), k, 1);
            part[i].at_row = N.declare(at_norm(i), at_q(i), 1, k);
        }
        for (int row = 0; row < C.rows(); ++row)
            for (int n = C.start[row]; n < C.start[row + 1]; ++n) {
                const int body = C.entry[n].body;
                upper.push_back(N.declare(at_r(body), at_lambda() + row, width, 1));
                lower.push_back(N.declare(at_lambda() + row, at_r(body), 1, width));
            }
        const int unknowns = width * bodies + model.rows() + (Coordinates::unit_length ? bodies : 0);
        N.analyse(unknowns);
        z.resize(unknowns), b.resize(unknowns), e.resize(unknowns);
    }

    int step(lie::State& x, double h) override
    {
        x_n = x;
        Attempt attempt(x, x_n);
        restore(h);
        assemble();  // at t_n
        set_known_part(h);
        predict(h);
        x.t = x_n.t + h;
        for (int iteration = 1; iteration <= settings.max_iterations; ++iteration) {
            place(x);
            set_residual(x);
            N.solve(e);
            z += e;
            if (converged(iteration, length_of_motion(e), e.segment(at_lambda(), model.rows()), 1)) {
                accept(x, h);
                return done(attempt, iteration);
            }
        }
        no_convergence(name(), correction, x);
    }

    static std::string name()
    {
        return std::string(Coordinates::formulation) + (kick ? "-half-1-kick" : "-half-1");
    }
    lie::Statistics statistics() const override { return statistics_with(N); }

    bool is_staggered() const override { return true; }
    void fill_node(lie::State& node, const lie::State& after) const override
    {
        take_loads(node, after);
        if (!kick) return;
        for (int i = 0; i < model.bodies(); ++i) {
            const auto left = after.history.template segment<6>(stride * i);
            node.body[i].rdot = left.template head<3>();
            node.body[i].omega_bar = left.template tail<3>();
        }
    }

private:
    static constexpr int k = Coordinates::size, width = 3 + k;
    using Vector = Eigen::Matrix<double, k, 1>;
    using Map = Eigen::Matrix<double, 3, k>;

    /// Data of one body in the step from t_n
    struct Part {
        Coordinates at, after;  ///< q at t_n and at the iterate
        Vector qdot;            ///< q̇_{n-1/2}
        Vec3 rdot;              ///< ṙ_{n-1/2}
        Map T;
        Eigen::Matrix<double, k, k> mass;  ///< TᵀJ̄T
        int at_m[3] = {}, at_mass = 0, at_column = 0, at_row = 0;
    };

    int at_r(int i) const { return width * i; }
    int at_q(int i) const { return width * i + 3; }
    int at_lambda() const { return width * model.bodies(); }
    int at_norm(int i) const { return at_lambda() + model.rows() + i; }

    // State::history holds for each body: ṙ, ω̄ at t_{n-1}; ṙ_{n-1/2}; q_n, its frame (0 for p), and
    // q̇_{n-1/2}. q is stored because A does not determine the sign of p.
    static constexpr int stride = 6 + 3 + k + 1 + k;

    /// Sets the data of each body from x_n and its history.
    void restore(double h)
    {
        const bool at_start = x_n.history.size() != stride * model.bodies();
        for (int i = 0; i < model.bodies(); ++i) {
            Part& p = part[i];
            const lie::Motion& body = x_n.body[i];
            if (at_start)
                p.at = Coordinates(body.A);
            else {
                const auto stored = x_n.history.template segment<stride>(stride * i);
                p.rdot = stored.template segment<3>(6);
                p.at.q = stored.template segment<k>(9);
                if constexpr (Coordinates::singular_somewhere) p.at.frame = static_cast<int>(stored[9 + k]);
                p.qdot = stored.template segment<k>(10 + k);
            }
            if constexpr (Coordinates::singular_somewhere) keep_off_singular_set(i, h, at_start);
            if (at_start) {
                const double back = kick ? 0.5 * h : 0;
                p.rdot = body.rdot - back * body.rddot;
                p.qdot = p.at.qdot(body.omega_bar);
                p.qdot -= back * p.at.qddot(p.qdot, body.omegadot_bar);
            }
            p.T = p.at.T();
        }
    }

    /// Limits the distance of the angles from the singular set: changes the frame, or throws
    /// SingularParametrisation.
    ///
    /// At the distance δ two of the angles change 1/δ times as fast as the orientation. Their truncation
    /// error is that of a step 1/δ times as long. Without reparametrisation the limit is 0.1: a step that
    /// rotates the body by 0.01 rad changes the angles by 0.1 there, and below it neither the convergence of
    /// Newton's method with a constant B nor the order is reliable. With reparametrisation the limit is 0.5.
    /// The new frame is then nearly twice as far from its singular set, so that the frame does not alternate
    /// between two choices.
    void keep_off_singular_set(int i, double h, bool at_start)
    {
        Part& p = part[i];
        const double near = settings.reparametrise ? 0.5 : 0.1;
        if (p.at.distance_to_singular_set() >= near) return;
        if (!settings.reparametrise) singular(i, p.at.q[1], "is too close to a singular value");
        const Coordinates from = p.at;
        p.at = from.in_best_frame();
        if (at_start) return;
        // q̇ is defined such that q_{n-1} and q_n remain the same two orientations. This is exact for the
        // scheme.
        Coordinates before = from;
        before.q -= h * p.qdot;
        p.qdot = p.at.since(before) / h;
    }

    [[noreturn]] void singular(int i, double phi, const std::string& what) const
    {
        std::ostringstream text;
        text.precision(4);
        text << "body '" << model.body_name(i) << "': the Euler angle phi = " << phi << " rad " << what
             << " (0 or pi); use " << (settings.reparametrise ? "a smaller step" : "--reparametrise")
             << " or an rA scheme";
        throw SingularParametrisation(text.str(), phi);
    }

    void assemble()
    {
        model.variation(x_n, C);
        N.set_zero();
        for (int i = 0; i < model.bodies(); ++i) {
            Part& p = part[i];
            p.mass.noalias() = p.T.transpose() * model.mass().J_bar[i] * p.T;
            for (const int at : p.at_m) N.add(at, model.mass().m[i]);
            N.add(p.at_mass, p.mass);
            if constexpr (Coordinates::unit_length)
                N.add(p.at_column, p.at.q), N.add(p.at_row, p.at.q.transpose());
        }
        Eigen::Matrix<double, width, 1> Phi_rq;
        for (size_t n = 0; n < C.entry.size(); ++n) {
            Phi_rq << C.entry[n].r, part[C.entry[n].body].T.transpose() * C.entry[n].pi;
            N.add(upper[n], Phi_rq);
            N.add(lower[n], Phi_rq.transpose());
        }
        N.factor();
    }

    /// The part of the residual that is constant in the iteration: M h ṙ_{n-1/2} + h² F_n, TᵀJ̄T h q̇_{n-1/2}
    /// + h² Tᵀ(τ̄ - J̄ Ṫq̇)
    void set_known_part(double h)
    {
        model.loads(x_n, loads);
        b.setZero();
        for (int i = 0; i < model.bodies(); ++i) {
            const Part& p = part[i];
            const Vec3 Tdot_qdot = p.at.Tdot_qdot(p.at.qdot(x_n.body[i].omega_bar));
            b.segment<3>(at_r(i)) = h * model.mass().m[i] * p.rdot + h * h * loads.F[i];
            b.segment<k>(at_q(i)) =
                h * (p.mass * p.qdot) +
                h * h * (p.T.transpose() * (tau_bar(i, x_n.body[i]) - model.mass().J_bar[i] * Tdot_qdot));
        }
    }

    /// Initial guess from the accelerations and multipliers of the previous step                     Eq. 3.34
    void predict(double h)
    {
        for (int i = 0; i < model.bodies(); ++i) {
            const Part& p = part[i];
            z.segment<3>(at_r(i)) = h * p.rdot + h * h * x_n.body[i].rddot;
            z.segment<k>(at_q(i)) = h * p.qdot + h * h * p.at.qddot(p.qdot, x_n.body[i].omegadot_bar);
            if (Coordinates::unit_length) z[at_norm(i)] = 0;
        }
        z.segment(at_lambda(), model.rows()) = h * h * x_n.lambda;
    }

    void place(lie::State& x)
    {
        for (int i = 0; i < model.bodies(); ++i) {
            Part& p = part[i];
            p.after = p.at;
            p.after.q += z.segment<k>(at_q(i));
            x.body[i].r = x_n.body[i].r + z.segment<3>(at_r(i));
            x.body[i].A = p.after.A();
        }
    }

    /// Sets e to the negative residual.
    void set_residual(const lie::State& x)
    {
        Ct_lambda.setZero();
        C.add_transpose(1, z.segment(at_lambda(), model.rows()), Ct_lambda);
        for (int i = 0; i < model.bodies(); ++i) {
            const Part& p = part[i];
            e.segment<3>(at_r(i)) = b.segment<3>(at_r(i)) - model.mass().m[i] * z.segment<3>(at_r(i)) -
                                    Ct_lambda.segment<3>(6 * i);
            e.segment<k>(at_q(i)) = b.segment<k>(at_q(i)) - p.mass * z.segment<k>(at_q(i)) -
                                    p.T.transpose() * Ct_lambda.segment<3>(6 * i + 3);
            if constexpr (Coordinates::unit_length) {
                e.segment<k>(at_q(i)) -= z[at_norm(i)] * p.at.q;
                e[at_norm(i)] = -0.5 * (p.after.q.squaredNorm() - 1);
            }
        }
        model.phi(x, e.segment(at_lambda(), model.rows()));
        e.segment(at_lambda(), model.rows()) *= -1;
    }

    /// Norm of a correction in r and in the rotation angle of the bodies, which is 2 |δp| for p
    double length_of_motion(const Eigen::VectorXd& dz) const
    {
        double sum = 0;
        for (int i = 0; i < model.bodies(); ++i)
            sum += dz.segment<3>(at_r(i)).squaredNorm() + part[i].at.turn2(dz.segment<k>(at_q(i)));
        return std::sqrt(sum);
    }

    void accept(lie::State& x, double h)
    {
        place(x);
        x.lambda = z.segment(at_lambda(), model.rows()) / (h * h);
        x.history.resize(stride * model.bodies());
        Ct_lambda.setZero();
        C.add_transpose(1, x.lambda, Ct_lambda);
        for (int i = 0; i < model.bodies(); ++i) {
            Part& p = part[i];
            if constexpr (Coordinates::singular_somewhere)
                if (p.after.crossed_singular_set()) singular(i, p.after.q[1], "has passed a singular value");
            p.after.settle();
            lie::Motion& body = x.body[i];
            body.A = p.after.A();
            body.rddot = (loads.F[i] - Ct_lambda.segment<3>(6 * i)) / model.mass().m[i];  // (a)
            body.omegadot_bar =
                J_bar_inverse[i] * (tau_bar(i, x_n.body[i]) - Ct_lambda.segment<3>(6 * i + 3));  // (b)

            const Vec3 rdot = z.segment<3>(at_r(i)) / h;
            const Vector qdot = z.segment<k>(at_q(i)) / h;
            constexpr double ahead = kick ? 0.5 : 0;
            body.rdot = rdot + ahead * (rdot - p.rdot);
            body.omega_bar = p.after.T() * (qdot + ahead * (qdot - p.qdot));

            auto stored = x.history.template segment<stride>(stride * i);
            stored.template head<3>() = 0.5 * (p.rdot + rdot);
            stored.template segment<3>(3) = 0.5 * (p.T * (p.qdot + qdot));
            stored.template segment<3>(6) = rdot;
            stored.template segment<k>(9) = p.after.q;
            stored[9 + k] = 0;
            if constexpr (Coordinates::singular_somewhere) stored[9 + k] = p.after.frame;
            stored.template segment<k>(10 + k) = qdot;
        }
    }

    lie::NewtonMatrix N;
    lie::Rows C;  ///< Φ_r, Π̄ at t_n
    std::vector<Part> part;
    std::vector<int> upper, lower;
    Eigen::VectorXd b, Ct_lambda;
};

/// The options of lie::Settings that they use
template <class Coordinates>
std::vector<std::string> settings_of_half_implicit()
{
    std::vector<std::string> all = {"--tolerance", "--max-iterations"};
    if constexpr (Coordinates::singular_somewhere) all.emplace_back("--reparametrise");
    return all;
}

/// Adds both schemes to the list. `coordinates` is the text for their descriptions.
template <class Coordinates>
bool register_half_implicit(const std::string& coordinates, const std::string& unknowns)
{
    lie::register_scheme<HalfImplicit<Coordinates, false>>(
        {.name = HalfImplicit<Coordinates, false>::name(),
         .description = "half-implicit (symplectic) Euler on " + coordinates,
         .order = 1,
         .order_lambda = 1,
         .formulation = Coordinates::formulation,
         .unknowns = unknowns,
         .uses = settings_of_half_implicit<Coordinates>(),
         .source = "Fang (2022), Secs. 3.5, 3.9",
         .supports = {lie::Feature::history},
         .energy_drifts = true});
    return lie::register_scheme<HalfImplicit<Coordinates, true>>(
        {.name = HalfImplicit<Coordinates, true>::name(),
         .description = "leapfrog (SHAKE) on " + coordinates,
         .order = 2,
         .order_lambda = 2,
         .formulation = Coordinates::formulation,
         .unknowns = unknowns,
         .uses = settings_of_half_implicit<Coordinates>(),
         .source = "Fang (2022), Secs. 3.5, 3.9, half-step start",
         .loads = lie::LoadEvaluation::extrapolated,
         .supports = {lie::Feature::history},
         .energy_drifts = true});
}

}  // namespace hilda::reference
