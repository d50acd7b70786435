// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/solvers/rp_equations.hpp"

#include "lie/check.hpp"
#include "reference/formulations/rp.hpp"

#include <algorithm>
#include <random>

namespace hilda::reference {

namespace {

using lie::Mat3;
using lie::Mat34;
using lie::Mat6;
using lie::Vec3;
using lie::Vec4;
using Mat4 = Eigen::Matrix4d;
using Row4 = Eigen::RowVector4d;

/// ∂(T(p) a)/∂p for a fixed a; Ta is T a
Mat34 dT_dp(const Vec4& p, double p2, const Vec4& a, const Vec3& Ta)
{
    return (-2 / p2) * (lie::G(a) + Ta * p.transpose());
}

/// ∂(T(p)ᵀ R)/∂p for a fixed R
Mat4 dT_transpose_dp(const Vec4& p, double p2, const Mat34& T, const Vec3& R)
{
    return (2 / p2) * (Q(R) - (T.transpose() * R) * p.transpose());
}

constexpr unsigned rotation_bits = 0b111000;

/// The origin of the unknowns: zero, or the centre of the bodies in full metres if it is more than 1 km, and
/// more than ten times the extent of the system, from the origin of the model
Vec3 origin_near(const lie::State& x)
{
    constexpr double far = 1e3, extents = 10;  // [m], [1]
    if (x.body.empty()) return Vec3::Zero();
    Vec3 centre = Vec3::Zero();
    for (const lie::Motion& body : x.body) centre += body.r / static_cast<double>(x.body.size());
    double extent = 0;
    for (const lie::Motion& body : x.body) extent = std::max(extent, (body.r - centre).norm());
    if (!(centre.norm() > std::max(far, extents * extent))) return Vec3::Zero();
    return centre.array().round();
}

/// The geometric mean of the largest radii of gyration of the bodies [m], rounded to a power of two; 1 in the
/// range of the usual mechanisms
double typical_length(const lie::Mass& mass)
{
    constexpr double usual = 100;  // [m], and its inverse
    double mean = 0;               // of log2 ρ
    for (size_t b = 0; b < mass.m.size(); ++b)
        mean += 0.5 * std::log2(mass.J_bar[b].diagonal().maxCoeff() / mass.m[b]) /
                static_cast<double>(mass.m.size());
    return std::abs(mean) > std::log2(usual) ? std::exp2(std::round(mean)) : 1;
}

}  // namespace

RpEquations::RpEquations(const lie::System& system, const lie::State& start, RpForm form, double alpha)
    : system(system), form(form), alpha(form == RpForm::baumgarte ? alpha : 0), origin(origin_near(start)),
      length(typical_length(system.mass())), bodies(system.bodies()), m(system.rows()),
      mu_of_rotation(1 / (length * length)), first_lambda(14 * bodies), first_mu(first_lambda + m + bodies),
      body(bodies), C(system.pattern()), load(bodies), force_lambda(6 * bodies), force_mu(6 * bodies),
      velocity(6 * bodies), acceleration(6 * bodies), Phi(m), nu(m), gamma(m), H(C), d_nu(C), d_gamma(C),
      d_load(system.load_pattern())
{
    x = start;
    find_pairs();
    declare_pattern();
}

// --- order of the unknowns and equations ------------------------------------------------------------------

RpEquations::UnknownType RpEquations::unknown_type(int k) const
{
    if (k < first_lambda) return k % 14 < 7 ? UnknownType::position : UnknownType::velocity;
    return k < first_mu ? UnknownType::lambda : UnknownType::mu;
}

std::string RpEquations::name(int k) const
{
    if (k < first_lambda) {
        const int c = k % 14;
        const char* const what = c < 3    ? "velocity of body '"
                                 : c < 7  ? "angular velocity of body '"
                                 : c < 10 ? "translation of body '"
                                          : "rotation of body '";
        return what + system.body_name(k / 14) + "'";
    }
    const bool position = k >= first_mu;
    const int row = k - (position ? first_mu : first_lambda);
    const char* const level = position              ? ""
                              : form == RpForm::ggl ? ", derivative in time"
                                                    : ", second derivative in time";
    return (row < m ? system.row_name(row)
                    : "unit length of the Euler parameters of body '" + system.body_name(row - m) + "'") +
           level;
}

void RpEquations::write(const lie::State& from, VectorRef y, VectorRef ydot)
{
    x.discrete_state = from.discrete_state;
    x.internal_state = from.internal_state;
    x.derived = from.derived;
    y.setZero();
    ydot.setZero();
    for (int b = 0; b < bodies; ++b) {
        const lie::Motion& motion = from.body[b];
        const Vec4 p = lie::euler_parameters(motion.A);
        const Mat34 G = lie::G(p);
        const Vec4 pdot = 0.5 * G.transpose() * motion.omega_bar;
        const Vec4 pddot =
            0.5 * G.transpose() * motion.omegadot_bar - 0.25 * motion.omega_bar.squaredNorm() * p;
        y.segment<14>(offset(b)) << motion.r - origin, p, motion.rdot, pdot;
        ydot.segment<14>(offset(b)) << motion.rdot, pdot, motion.rddot, pddot;
    }
    y.segment(first_lambda, m) = from.lambda;
    if (!has_units()) return;
    set_units(from);
    y.array() /= unit_of_unknown.array();
    ydot.array() /= unit_of_unknown.array();
}

bool RpEquations::set_discrete_state(const std::vector<int>& discrete_state, double t,
                                     const ConstVectorRef& y, const ConstVectorRef& ydot)
{
    if (discrete_state == x.discrete_state) return true;
    const auto at = in_SI(y, y_SI), rate = in_SI(ydot, ydot_SI);
    evaluate(t, at, rate);
    const lie::Rows C_before = C;
    const lie::Loads load_before = load;
    x.discrete_state = discrete_state;
    evaluate(t, at, rate);
    const auto differ = [](const Vec3& a, const Vec3& b) {
        return !((a - b).norm() <= 1e-12 * std::max({1.0, a.norm(), b.norm()}));
    };
    for (size_t n = 0; n < C.entry.size(); ++n)
        if (differ(C.entry[n].r, C_before.entry[n].r) || differ(C.entry[n].pi, C_before.entry[n].pi))
            return false;
    for (int b = 0; b < bodies; ++b)
        if (differ(load.F[b], load_before.F[b]) || differ(load.n_bar[b], load_before.n_bar[b])) return false;
    return true;
}

void RpEquations::read(double t, const ConstVectorRef& y, lie::State& to) const
{
    to.t = t;
    for (int b = 0; b < bodies; ++b) {
        lie::Motion& motion = to.body[b];
        const Vec4 p = y.segment<4>(offset(b) + 3);
        motion.r = origin + length * y.segment<3>(offset(b));
        motion.A = lie::rotation(p.normalized());
        motion.rdot = length * y.segment<3>(offset(b) + 7);
        motion.omega_bar = (2 / p.squaredNorm()) * (lie::G(p) * y.segment<4>(offset(b) + 10));
    }
}

void RpEquations::set_units(const lie::State& at)
{
    if (!has_units()) return;
    const double L = length;
    unit_of_unknown.setOnes(size());
    factor_of_equation.setOnes(size());
    for (int b = 0; b < bodies; ++b) {
        for (const int first : {offset(b), offset(b) + 7}) {  // r, ṙ
            unit_of_unknown.segment<3>(first).setConstant(L);
            factor_of_equation.segment<3>(first).setConstant(1 / L);
        }
        factor_of_equation.segment<4>(offset(b) + 10).setConstant(1 / (L * L));
        unit_of_unknown[first_lambda + m + b] = L * L;
    }
    system.variation(at, C);
    for (int k = 0; k < m; ++k) {
        double sum = 0;
        for (int n = C.start[k]; n < C.start[k + 1]; ++n)
            sum += L * L * C.entry[n].r.squaredNorm() + C.entry[n].pi.squaredNorm();
        const double row = sum > 0 ? std::exp2(std::round(0.5 * std::log2(sum))) : 1;  // unit of Φ
        for (const int first : {first_lambda, first_mu}) {
            if (first >= size()) continue;
            unit_of_unknown[first + k] = L * L / row;
            factor_of_equation[first + k] = 1 / row;
        }
    }
}

Eigen::Map<const Eigen::VectorXd> RpEquations::in_SI(const ConstVectorRef& y, Eigen::VectorXd& work) const
{
    if (!has_units()) return {y.data(), y.size()};
    work = unit_of_unknown.cwiseProduct(y);
    return {work.data(), work.size()};
}

// --- the residual -----------------------------------------------------------------------------------------

/// Quantities that the residual and the Jacobian share
void RpEquations::evaluate(double t, const ConstVectorRef& y, const ConstVectorRef& ydot)
{
    x.t = t;
    for (int b = 0; b < bodies; ++b) {
        Body& q = body[b];
        lie::Motion& motion = x.body[b];
        motion.r = origin + y.segment<3>(offset(b));
        q.p = y.segment<4>(offset(b) + 3);
        motion.rdot = y.segment<3>(offset(b) + 7);
        q.pdot = y.segment<4>(offset(b) + 10);
        q.rddot = ydot.segment<3>(offset(b) + 7);
        q.pddot = ydot.segment<4>(offset(b) + 10);
        q.p2 = q.p.squaredNorm();
        q.T = (2 / q.p2) * lie::G(q.p);
        q.w = q.T * q.pddot;
        motion.A = lie::rotation(q.p / std::sqrt(q.p2));
        motion.omega_bar = q.T * q.pdot;
        velocity.segment<6>(6 * b) << motion.rdot, motion.omega_bar;
        acceleration.segment<6>(6 * b) << q.rddot, q.w;
    }
    system.variation(x, C);
    force_lambda.setZero();
    C.add_transpose(1, y.segment(first_lambda, m), force_lambda);
    if (form == RpForm::ggl) {
        force_mu.setZero();
        C.add_transpose(1, y.segment(first_mu, m), force_mu);
    }
    system.loads(x, load);
}

void RpEquations::residual(double t, const ConstVectorRef& y, const ConstVectorRef& ydot, VectorRef F)
{
    residual_in_SI(t, in_SI(y, y_SI), in_SI(ydot, ydot_SI), F);
    if (has_units()) F.array() *= factor_of_equation.array();
}

void RpEquations::residual_in_SI(double t, const ConstVectorRef& y, const ConstVectorRef& ydot, VectorRef F)
{
    evaluate(t, y, ydot);
    const lie::Mass& mass = system.mass();
    for (int b = 0; b < bodies; ++b) {
        const Body& q = body[b];
        const lie::Motion& motion = x.body[b];
        const Vec3& omega_bar = motion.omega_bar;
        F.segment<3>(offset(b)) = ydot.segment<3>(offset(b)) - motion.rdot;
        F.segment<4>(offset(b) + 3) = ydot.segment<4>(offset(b) + 3) - q.pdot;
        if (form == RpForm::ggl) {
            F.segment<3>(offset(b)) += force_mu.segment<3>(6 * b);
            F.segment<4>(offset(b) + 3) +=
                mu_of_rotation * q.T.transpose() * force_mu.segment<3>(6 * b + 3) + y[first_mu + m + b] * q.p;
        }
        F.segment<3>(offset(b) + 7) = mass.m[b] * q.rddot + force_lambda.segment<3>(6 * b) - load.F[b];
        const Vec3 R = mass.J_bar[b] * q.w + force_lambda.segment<3>(6 * b + 3) - load.n_bar[b] +
                       omega_bar.cross(mass.J_bar[b] * omega_bar);
        F.segment<4>(offset(b) + 10) = q.T.transpose() * R + y[first_lambda + m + b] * q.p;

        const double P = 0.5 * (q.p2 - 1), Pdot = q.p.dot(q.pdot);
        if (form == RpForm::ggl) {
            F[first_lambda + m + b] = Pdot;
            F[first_mu + m + b] = P;
        } else {
            F[first_lambda + m + b] =
                q.p.dot(q.pddot) + q.pdot.squaredNorm() + 2 * alpha * Pdot + alpha * alpha * P;
        }
    }

    if (form == RpForm::ggl) {
        system.phi(x, F.segment(first_mu, m));
        system.nu(x, nu);
        for (int k = 0; k < m; ++k) F[first_lambda + k] = C.dot(k, velocity) - nu[k];
        return;
    }
    system.gamma(x, gamma);
    for (int k = 0; k < m; ++k) F[first_lambda + k] = C.dot(k, acceleration) - gamma[k];
    if (form == RpForm::index1) return;
    system.phi(x, Phi);
    system.nu(x, nu);
    for (int k = 0; k < m; ++k)
        F[first_lambda + k] += 2 * alpha * (C.dot(k, velocity) - nu[k]) + alpha * alpha * Phi[k];
}

// --- the Jacobian: its pattern ----------------------------------------------------------------------------

void RpEquations::declare_pattern()
{
    const auto diagonal = [&](int row, int column, int n) {
        const int first = J.declare(row, column, 1, 1);
        for (int c = 1; c < n; ++c) J.declare(row + c, column + c, 1, 1);
        return first;
    };
    const bool ggl = form == RpForm::ggl;
    for (int b = 0; b < bodies; ++b) {
        const int r = offset(b), p = r + 3, v = r + 7, u = r + 10;
        const int lambda_P = first_lambda + m + b, mu_P = first_mu + m + b;
        body_slots.push_back({.r_r = diagonal(r, r, 3),
                              .r_v = diagonal(r, v, 3),
                              .p_p = diagonal(p, p, 4),
                              .p_u = diagonal(p, u, 4),
                              .v_v = diagonal(v, v, 3),
                              .u_p = J.declare(u, p, 4, 4),
                              .u_u = J.declare(u, u, 4, 4),
                              .u_lambda = J.declare(u, lambda_P, 4, 1),
                              .p_mu = ggl ? J.declare(p, mu_P, 4, 1) : -1,
                              .norm_p = ggl ? J.declare(mu_P, p, 1, 4) : -1,
                              .norm_q = J.declare(lambda_P, p, 1, 4),
                              .norm_qdot = J.declare(lambda_P, u, 1, 4)});
    }
    for (int k = 0; k < m; ++k)
        for (int n = C.start[k]; n < C.start[k + 1]; ++n) declare_entry(k, n);
    declare_pairs();
    for (const lie::LoadVariation::Block& block : d_load.block) {
        const int on = offset(block.on), by = offset(block.by);
        load_slots.push_back({.q = J.declare(on + 7, by, 7, 7), .qdot = J.declare(on + 7, by + 7, 7, 7)});
    }
    J.analyse(size());
}

void RpEquations::declare_entry(int k, int n)
{
    const lie::Rows::Entry& entry = C.entry[n];
    const bool ggl = form == RpForm::ggl, has_rotation = (entry.nonzero & rotation_bits) != 0;
    const int r = offset(entry.body), p = r + 3, v = r + 7, u = r + 10;
    const int lambda = first_lambda + k, mu = first_mu + k;
    Slots s;
    for (int c = 0; c < 3; ++c) {
        const bool coupled = entry.nonzero >> c & 1;
        s.force[c] = coupled ? J.declare(v + c, lambda, 1, 1) : -1;
        s.q_r[c] = coupled ? J.declare(lambda, r + c, 1, 1) : -1;
        s.qdot_r[c] = coupled ? J.declare(lambda, v + c, 1, 1) : -1;
        s.mu_force[c] = coupled && ggl ? J.declare(r + c, mu, 1, 1) : -1;
        s.r[c] = coupled && ggl ? J.declare(mu, r + c, 1, 1) : -1;
    }
    s.torque = has_rotation ? J.declare(u, lambda, 4, 1) : -1;
    s.q_p = has_rotation ? J.declare(lambda, p, 1, 4) : -1;
    s.qdot_p = has_rotation ? J.declare(lambda, u, 1, 4) : -1;
    s.mu_torque = has_rotation && ggl ? J.declare(p, mu, 4, 1) : -1;
    s.p = has_rotation && ggl ? J.declare(mu, p, 1, 4) : -1;
    slots.push_back(s);
}

void RpEquations::find_pairs()
{
    for (int k = 0; k < m; ++k)
        for (int a = C.start[k]; a < C.start[k + 1]; ++a)
            for (int b = C.start[k]; b < C.start[k + 1]; ++b) {
                const int on = C.entry[a].body, by = C.entry[b].body;
                auto found = std::find_if(pair.begin(), pair.end(),
                                          [&](const Pair& q) { return q.on == on && q.by == by; });
                if (found == pair.end()) {
                    found = pair.emplace(pair.end());
                    found->on = on;
                    found->by = by;
                }
                pair_of.push_back(static_cast<int>(found - pair.begin()));
            }

    // A block that is exactly zero in two random states is assumed to be zero in all. If the assumption is
    // wrong, Newton's method converges more slowly, to the same solution.
    std::mt19937 engine(1);
    std::normal_distribution<> normal;
    lie::State random_state = x;
    for (int n = 0; n < 2; ++n) {
        for (lie::Motion& motion : random_state.body) {
            Vec4 p;
            for (double& e : p) e = normal(engine);
            for (double& e : motion.r) e += normal(engine);
            motion.A = lie::rotation(p.normalized());
        }
        try {
            system.second_variation(random_state, H);
        } catch (
            const lie::NumericalFailure&) {  // not defined in this pose: no derivative is known to be zero
            for (Pair& q : pair)
                for (const int i : {0, 1}) q.nonzero[i][0] = q.nonzero[i][1] = true;
            return;
        }
        for (size_t h = 0; h < H.block.size(); ++h)
            for (const int i : {0, 1})
                for (const int j : {0, 1})
                    if (!H.block[h].block<3, 3>(3 * i, 3 * j).isZero(0))
                        pair[pair_of[h]].nonzero[i][j] = true;
    }
}

void RpEquations::declare_pairs()
{
    for (Pair& q : pair)
        for (const int i : {0, 1})
            for (const int j : {0, 1})
                q.slot[i][j] = q.nonzero[i][j]
                                   ? J.declare(offset(q.on) + 7 + 3 * i, offset(q.by) + 3 * j, 3 + i, 3 + j)
                                   : -1;
}

// --- the Jacobian: its values -----------------------------------------------------------------------------

const lie::Klu& RpEquations::jacobian(double t, const ConstVectorRef& unknowns, const ConstVectorRef& rates,
                                      double c_j)
{
    const auto y = in_SI(unknowns, y_SI), ydot = in_SI(rates, ydot_SI);
    evaluate(t, y, ydot);
    system.second_variation(x, H);
    if (form != RpForm::index1) system.nu_variation(x, d_nu);
    if (form != RpForm::ggl) system.gamma_variation(x, d_gamma);
    system.load_variation(x, d_load);

    for (Pair& q : pair) q.value.setZero();
    for (int k = 0; k < m; ++k)
        for (int h = H.first[k]; h < H.first[k] + H.entries[k] * H.entries[k]; ++h)
            pair[pair_of[h]].value += y[first_lambda + k] * H.block[h];

    J.set_zero();
    add_bodies(y, c_j);
    add_rows(c_j);
    add_pairs();
    add_loads();
    if (has_units()) J.scale(factor_of_equation, unit_of_unknown);
    return J.compressed();
}

void RpEquations::add_bodies(const ConstVectorRef& y, double c_j)
{
    const lie::Mass& mass = system.mass();
    for (int b = 0; b < bodies; ++b) {
        const Body& q = body[b];
        const BodySlots& s = body_slots[b];
        const Vec3& omega_bar = x.body[b].omega_bar;
        const Mat3& J_bar = mass.J_bar[b];
        for (int c = 0; c < 3; ++c) {
            add(s.r_r + c, c_j);
            add(s.r_v + c, -1);
            add(s.v_v + c, c_j * mass.m[b]);
        }
        for (int c = 0; c < 4; ++c) {
            add(s.p_p + c, c_j);
            add(s.p_u + c, -1);
        }

        const Mat34 omega_p = dT_dp(q.p, q.p2, q.pdot, omega_bar), w_p = dT_dp(q.p, q.p2, q.pddot, q.w);
        const Mat3 gyroscopic = lie::tilde(omega_bar) * J_bar - lie::tilde(J_bar * omega_bar);
        const Vec3 R = J_bar * q.w + force_lambda.segment<3>(6 * b + 3) - load.n_bar[b] +
                       omega_bar.cross(J_bar * omega_bar);
        Mat4 u_p =
            dT_transpose_dp(q.p, q.p2, q.T, R) + q.T.transpose() * (J_bar * w_p + gyroscopic * omega_p);
        u_p.diagonal().array() += y[first_lambda + m + b];
        add(s.u_p, u_p);
        add(s.u_u, q.T.transpose() * (c_j * J_bar + gyroscopic) * q.T);
        add(s.u_lambda, q.p);

        if (form == RpForm::ggl) {
            add(s.p_mu, q.p);
            add(s.norm_p, q.p.transpose());
            add(s.norm_q, q.pdot.transpose());
            add(s.norm_qdot, q.p.transpose());
        } else {
            add(s.norm_q, (q.pddot + 2 * alpha * q.pdot + alpha * alpha * q.p).transpose());
            add(s.norm_qdot, (2 * q.pdot + (c_j + 2 * alpha) * q.p).transpose());
        }
    }
}

void RpEquations::add_rows(double c_j)
{
    const bool ggl = form == RpForm::ggl;
    // Row of λ_k: by_velocity (Φ_q q̇ - ν) + by_acceleration (Φ_q q̈ - γ) + α² Φ.
    const double velocity_weight = ggl ? 1 : 2 * alpha, acceleration_weight = ggl ? 0 : 1;
    for (int k = 0; k < m; ++k) {
        const int first = C.start[k], entries = C.start[k + 1] - first;
        for (int b = 0; b < entries; ++b) {
            const lie::Rows::Entry& entry = C.entry[first + b];
            const Slots& s = slots[first + b];
            const Body& q = body[entry.body];
            const Vec3& omega_bar = x.body[entry.body].omega_bar;

            Vec3 d_r = alpha * alpha * entry.r, d_theta = alpha * alpha * entry.pi;
            Vec3 d_rdot = (velocity_weight + acceleration_weight * c_j) * entry.r;
            Vec3 d_omega = velocity_weight * entry.pi, d_w = acceleration_weight * entry.pi;
            for (int a = 0; a < entries; ++a) {
                const Mat6& Hab = H.at(k, a, b);
                const int on = 6 * C.entry[first + a].body;
                Eigen::Matrix<double, 6, 1> v = velocity_weight * velocity.segment<6>(on);
                if (!ggl) v += acceleration.segment<6>(on);
                d_r += Hab.leftCols<3>().transpose() * v;
                d_theta += Hab.rightCols<3>().transpose() * v;
            }
            if (velocity_weight != 0) {
                d_r -= velocity_weight * d_nu.entry[first + b].r;
                d_theta -= velocity_weight * d_nu.entry[first + b].pi;
            }
            if (!ggl) {
                const lie::GammaVariation::Entry& variation = d_gamma.entry[first + b];
                d_r -= variation.r;
                d_theta -= variation.theta;
                d_rdot -= variation.rdot;
                d_omega -= variation.omega;
            }
            for (int c = 0; c < 3; ++c) {
                if (s.force[c] < 0) continue;
                add(s.force[c], entry.r[c]);
                add(s.q_r[c], d_r[c]);
                add(s.qdot_r[c], d_rdot[c]);
                if (!ggl) continue;
                add(s.mu_force[c], entry.r[c]);
                add(s.r[c], entry.r[c]);
            }
            if (s.torque < 0) continue;
            const Row4 Phi_p = entry.pi.transpose() * q.T;
            Row4 d_p = d_theta.transpose() * q.T + d_omega.transpose() * dT_dp(q.p, q.p2, q.pdot, omega_bar);
            if (!ggl) d_p += d_w.transpose() * dT_dp(q.p, q.p2, q.pddot, q.w);
            add(s.torque, Phi_p.transpose());
            add(s.q_p, d_p);
            add(s.qdot_p, (d_omega + c_j * d_w).transpose() * q.T);
            if (!ggl) continue;
            add(s.mu_torque, mu_of_rotation * Phi_p.transpose());
            add(s.p, Phi_p);
        }
    }
}

void RpEquations::add_pairs()
{
    for (const Pair& q : pair) {
        const Mat34 &T_on = body[q.on].T, &T_by = body[q.by].T;
        if (q.nonzero[0][0]) add(q.slot[0][0], q.value.topLeftCorner<3, 3>());
        if (q.nonzero[0][1]) add(q.slot[0][1], q.value.topRightCorner<3, 3>() * T_by);
        if (q.nonzero[1][0]) add(q.slot[1][0], T_on.transpose() * q.value.bottomLeftCorner<3, 3>());
        if (q.nonzero[1][1]) add(q.slot[1][1], T_on.transpose() * q.value.bottomRightCorner<3, 3>() * T_by);
    }
}

void RpEquations::add_loads()
{
    using Mat7 = Eigen::Matrix<double, 7, 7>;
    for (size_t n = 0; n < load_slots.size(); ++n) {
        const lie::LoadVariation::Block& block = d_load.block[n];
        const Body &on = body[block.on], &by = body[block.by];
        Eigen::Matrix<double, 7, 6> rows =
            Eigen::Matrix<double, 7, 6>::Zero();  // maps (F, n̄) to the equations of a body
        rows.topLeftCorner<3, 3>().setIdentity();
        rows.bottomRightCorner<4, 3>() = on.T.transpose();
        const Eigen::Matrix<double, 7, 12> d = rows * block.d;
        Mat7 q, qdot;
        q << d.leftCols<3>(), d.middleCols<3>(3) * by.T +
                                  d.rightCols<3>() * dT_dp(by.p, by.p2, by.pdot, x.body[block.by].omega_bar);
        qdot << d.middleCols<3>(6), d.rightCols<3>() * by.T;
        add(load_slots[n].q, -q);
        add(load_slots[n].qdot, -qdot);
    }
}

}  // namespace hilda::reference
