// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/cones/overlap_correction.hpp"

#include "lie/system.hpp"

#include <algorithm>
#include <limits>

namespace hilda::lie {

namespace {

constexpr double allowed = 1e-9;       // overlap, relative to Cone::size
constexpr double of_tolerance = 1e-3;  // accuracy of a correction, relative to the allowed overlap
constexpr int most_corrections = 5;

}  // namespace

OverlapCorrection::OverlapCorrection(const System& system)
    : system(system), C(system.pattern()), problem(system.mass(), C), of_positions(system.mass(), C)
{}

bool OverlapCorrection::correct(State& x)
{
    problem.C_b = &C;
    for (int n = 0; n < most_corrections; ++n) {
        system.cones(x, 0, overlapping);
        double largest = 0, size = std::numeric_limits<double>::infinity();
        for (const ConeRows::Cone& cone : overlapping.cone) {
            largest = std::max(largest, -cone.gap / cone.size);
            size = std::min(size, cone.size);
        }
        if (!(largest > allowed)) return true;
        system.variation(x, C);
        system.phi(x, problem.nu);
        problem.nu *= -1;
        problem.q.setZero();
        problem.cones = &overlapping.cone;
        problem.mu.assign(overlapping.cone.size(), 0);
        problem.beta.resize(overlapping.cone.size());
        iterate.p.assign(overlapping.cone.size(), Vec3::Zero());
        for (int c = 0; c < problem.contacts(); ++c) problem.beta[c] = overlapping.cone[c].gap;
        of_positions.start(problem);
        const double overlap = allowed * size;
        if (of_positions.solve(problem, iterate, {of_tolerance * overlap, of_tolerance * overlap, overlap})
                .status != ConeSolver::Status::solved)
            return false;
        move(x);
    }
    return true;
}

void OverlapCorrection::move(State& x) const
{
    for (size_t b = 0; b < x.body.size(); ++b) {
        x.body[b].r += iterate.y.segment<3>(6 * b);
        x.body[b].A = orthonormalised(x.body[b].A * exp(iterate.y.segment<3>(6 * b + 3)));
    }
}

}  // namespace hilda::lie
