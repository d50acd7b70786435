// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-full-1-exact: backward Euler on the Lie group with the exact Newton matrix.   Fang (2022), Sec. 3.4
///
///     M r̈ + Φ_rᵀ λ = F,   J̄ ω̄̇ + Π̄ᵀ λ = τ̄,   Φ / h² = 0       all at t_{n+1}                          (3.16)
///     ṙ = ṙ_n + h r̈,   r = r_n + h ṙ,   ω̄ = ω̄_n + h ω̄̇,   A = A_n exp(h ω̄)                            (3.19)
///
/// The equations and the unknowns z = (r̈, ω̄̇, λ) are those of rA-full-1, and so are the errors. The Newton
/// matrix is the derivative of the residual:
///
///     | M + h² H_rr - ∂F     h² H_rθ J_r - ∂F                              Φ_rᵀ |
///     | h² H_θr - ∂n̄         J̄ + h (ω̄̃ J̄ - (J̄ω̄)~) + h² H_θθ J_r - ∂n̄       Π̄ᵀ   |      J_r = J_r(h ω̄)
///     | Φ_r                  Π̄ J_r                                         0    |
///
/// H is the second variation Σ λ_k ∂(Φ_rᵀ, Π̄ᵀ)_k/∂(δr, δθ̄). ∂F is h² ∂F/∂(δr, δθ̄), with J_r in the columns
/// of δθ̄, plus h ∂F/∂(δṙ, δω̄).
///
/// Convergence is quadratic, and each iteration takes a factorisation. (3.21-3.23) neglect H, J_r and the
/// derivatives of the loads; the number of iterations is then about twice as large. Neglecting J_r alone
/// loses quadratic convergence in spatial motion.

#include "lie/schemes.hpp"
#include "lie/solver/newton_matrix.hpp"
#include "lie/steps/backward_euler_step.hpp"
#include "lie/system.hpp"

namespace hilda::lie {
namespace {

using Mat63 = Eigen::Matrix<double, 6, 3>;

class FullyImplicit1Exact final : public BackwardEulerStep {
public:
    FullyImplicit1Exact(const System& model, const Settings& settings)
        : BackwardEulerStep(model, settings, "rA-full-1-exact"), H(C), dF(model.load_pattern()), J_r(bodies)
    {
        const int m = 6 * bodies;
        for (int i = 0; i < bodies; ++i) body_at.push_back(N.declare(6 * i, 6 * i, 6, 6));
        for (int k = 0; k < C.rows(); ++k)
            for (int a = C.start[k]; a < C.start[k + 1]; ++a) {
                const int i = 6 * C.entry[a].body;
                row_at.push_back(N.declare(m + k, i, 1, 6));
                column_at.push_back(N.declare(i, m + k, 6, 1));
                for (int b = C.start[k]; b < C.start[k + 1]; ++b)
                    second_at.push_back(N.declare(i, 6 * C.entry[b].body, 6, 6));
            }
        for (const LoadVariation::Block& block : dF.block)
            load_at.push_back(N.declare(6 * block.on, 6 * block.by, 6, 6));
        if (model.keeps_redundant_rows())
            for (int k = 0; k < C.rows(); ++k) shift_at.push_back(N.declare(m + k, m + k, 1, 1));
        N.analyse(m + model.rows());
    }

    Statistics statistics() const override { return statistics_with(N); }

private:
    void solve(const State& x, double h) override
    {
        assemble(x, h);
        N.factor();
        N.solve(e);
    }

    /// The Newton matrix N in the state x
    void assemble(const State& x, double h)
    {
        model.second_variation(x, H);
        model.load_variation(x, dF);
        N.set_zero();
        Mat6 block = Mat6::Zero();
        for (int i = 0; i < bodies; ++i) {
            const Motion& body = x.body[i];
            const Mat3& J_bar = mass.J_bar[i];
            J_r[i] = right_jacobian(h * body.omega_bar);
            block.topLeftCorner<3, 3>() = mass.m[i] * Mat3::Identity();
            block.bottomRightCorner<3, 3>() =
                J_bar + h * (tilde(body.omega_bar) * J_bar - tilde(J_bar * body.omega_bar));
            N.add(body_at[i], block);
        }
        size_t n = 0, second = 0;
        for (int k = 0; k < C.rows(); ++k)
            for (int a = 0; a < H.entries[k]; ++a, ++n) {
                const Rows::Entry& entry = C.entry[C.start[k] + a];
                Eigen::Matrix<double, 1, 6> row;
                row << entry.r.transpose(), entry.pi.transpose() * J_r[entry.body];
                N.add(row_at[n], row);
                row.tail<3>() = entry.pi.transpose();
                N.add(column_at[n], row.transpose());
                for (int b = 0; b < H.entries[k]; ++b)
                    N.add(second_at[second++],
                          h * h * x.lambda[k] *
                              by_accelerations(H.at(k, a, b), J_r[C.entry[C.start[k] + b].body]));
            }
        for (size_t k = 0; k < shift_at.size(); ++k)
            N.add(shift_at[k], -shift(h) * of_row(static_cast<int>(k)));
        for (size_t l = 0; l < dF.block.size(); ++l) {
            const auto& d = dF.block[l].d;
            N.add(load_at[l],
                  -h * h * by_accelerations(d.leftCols<6>(), J_r[dF.block[l].by]) - h * d.rightCols<6>());
        }
    }

    /// C M⁻¹ Cᵀ of row k
    double of_row(int k) const
    {
        double sum = 0;
        for (int n = C.start[k]; n < C.start[k + 1]; ++n) {
            const Rows::Entry& entry = C.entry[n];
            sum += entry.r.squaredNorm() / mass.m[entry.body] +
                   entry.pi.dot(J_bar_inverse[entry.body] * entry.pi);
        }
        return sum;
    }

    /// From derivatives by (δr, δθ̄) to derivatives by (δr̈, δω̄̇) over h²: δr = h² δr̈, δθ̄ = h² J_r δω̄̇
    static Mat6 by_accelerations(const Mat6& block, const Mat3& J_r)
    {
        Mat6 out = block;
        out.rightCols<3>() = Mat63(block.rightCols<3>()) * J_r;
        return out;
    }

    SecondVariation H;
    LoadVariation dF;
    std::vector<Mat3> J_r;  ///< J_r(h ω̄) of each body
    NewtonMatrix N;
    // handles of the blocks of N
    std::vector<int> body_at, row_at, column_at, second_at, load_at, shift_at;
};

const bool registered_fully_implicit_1_exact = register_scheme<FullyImplicit1Exact>(
    {.name = "rA-full-1-exact",
     .description = "backward Euler on SO(3), index 3, with the exact Newton matrix",
     .order = 1,
     .order_lambda = 1,
     .formulation = "rA",
     .unknowns = "r'', omega', lambda",
     .uses = {"--tolerance", "--max-iterations"},
     .source = "Fang (2022), Sec. 3.4, with all terms of the Newton matrix",
     .loads = LoadEvaluation::implicit,
     .supports = {Feature::redundant, Feature::history}});

}  // namespace
}  // namespace hilda::lie
