// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/bounded_rows.hpp"

#include "lie/solver/saddle.hpp"
#include "lie/system.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::lie {

namespace {

constexpr double tolerance = 1e-8;             // of |f - 1|
constexpr double stagnation_tolerance = 1e-5;  // of |f - 1|, if rounding prevents it from decreasing further
constexpr double smallest_bound = 1e-9;        // relative to |λ(1)|; replaces smaller bounds

}  // namespace

BoundedRows::BoundedRows(const System& system)
    : system(system), pair(system.bounded_pairs()), search(pair.size()), compliances(2 * pair.size())
{}

void BoundedRows::start(const State& x, double step)
{
    h = step;
    if (pair.empty()) return;
    system.update_pairs(x, pair);
    for (size_t n = 0; n < pair.size(); ++n) {
        search[n] = {};
        set_compliance(n);
    }
}

void BoundedRows::set_right_side(Eigen::Ref<Eigen::VectorXd> constraint_part) const
{
    for (const BoundedPair& c : pair) constraint_part.segment<2>(c.first) = -h * c.K * c.mobility(h) * c.S;
}

bool BoundedRows::within_bounds(Saddle& K, Eigen::VectorXd& z)
{
    const auto lambda = K.constraint_part(z);
    for (const bool solved_first : {true, false}) {
        bool within = true;
        for (size_t n = 0; n < pair.size(); ++n) {
            const BoundedPair& c = pair[n];
            if (c.solved_first != solved_first || c.K == 0) continue;
            const double N = c.n.dot(lambda.segment<3>(c.normal_row)), p = search[n].p;
            search[n].p = next_scale(search[n], c.mu * std::max(N, 0.), lambda.segment<2>(c.first).norm());
            if (search[n].p == p) continue;
            set_compliance(n);
            within = false;
        }
        if (within) continue;
        K.refactor(compliances);
        return false;
    }
    return true;
}

double BoundedRows::next_scale(Search& s, double bound, double length)
{
    if (bound >= length && s.p == 1) return 1;
    if (s.iterations == 0) s.length_at_one = length;
    bound = std::max(bound, smallest_bound * s.length_at_one);
    const double f = bound / length, error = std::abs(f - 1);
    if (error < tolerance ||
        (s.iterations > 2 && error < stagnation_tolerance && error > 0.5 * std::abs(s.previous_f - 1)))
        return s.p;
    double next = s.p / f;
    if (const double slope = (f - s.previous_f) / (s.p - s.previous_p);
        s.iterations > 0 && slope > 0 && std::isfinite(slope))
        next = s.p + (1 - f) / slope;
    ++s.iterations;
    s.previous_p = s.p, s.previous_f = f;
    return std::max(next, 1.);
}

void BoundedRows::set_compliance(size_t n)
{
    compliances[2 * n] = compliances[2 * n + 1] = search[n].p * pair[n].mobility(h) / h;
}

}  // namespace hilda::lie
