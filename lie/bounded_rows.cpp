// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/bounded_rows.hpp"

#include <algorithm>

namespace hilda::lie {

namespace {

constexpr double close = 1e-8;            // |f - 1| that ends the search
constexpr double close_enough = 1e-5;     // where rounding keeps it from getting there
constexpr double as_good_as_none = 1e-9;  // part of the multipliers that would stick, a bound where N is zero

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
            const double other =
                next_scale(search[n], p, c.mu * std::max(N, 0.), lambda.segment<2>(c.first).norm());
            if (other == p) continue;
            K.set_compliance_scale(static_cast<int>(n), other);
            within = false;
        }
        if (within) continue;
        K.refactor_regularised(x);
        return false;
    }
    return true;
}

double BoundedRows::next_scale(Search& s, double p, double bound, double length)
{
    if (bound >= length && p == 1) return 1;
    if (s.solutions == 0) s.sticking = length;
    bound = std::max(bound, as_good_as_none * s.sticking);
    const double f = bound / length, off = std::abs(f - 1);
    if (off < close || (s.solutions > 2 && off < close_enough && off > 0.5 * std::abs(s.f - 1))) return p;
    double next = p / f;
    if (const double slope = (f - s.f) / (p - s.p); s.solutions > 0 && slope > 0 && std::isfinite(slope))
        next = p + (1 - f) / slope;
    ++s.solutions;
    s.p = p, s.f = f;
    return std::max(next, 1.);
}

}  // namespace hilda::lie
