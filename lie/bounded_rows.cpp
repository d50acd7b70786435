// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/bounded_rows.hpp"

#include "lie/check.hpp"
#include "lie/coupled_bounds.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/system.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace hilda::lie {

namespace {

constexpr double tolerance = 1e-8;             // of |f - 1|
constexpr double stagnation_tolerance = 1e-5;  // of |f - 1|, if rounding prevents it from decreasing further
constexpr double smallest_bound = 1e-9;        // relative to |λ(1)|; replaces smaller bounds

}  // namespace

BoundedRows::BoundedRows(const System& system)
    : system(system), pair(system.bounded_pairs()), search(pair.size()), compliances(2 * pair.size()),
      scales(pair.size()), floors(pair.size())
{
    if (!pair.empty()) coupled = std::make_unique<CoupledBounds>();
}

BoundedRows::~BoundedRows() = default;

void BoundedRows::start(const State& x, double step)
{
    h = step;
    solved = 0;
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

bool BoundedRows::within_bounds(Saddle& K, Eigen::VectorXd& z, double resolution)
{
    if (pair.empty()) return true;
    return ++solved <= patience ? change_each(K, z) : change_all(K, z, resolution);
}

bool BoundedRows::change_each(Saddle& K, Eigen::VectorXd& z)
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

/// True if the multipliers in z satisfy their bounds. Otherwise factors K with the p of CoupledBounds.
bool BoundedRows::change_all(Saddle& K, Eigen::VectorXd& z, double resolution)
{
    const auto lambda = K.constraint_part(z);
    // The equations of a step are not exactly linear. Rounding may prevent the smaller error.
    const double most = solved < patience + 10 ? tolerance : stagnation_tolerance;
    bool within = true;
    for (size_t n = 0; n < pair.size(); ++n) {
        const BoundedPair& c = pair[n];
        if (c.K == 0) continue;
        const double length = lambda.segment<2>(c.first).norm();
        if (search[n].iterations == 0) search[n].length_at_one = length;
        scales[n] = search[n].p;
        floors[n] = smallest_bound * search[n].length_at_one;
        const double bound = std::max({c.mu * c.n.dot(lambda.segment<3>(c.normal_row)), floors[n],
                                       length * search[n].p / CoupledBounds::largest_scale});
        const double accepted = std::max(most * bound, resolution);
        if (length > bound + accepted || (search[n].p > 1 && length < bound - accepted)) within = false;
    }
    if (within) return true;
    if (!coupled->solve(K, z, pair, h, floors, scales)) fail(K, z);
    for (size_t n = 0; n < pair.size(); ++n) {
        if (pair[n].K == 0) continue;
        search[n].p = scales[n];
        ++search[n].iterations;
        set_compliance(n);
    }
    K.refactor(compliances);
    return false;
}

bool BoundedRows::release_impossible(Saddle& K, Eigen::VectorXd& z, const Eigen::VectorXd& slip,
                                     double decay_time)
{
    constexpr double smallest_slip =
        1e-6;  // [m/s]; the accelerations of smaller ones are of the order of 1 m/s²
    bool released = false;
    for (size_t n = 0; n < pair.size(); ++n) {
        const BoundedPair& c = pair[n];
        const Eigen::Vector2d velocity = slip.segment<2>(static_cast<Eigen::Index>(2 * n));
        if (c.K == 0 || c.mu == 0 || c.solved_first || !(velocity.norm() > smallest_slip)) continue;
        const double force = K.constraint_part(z).segment<2>(c.first).norm();
        if (compliances[2 * n] * force > 0.5 * velocity.norm() / decay_time) continue;  // it slips
        if (c.mu * coupled->normal_response(K, c, velocity.normalized()) < 1) continue;
        release(n);
        released = true;
    }
    if (released) K.refactor(compliances);
    return released;
}

bool BoundedRows::release_slipping(Saddle& K, const Eigen::VectorXd& slip, double most)
{
    bool released = false;
    for (size_t n = 0; n < pair.size(); ++n) {
        if (pair[n].K == 0) continue;
        search[n] = {};
        set_compliance(n);
        if (pair[n].mu == 0 || !(slip.segment<2>(static_cast<Eigen::Index>(2 * n)).norm() > most)) continue;
        release(n);
        released = true;
    }
    if (!released) return false;
    solved = 0;
    K.refactor(compliances);
    return true;
}

/// Removes the friction of a pair.
void BoundedRows::release(size_t n)
{
    pair[n].mu = 0;
    search[n] = {};
    set_compliance(n);
}

void BoundedRows::fail(Saddle& K, Eigen::VectorXd& z)
{
    const auto lambda = K.constraint_part(z);
    size_t worst = 0;
    double largest = -1, response = 0;
    const char* status = "friction_not_converged";
    for (size_t n = 0; n < pair.size(); ++n) {
        const BoundedPair& c = pair[n];
        const Eigen::Vector2d of_pair = lambda.segment<2>(c.first);
        if (c.K == 0 || !(of_pair.norm() > 0)) continue;
        const double by_force = c.mu * coupled->normal_response(K, c, of_pair.normalized());
        if (by_force >= 1 && by_force > response) {
            response = by_force, worst = n;
            status = "friction_has_no_solution";
        }
        const double bound = c.mu * c.n.dot(lambda.segment<3>(c.normal_row)),
                     error = std::abs(of_pair.norm() - bound) / of_pair.norm();
        const bool within = search[n].p == 1 && of_pair.norm() <= bound;
        if (response == 0 && !within && error > largest) largest = error, worst = n;
    }
    std::ostringstream what;
    what.precision(3);
    what << system.row_name(pair[worst].first) << ": ";
    if (response > 0)
        what << "Coulomb friction has no solution: a friction force at its bound changes the normal force by "
                "mu "
                "dN/dF = "
             << response << " times its bound, at least 1";
    else
        what << "the friction forces and the normal forces that bound them were not found in " << solved
             << " solutions of the step; largest relative error of |F| = mu N " << largest;
    throw NumericalFailure(status, what.str());
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
