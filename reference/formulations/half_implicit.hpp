// SPDX-License-Identifier: GPL-3.0-or-later
/// The half-implicit idea on generalised coordinates q = p or ε of the rotation.    Fang (2022), Secs. 3.5, 3.9
///
///     M r̈_n + Φ_rᵀ λ_n = F_n                                                                      (a)
///     Tᵀ J̄ T q̈_n + Φ_qᵀ λ_n (+ p λ^P_n) = Tᵀ (n̄ - ω̄ × J̄ ω̄ - J̄ Ṫ q̇)_n,   Φ_q = Π̄ T              (b)
///     ṙ_{n+1/2} = ṙ_{n-1/2} + h r̈_n,    r_{n+1} = r_n + h ṙ_{n+1/2},    likewise q                    (c)
///     Φ(r_{n+1}, q_{n+1}, t_{n+1}) = 0,    (pᵀp - 1)/2 = 0 at t_{n+1}                               (d)
///
/// with δπ̄ = T δq: T = 2G for p, T = B for ε. The gyroscopic term of p is 2Gᵀ(-ω̄ × J̄ ω̄) and not the
/// 8 Ġᵀ J̄ Ġ p of Eq. 2.25: the two differ by a multiple of p, which λ^P takes up; as it stands here λ^P is
/// zero. The unknowns are z = (r_{n+1} - r_n, q_{n+1} - q_n, h²λ_n, h²λ^P_n), the Newton matrix is that of (a),
/// (b), (d) frozen at t_n:
///
///     | M    0     Φ_rᵀ  0 |
///     | 0   TᵀJ̄T   Φ_qᵀ  p |
///     | Φ_r Φ_q    0     0 |
///     | 0    pᵀ    0     0 |
///
/// Plain start: ṙ_{-1/2} = ṙ_0; the half-step velocities are reported as those of the node that follows and
/// stand in its loads. Order 1. With a kick: ṙ_{-1/2} = ṙ_0 - (h/2) r̈_0; node velocities are the means of the
/// two half steps beside them, and what the loads see of them, one step early, is 1.5 ṙ_{n-1/2} - 0.5
/// ṙ_{n-3/2}. Order 2 in everything.
///
/// On p the scheme is rA-half-1 with another retraction: since G(a) b = -G(b) a, the body vector
/// ω̄_{n+1/2} = 2G(p_n) ṗ_{n+1/2} = 2G(p_{n+1}) ṗ_{n+1/2}, (b) times ½G reads J̄ (ω̄_{n+1/2} - ω̄_{n-1/2})/h +
/// Π̄ᵀλ = τ̄, and the angle of the step is 2 asin(h|ω̄|/2) instead of h|ω̄|.

#pragma once

#include "lie/solver/newton_matrix.hpp"
#include "lie/steps/newton_step.hpp"

namespace hilda::reference {

using lie::Mat3;
using lie::Vec3;

/// Euler angles have come to where they do not determine a motion.
class SingularParametrisation : public lie::NumericalFailure {
public:
    SingularParametrisation(const std::string& what, double phi)
        : NumericalFailure("singular_parametrisation", what), phi(phi)
    {}

    double phi;  ///< the second of the angles [rad]
};

/// Coordinates: EulerParameters or EulerAngles
template <class Coordinates>
class HalfImplicit : public lie::NewtonStep {
public:
    enum class StartMethod { plain, kick };

    HalfImplicit(const lie::System& model, const lie::Settings& settings, std::string name, StartMethod start)
        : NewtonStep(model, settings), name(std::move(name)), start(start), C(model.pattern()),
          part(model.bodies()), Ct_lambda(6 * model.bodies())
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
        recall(h);
        assemble();  // frozen at t_n
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
        no_convergence(name, correction, x);
    }

    lie::Statistics statistics() const override { return statistics_with(N); }

    bool is_staggered() const override { return true; }
    void fill_node(lie::State& node, const lie::State& after) const override
    {
        take_loads(node, after);
        if (start == StartMethod::plain) return;
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

    /// One body in a step from t_n
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

    // What the state carries of each body: ṙ, ω̄ of the node that the last step has left, both at that node;
    // ṙ_{n-1/2}; q_n, its frame where it has one, and q̇_{n-1/2}. Carrying q keeps p from changing its sign.
    static constexpr int stride = 6 + 3 + k + 1 + k;

    void recall(double h)
    {
        const bool at_start = x_n.history.size() != stride * model.bodies();
        for (int i = 0; i < model.bodies(); ++i) {
            Part& p = part[i];
            const lie::Motion& body = x_n.body[i];
            if (at_start)
                p.at = Coordinates(body.A);
            else {
                const auto carried = x_n.history.template segment<stride>(stride * i);
                p.rdot = carried.template segment<3>(6);
                p.at.q = carried.template segment<k>(9);
                if constexpr (Coordinates::singular_somewhere) p.at.frame = static_cast<int>(carried[9 + k]);
                p.qdot = carried.template segment<k>(10 + k);
            }
            if constexpr (Coordinates::singular_somewhere) keep_off_singular_set(i, h, at_start);
            if (at_start) {
                const double back = start == StartMethod::kick ? 0.5 * h : 0;
                p.rdot = body.rdot - back * body.rddot;
                p.qdot = p.at.qdot(body.omega_bar);
                p.qdot -= back * p.at.qddot(p.qdot, body.omegadot_bar);
            }
            p.T = p.at.T();
        }
    }

    /// At a distance δ from the singular set two of the angles turn 1/δ times as fast as the body, so their
    /// truncation error is that of a step 1/δ times as long. Without another frame the run may come as near
    /// as 0.1: a step that turns the body by 0.01 rad then turns the angles by 0.1, and beyond that neither
    /// Newton's method with a frozen B nor the order can be relied on. With one there is no reason to wait;
    /// at 0.5 the
    /// new frame is nearly twice as far from its own set, so the angles do not flutter between two.
    void keep_off_singular_set(int i, double h, bool at_start)
    {
        Part& p = part[i];
        const double near = settings.reparametrise ? 0.5 : 0.1;
        if (p.at.distance_to_singular_set() >= near) return;
        if (!settings.reparametrise) singular(i, p.at.q[1], "is too near a singular value");
        const Coordinates from = p.at;
        p.at = from.in_best_frame();
        if (at_start) return;
        // q_{n-1} and q_n stay the same two rotations: that is exact for the scheme
        Coordinates before = from;
        before.q -= h * p.qdot;
        p.qdot = p.at.since(before) / h;
    }

    [[noreturn]] void singular(int i, double phi, const std::string& what) const
    {
        std::ostringstream text;
        text.precision(4);
        text << "body '" << model.body_name(i) << "': the Euler angle phi = " << phi << " rad " << what
             << " (0 or pi); " << (settings.reparametrise ? "a smaller step" : "--reparametrise")
             << " or an rA scheme goes through";
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

    /// What does not change in the iteration: M h ṙ_{n-1/2} + h² F_n, TᵀJ̄T h q̇_{n-1/2} + h² Tᵀ(τ̄ - J̄ Ṫq̇)
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

    /// Guess with the accelerations and multipliers of the step before                               Eq. 3.34
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

    /// Minus the residual, into e
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

    /// Of a correction: rotations count by the angle that the body turns, for p that is 2 |δp|
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
                if (p.after.crossed_singular_set())
                    singular(i, p.after.q[1], "has gone over a singular value");
            p.after.settle();
            lie::Motion& body = x.body[i];
            body.A = p.after.A();
            body.rddot = (loads.F[i] - Ct_lambda.segment<3>(6 * i)) / model.mass().m[i];  // (a)
            body.omegadot_bar =
                J_bar_inverse[i] * (tau_bar(i, x_n.body[i]) - Ct_lambda.segment<3>(6 * i + 3));  // (b)

            const Vec3 rdot = z.segment<3>(at_r(i)) / h;
            const Vector qdot = z.segment<k>(at_q(i)) / h;
            const double ahead = start == StartMethod::kick ? 0.5 : 0;
            body.rdot = rdot + ahead * (rdot - p.rdot);
            body.omega_bar = p.after.T() * (qdot + ahead * (qdot - p.qdot));

            auto carried = x.history.template segment<stride>(stride * i);
            carried.template head<3>() = 0.5 * (p.rdot + rdot);
            carried.template segment<3>(3) = 0.5 * (p.T * (p.qdot + qdot));
            carried.template segment<3>(6) = rdot;
            carried.template segment<k>(9) = p.after.q;
            carried[9 + k] = 0;
            if constexpr (Coordinates::singular_somewhere) carried[9 + k] = p.after.frame;
            carried.template segment<k>(10 + k) = qdot;
        }
    }

    const std::string name;
    const StartMethod start;
    lie::NewtonMatrix N;
    lie::Rows C;  ///< Φ_r, Π̄ at t_n
    std::vector<Part> part;
    std::vector<int> upper, lower;
    Eigen::VectorXd b, Ct_lambda;
};

}  // namespace hilda::reference
