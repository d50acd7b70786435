// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/formulations/rp_step_equations.hpp"

#include "lie/system.hpp"

namespace hilda::reference {

RpStepEquations::RpStepEquations(const lie::System& model)
    : model(model), bodies(model.bodies()), rows(model.rows()), C(model.pattern()), H(model.pattern()),
      D(model.load_pattern()), loads(bodies), w(bodies), q(7 * bodies), qdot(7 * bodies),
      Ct_lambda(6 * bodies), V(bodies)
{
    for (int i = 0; i < bodies; ++i) pair_of(i, i);
    for (int row = 0; row < rows; ++row)
        for (int a = C.start[row]; a < C.start[row + 1]; ++a)
            for (int b = C.start[row]; b < C.start[row + 1]; ++b)
                pair_of_variation.push_back(pair_of(C.entry[a].body, C.entry[b].body));
    for (const auto& block : D.block) pair_of_load.push_back(pair_of(block.on, block.by));

    for (Pair& pair : pairs) pair.at = N.declare(7 * pair.on, 7 * pair.by, 7, 7);
    for (int row = 0; row < rows; ++row)
        for (int n = C.start[row]; n < C.start[row + 1]; ++n) {
            upper.push_back(N.declare(7 * C.entry[n].body, at_lambda() + row, 7, 1));
            lower.push_back(N.declare(at_lambda() + row, 7 * C.entry[n].body, 1, 7));
        }
    for (int i = 0; i < bodies; ++i) {
        norm_column.push_back(N.declare(7 * i + 3, at_norm() + i, 4, 1));
        norm_row.push_back(N.declare(at_norm() + i, 7 * i + 3, 1, 4));
    }
    N.analyse(size());
}

void RpStepEquations::place(const RpFormula& formula, const Eigen::VectorXd& z, lie::State& x)
{
    q = formula.q + formula.g_q * z.head(7 * bodies);
    qdot = formula.qdot + formula.g_v * z.head(7 * bodies);
    for (int i = 0; i < bodies; ++i) {
        lie::Motion& body = x.body[i];
        const lie::Mat34 G = lie::G(p(i));
        body.r = q.segment<3>(7 * i), body.rdot = qdot.segment<3>(7 * i), body.rddot = z.segment<3>(7 * i);
        body.A = lie::rotation(lie::Vec4(p(i).normalized()));
        body.omega_bar = 2 * G * pdot(i);
        body.omegadot_bar = 2 * G * z.segment<4>(7 * i + 3);
    }
    x.lambda = z.segment(at_lambda(), rows);
}

void RpStepEquations::residual(const RpFormula& formula, const Eigen::VectorXd& z, const lie::State& x,
                               Eigen::VectorXd& e)
{
    model.loads(x, loads);
    model.variation(x, C);
    Ct_lambda.setZero();
    C.add_transpose(1, x.lambda, Ct_lambda);
    for (int i = 0; i < bodies; ++i) {
        const lie::Motion& body = x.body[i];
        const lie::Mat3& J_bar = model.mass().J_bar[i];
        w[i] = J_bar * body.omegadot_bar + body.omega_bar.cross(J_bar * body.omega_bar) +
               Ct_lambda.segment<3>(6 * i + 3) - loads.n_bar[i];
        e.segment<3>(7 * i) = model.mass().m[i] * body.rddot + Ct_lambda.segment<3>(6 * i) - loads.F[i];
        e.segment<4>(7 * i + 3) = 2 * lie::G(p(i)).transpose() * w[i] + z[at_norm() + i] * p(i);
        e[at_norm() + i] = (p(i).squaredNorm() - 1) / (2 * formula.g_q);
    }
    model.phi(x, e.segment(at_lambda(), rows));
    e.segment(at_lambda(), rows) /= formula.g_q;
}

void RpStepEquations::assemble(const RpFormula& formula, const Eigen::VectorXd& z, const lie::State& x)
{
    set_variations(x);
    N.set_zero();
    for (int i = 0; i < bodies; ++i) set_map(i, formula);
    Mat7 block;
    for (const Pair& pair : pairs) {
        const Eigen::Matrix<double, 6, 7> S = pair.S * V[pair.by];
        block << S.topRows<3>(), 2 * lie::G(p(pair.on)).transpose() * S.bottomRows<3>();
        if (pair.on == pair.by) add_inertia(pair.on, formula, z, x.body[pair.on], block);
        N.add(pair.at, block);
    }
    Eigen::Matrix<double, 7, 1> Phi_q;
    for (size_t n = 0; n < C.entry.size(); ++n) {
        const int i = C.entry[n].body;
        Phi_q << C.entry[n].r, 2 * lie::G(p(i)).transpose() * C.entry[n].pi;
        N.add(upper[n], Phi_q);
        Phi_q.tail<4>() /= p(i).squaredNorm();
        N.add(lower[n], Phi_q.transpose());
    }
    for (int i = 0; i < bodies; ++i) {
        N.add(norm_column[i], p(i));
        N.add(norm_row[i], p(i).transpose());
    }
}

int RpStepEquations::pair_of(int on, int by)
{
    for (size_t n = 0; n < pairs.size(); ++n)
        if (pairs[n].on == on && pairs[n].by == by) return static_cast<int>(n);
    pairs.push_back({on, by});
    return static_cast<int>(pairs.size()) - 1;
}

void RpStepEquations::set_variations(const lie::State& x)
{
    for (Pair& pair : pairs) pair.S.setZero();
    model.second_variation(x, H);
    size_t n = 0;
    for (int row = 0; row < rows; ++row)
        for (int a = 0; a < H.entries[row]; ++a)
            for (int b = 0; b < H.entries[row]; ++b)
                pairs[pair_of_variation[n++]].S.leftCols<6>() += x.lambda[row] * H.at(row, a, b);
    if (D.block.empty()) return;
    model.load_variation(x, D);
    for (size_t k = 0; k < D.block.size(); ++k) pairs[pair_of_load[k]].S -= D.block[k].d;
}

void RpStepEquations::set_map(int i, const RpFormula& f)
{
    const lie::Mat34 G = lie::G(p(i));
    V[i].setZero();
    V[i].block<3, 3>(0, 0) = f.g_q * lie::Mat3::Identity();
    V[i].block<3, 4>(3, 3) = 2 * f.g_q / p(i).squaredNorm() * G;
    V[i].block<3, 3>(6, 0) = f.g_v * lie::Mat3::Identity();
    V[i].block<3, 4>(9, 3) = 2 * f.g_v * G - 2 * f.g_q * lie::G(pdot(i));
}

void RpStepEquations::add_inertia(int i, const RpFormula& f, const Eigen::VectorXd& z,
                                  const lie::Motion& body, Mat7& block) const
{
    const lie::Mat3& J_bar = model.mass().J_bar[i];
    const lie::Mat34 G = lie::G(p(i));
    const lie::Vec3 J_omega = J_bar * body.omega_bar;
    block.topLeftCorner<3, 3>() += model.mass().m[i] * lie::Mat3::Identity();
    const lie::Mat34 dw = 2 * J_bar * (G - f.g_q * lie::G(lie::Vec4(z.segment<4>(7 * i + 3)))) +
                          (lie::tilde(body.omega_bar) * J_bar - lie::tilde(J_omega)) * V[i].block<3, 4>(9, 3);
    block.bottomRightCorner<4, 4>() +=
        2 * G.transpose() * dw + 2 * f.g_q * Q(w[i]) + f.g_q * z[at_norm() + i] * Eigen::Matrix4d::Identity();
}

}  // namespace hilda::reference
