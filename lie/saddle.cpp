// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/saddle.hpp"

#include <klu.h>

namespace hilda::lie {

namespace {

// Below this the last digits of a solution are noise; KLU itself reports success.
constexpr double singular = 1e-14;
// Pivots are chosen anew when the old ones have lost this much of the condition they were chosen for.
constexpr double worn_out = 1e-3;

}  // namespace

struct Saddle::Klu {
    klu_common common{};
    klu_symbolic* symbolic = nullptr;
    klu_numeric* numeric = nullptr;

    Klu()
    {
        klu_defaults(&common);
        common.ordering = 0;  // AMD: K is symmetric in pattern
        common.btf = 0;       // and one block
        common.scale = -1;    // scaled by us
    }
    ~Klu()
    {
        klu_free_numeric(&numeric, &common);
        klu_free_symbolic(&symbolic, &common);
    }
    Klu(const Klu&) = delete;
    Klu& operator=(const Klu&) = delete;
};

Saddle::Saddle(const System& system, Metric metric)
    : system(system), metric(metric), bodies(system.bodies()), m(system.rows()), C(system.pattern()),
      klu(std::make_unique<Klu>()), scale(Eigen::VectorXd::Ones(size())), work(size()), residual(size()),
      right_side(size())
{
    analyse();
}

Saddle::~Saddle() = default;

void Saddle::analyse()
{
    // columns of body b: its 3 + 9 mass entries, then one entry per row that moves with it
    std::vector<std::vector<std::pair<int, int>>> lower(6 * bodies);  // per column: row, index into slot
    for (int k = 0; k < m; ++k)
        for (int n = C.start[k]; n < C.start[k + 1]; ++n)
            for (int c = 0; c < 6; ++c)
                if (C.entry[n].nonzero >> c & 1) {
                    lower[6 * C.entry[n].body + c].emplace_back(6 * bodies + k,
                                                                static_cast<int>(slot.size()));
                    slot.push_back({0, 0, 1});
                }

    column_start.assign(1, 0);
    for (int b = 0; b < bodies; ++b)
        for (int c = 0; c < 6; ++c) {
            const int first = c < 3 ? c : 3, last = c < 3 ? c : 5;
            for (int d = first; d <= last; ++d) {
                mass_slot.push_back(static_cast<int>(row_index.size()));
                row_index.push_back(6 * b + d);
            }
            for (const auto& [row, s] : lower[6 * b + c]) {
                slot[s].lower = static_cast<int>(row_index.size());
                row_index.push_back(row);
            }
            column_start.push_back(static_cast<int>(row_index.size()));
        }
    for (int k = 0, s = 0; k < m; ++k) {
        for (int n = C.start[k]; n < C.start[k + 1]; ++n)
            for (int c = 0; c < 6; ++c)
                if (C.entry[n].nonzero >> c & 1) {
                    slot[s++].upper = static_cast<int>(row_index.size());
                    row_index.push_back(6 * C.entry[n].body + c);
                }
        column_start.push_back(static_cast<int>(row_index.size()));
    }
    value.assign(row_index.size(), 0);

    klu->symbolic = klu_analyze(size(), column_start.data(), row_index.data(), &klu->common);
    if (klu->symbolic == nullptr)
        throw SingularMatrix(
            "the pattern of the saddle matrix is singular: more constraint rows than motions, or a row "
            "that no body enters",
            0);
}

// S = diag(M, J̄)^(-1/2) on the bodies, and on row k what brings (Φ_r, Π̄) S to length one. Then K is about as
// well conditioned as the mechanism is, whatever its units, and the reciprocal condition means something.
void Saddle::scale_rows()
{
    for (int b = 0; b < bodies; ++b)
        for (int c = 0; c < 6; ++c)
            if (metric == Metric::mass)
                scale[6 * b + c] =
                    1 / std::sqrt(c < 3 ? system.mass().m[b] : system.mass().J_bar[b](c - 3, c - 3));
    for (int k = 0; k < m; ++k) {
        double sum = 0;
        for (int n = C.start[k]; n < C.start[k + 1]; ++n) {
            const int at = 6 * C.entry[n].body;
            sum += C.entry[n].r.cwiseProduct(scale.segment<3>(at)).squaredNorm() +
                   C.entry[n].pi.cwiseProduct(scale.segment<3>(at + 3)).squaredNorm();
        }
        if (sum > 0) scale[6 * bodies + k] = 1 / std::sqrt(sum);
    }

    int s = 0;
    for (int k = 0; k < m; ++k)
        for (int n = C.start[k]; n < C.start[k + 1]; ++n)
            for (int c = 0; c < 6; ++c)
                if (C.entry[n].nonzero >> c & 1)
                    slot[s++].factor = scale[6 * bodies + k] * scale[6 * C.entry[n].body + c];
    s = 0;
    for (int b = 0; b < bodies; ++b)
        for (int c = 0; c < 6; ++c)
            for (int d = c < 3 ? c : 3; d <= (c < 3 ? c : 5); ++d) {
                double entry = c == d;
                if (metric == Metric::mass)
                    entry = (c < 3 ? system.mass().m[b] : system.mass().J_bar[b](d - 3, c - 3)) *
                            scale[6 * b + c] * scale[6 * b + d];
                value[mass_slot[s++]] = entry;
            }
    scaled = true;
}

void Saddle::fill()
{
    const Slot* s = slot.data();
    for (const Rows::Entry& entry : C.entry)
        for (int c = 0; c < 6; ++c)
            if (entry.nonzero >> c & 1) {
                value[s->upper] = value[s->lower] = s->factor * (c < 3 ? entry.r[c] : entry.pi[c - 3]);
                ++s;
            }
}

bool Saddle::refactor()
{
    if (!have_pivots || klu_refactor(column_start.data(), row_index.data(), value.data(), klu->symbolic,
                                     klu->numeric, &klu->common) == 0)
        return false;
    ++again;
    klu_rcond(klu->symbolic, klu->numeric, &klu->common);
    rcond = klu->common.rcond;
    return klu->common.status == KLU_OK && rcond > worn_out * rcond_of_full;  // false for NaN
}

void Saddle::factor()
{
    for (const double v : value)
        if (!std::isfinite(v)) throw NonFinite("a derivative of the constraints is not finite");
    klu_free_numeric(&klu->numeric, &klu->common);
    klu->numeric =
        klu_factor(column_start.data(), row_index.data(), value.data(), klu->symbolic, &klu->common);
    ++full;
    rcond = 0;
    if (klu->numeric != nullptr && klu->common.status == KLU_OK) {
        klu_rcond(klu->symbolic, klu->numeric, &klu->common);
        rcond = klu->common.rcond;
    }
    have_pivots = rcond > singular;
    if (!have_pivots)
        throw SingularMatrix("the saddle matrix is singular: redundant or singular constraints?", rcond);
    rcond_of_full = rcond;
}

void Saddle::assemble(const State& x)
{
    system.variation(x, C);
    if (!scaled) scale_rows();
    fill();
    if (!refactor()) {
        scale_rows();
        fill();
        factor();
    }
}

void Saddle::solve(Eigen::VectorXd& b)
{
    b.array() *= scale.array();
    klu_solve(klu->symbolic, klu->numeric, size(), 1, b.data(), &klu->common);
    b.array() *= scale.array();
    if (!std::isfinite(b.sum())) throw NonFinite("the solution of the saddle system is not finite");
}

void Saddle::solve_refined(Eigen::VectorXd& b)
{
    right_side = b;
    solve(b);
    multiply(b, residual);
    work = right_side - residual;
    solve(work);
    b += work;
}

void Saddle::multiply(const Eigen::VectorXd& z, Eigen::VectorXd& out) const
{
    for (int b = 0; b < bodies; ++b) {
        out.segment<6>(6 * b) = z.segment<6>(6 * b);
        if (metric == Metric::unit) continue;
        out.segment<3>(6 * b) *= system.mass().m[b];
        out.segment<3>(6 * b + 3) = system.mass().J_bar[b] * z.segment<3>(6 * b + 3);
    }
    C.add_transpose(1, z.tail(m), out);
    for (int k = 0; k < m; ++k) out[6 * bodies + k] = C.dot(k, z);
}

}  // namespace hilda::lie
