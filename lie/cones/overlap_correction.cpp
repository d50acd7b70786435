// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/cones/overlap_correction.hpp"

#include "lie/system.hpp"

#include <algorithm>

namespace hilda::lie {

namespace {

constexpr double of_tolerance = 1e-3;  // accuracy of a correction, relative to the allowed overlap
constexpr int most_corrections = 10;

}  // namespace

OverlapCorrection::OverlapCorrection(const System& system, double tolerance)
    : system(system), tolerance(tolerance), C(system.pattern()), problem(system.mass(), C),
      of_positions(system.mass(), C)
{}

const ConeRows& OverlapCorrection::find(const State& x)
{
    system.cones(x, 0, contacts);
    is_found = true;
    return contacts;
}

bool OverlapCorrection::correct(State& x, double h)
{
    problem.C_b = &C;
    before.cone.clear();
    for (int n = 0;; ++n) {
        if (!is_found) find(x);
        is_found = false;
        double largest = 0, size = 1;
        for (const ConeRows::Cone& cone : contacts.cone) largest = std::max(largest, -cone.gap / cone.size);
        const bool overlap_remains = largest > allowed;
        if ((!overlap_remains && n == 0) || n == most_corrections) {
            remaining_overlap = std::max(remaining_overlap, largest);
            return true;
        }
        system.phi(x, problem.nu);
        const bool open_joint = problem.nu.size() > 0 && problem.nu.lpNorm<Eigen::Infinity>() > tolerance;
        if (!overlap_remains && !open_joint) return true;
        overlapping.cone = contacts.cone;
        system.cones(x, h, contacts);
        contacts.add_unlisted(overlapping);
        contacts.add_unlisted(before);
        for (const ConeRows::Cone& cone : contacts.cone) size = std::min(size, cone.size);
        system.variation(x, C);
        problem.nu *= -1;
        problem.q.setZero();
        problem.cones = &contacts.cone;
        problem.mu.assign(contacts.cone.size(), 0);
        problem.beta.resize(contacts.cone.size());
        iterate.p.assign(contacts.cone.size(), Vec3::Zero());
        for (int c = 0; c < problem.contacts(); ++c) problem.beta[c] = contacts.cone[c].gap;
        of_positions.start(problem);
        const double overlap = allowed * size;
        start_tolerance.assign(contacts.cone.size(), of_tolerance * overlap);
        if (of_positions
                .solve(problem, iterate, start_tolerance,
                       {.result = of_tolerance * overlap, .acceptable = overlap})
                .status != ConeSolver::Status::solved)
            return false;
        move(x);
        before.cone = contacts.cone;
        for (int c = 0; c < problem.contacts(); ++c) before.cone[c].gap += problem.u(c, iterate.y)[0];
    }
}

void OverlapCorrection::move(State& x) const
{
    for (size_t b = 0; b < x.body.size(); ++b) {
        x.body[b].r += iterate.y.segment<3>(6 * b);
        x.body[b].A = orthonormalised(x.body[b].A * exp(iterate.y.segment<3>(6 * b + 3)));
    }
}

}  // namespace hilda::lie
