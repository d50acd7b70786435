// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/bounded_rows.hpp"

#include "lie/solver/saddle.hpp"

#include <algorithm>

namespace hilda::lie {

namespace {

constexpr double tolerance = 1e-8;             // of |f - 1|
constexpr double stagnation_tolerance = 1e-5;  // of |f - 1|, if rounding prevents it from decreasing further
constexpr double smallest_bound = 1e-9;        // relative to |λ(1)|; replaces smaller bounds

}  // namespace

void BoundedRows::all_stick(Saddle& K)
{
    for (size_t n = 0; n < search.size(); ++n) {
        search[n] = {};
        K.set_compliance_scale(static_cast<int>(n), 1);
    }
}

bool BoundedRows::operator()(Saddle& K, const Rows& C, Eigen::VectorXd& z, const State& x)
{
    const auto lambda = K.constraint_part(z);
    for (const bool solved_first : {true, false}) {
        bool within = true;
        for (size_t n = 0; n < search.size(); ++n) {
            const Rows::Regularised& c = C.regularised[n];
            if (c.solved_first != solved_first || C.is_inactive(c.first)) continue;
            const double N = c.n.dot(lambda.segment<3>(c.normal_row)), p = K.rows().regularised[n].p;
            const double next =
                next_scale(search[n], p, c.mu * std::max(N, 0.), lambda.segment<2>(c.first).norm());
            if (next == p) continue;
            K.set_compliance_scale(static_cast<int>(n), next);
            within = false;
        }
        if (within) continue;
        K.refactor_regularised(x);
        return false;
    }
    return true;
}

double BoundedRows::next_scale(PairSearch& s, double p, double bound, double length)
{
    if (bound >= length && p == 1) return 1;
    if (s.iterations == 0) s.length_at_one = length;
    bound = std::max(bound, smallest_bound * s.length_at_one);
    const double f = bound / length, error = std::abs(f - 1);
    if (error < tolerance ||
        (s.iterations > 2 && error < stagnation_tolerance && error > 0.5 * std::abs(s.f - 1)))
        return p;
    double next = p / f;
    if (const double slope = (f - s.f) / (p - s.p); s.iterations > 0 && slope > 0 && std::isfinite(slope))
        next = p + (1 - f) / slope;
    ++s.iterations;
    s.p = p, s.f = f;
    return std::max(next, 1.);
}

}  // namespace hilda::lie
