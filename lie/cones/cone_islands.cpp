// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/cones/cone_islands.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace hilda::lie {

namespace {

constexpr int most_unused = 4;  // an island that is not found again in so many problems is removed

Mass part_of(const Mass& all, const std::vector<int>& bodies)
{
    Mass part;
    for (const int b : bodies) {
        part.m.push_back(all.m[b]);
        part.J_bar.push_back(all.J_bar[b]);
    }
    return part;
}

/// The rows with the numbers of their bodies among `bodies`
Rows part_of(const Rows& all, const std::vector<int>& bodies, const std::vector<int>& numbers)
{
    Rows part;
    for (const int k : numbers) {
        for (int n = all.start[k]; n < all.start[k + 1]; ++n) {
            part.entry.push_back(all.entry[n]);
            const auto found = std::lower_bound(bodies.begin(), bodies.end(), all.entry[n].body);
            part.entry.back().body = static_cast<int>(found - bodies.begin());
        }
        part.start.push_back(static_cast<int>(part.entry.size()));
    }
    return part;
}

}  // namespace

ConeIslands::Island::Island(const ConeProblem& of, std::vector<int> of_bodies, std::vector<int> of_rows)
    : bodies(std::move(of_bodies)), joint_rows(std::move(of_rows)), mass(part_of(of.mass, bodies)),
      rows(part_of(*of.C_b, bodies, joint_rows)), problem(mass, rows), solver(mass, rows)
{}

ConeIslands::ConeIslands(const Mass& mass, const Rows& pattern)
    : pattern(pattern), whole(mass, pattern), parent(mass.m.size()), number_of(mass.m.size()),
      index(mass.m.size()), kept(mass.m.size())
{}

int ConeIslands::root(int body)
{
    while (parent[body] != body) body = parent[body] = parent[parent[body]];
    return body;
}

/// The islands in the order of their first contact points
void ConeIslands::find_islands(const ConeProblem& problem)
{
    std::iota(parent.begin(), parent.end(), 0);
    const auto connect = [&](int i, int j) {
        if (i >= 0 && j >= 0) parent[root(i)] = root(j);
    };
    for (const ConeRows::Cone& cone : *problem.cones) connect(cone.i, cone.j);
    for (int k = 0; k < pattern.rows(); ++k)
        for (int n = pattern.start[k] + 1; n < pattern.start[k + 1]; ++n)
            connect(pattern.entry[n].body, pattern.entry[n - 1].body);
    std::fill(number_of.begin(), number_of.end(), -1);
    number = 0;
    for (const ConeRows::Cone& cone : *problem.cones) {
        int& of_root = number_of[root(cone.i >= 0 ? cone.i : cone.j)];
        if (of_root < 0) of_root = number++;
    }
    if (number < 2) return;
    bodies.resize(std::max(bodies.size(), static_cast<size_t>(number)));
    rows.resize(bodies.size());
    for (int n = 0; n < number; ++n) bodies[n].clear(), rows[n].clear();
    for (int b = 0; b < problem.bodies(); ++b) {
        number_of[b] = number_of[root(b)];
        if (number_of[b] < 0) continue;
        std::vector<int>& all = bodies[number_of[b]];
        index[b] = static_cast<int>(all.size());
        all.push_back(b);
    }
    for (int k = 0; k < pattern.rows(); ++k) {
        if (pattern.start[k] == pattern.start[k + 1]) continue;
        const int of = number_of[pattern.entry[pattern.start[k]].body];
        if (of >= 0) rows[of].push_back(k);
    }
}

/// The islands of this problem; those of earlier problems with the same bodies are used again.
void ConeIslands::take_islands(const ConeProblem& problem)
{
    present.clear();
    for (int n = 0; n < number; ++n) {
        std::unique_ptr<Island>& island = kept[bodies[n].front()];
        if (island && island->bodies != bodies[n]) remove(island);
        if (!island) island = std::make_unique<Island>(problem, bodies[n], rows[n]);
        island->unused = 0;
        island->contacts.clear();
        island->cones.clear();
        present.push_back(island.get());
    }
    for (int c = 0; c < problem.contacts(); ++c) {
        const ConeRows::Cone& cone = (*problem.cones)[c];
        Island& of = *present[number_of[cone.i >= 0 ? cone.i : cone.j]];
        of.contacts.push_back(c);
        of.cones.push_back(cone);
        if (cone.i >= 0) of.cones.back().i = index[cone.i];
        if (cone.j >= 0) of.cones.back().j = index[cone.j];
    }
    for (Island* of : present) {
        int entry = 0;
        for (const int k : of->joint_rows)
            for (int n = problem.C_b->start[k]; n < problem.C_b->start[k + 1]; ++n, ++entry) {
                of->rows.entry[entry].r = problem.C_b->entry[n].r;
                of->rows.entry[entry].pi = problem.C_b->entry[n].pi;
            }
        of->problem.cones = &of->cones;
        of->problem.mu.resize(of->contacts.size());
        of->problem.beta.resize(of->contacts.size());
        of->x.p.resize(of->contacts.size());
        for (size_t c = 0; c < of->contacts.size(); ++c) of->problem.mu[c] = problem.mu[of->contacts[c]];
        of->solver.start(of->problem);
    }
}

void ConeIslands::remove(std::unique_ptr<Island>& island)
{
    count += island->solver.iterations();
    factored += island->solver.factorizations();
    island.reset();
}

int ConeIslands::island(int contact) const
{
    if (number < 2) return 0;
    const ConeRows::Cone& cone = (*of->cones)[contact];
    return number_of[cone.i >= 0 ? cone.i : cone.j];
}

double ConeIslands::residual(int contact) const
{
    return number < 2 ? residual_of_whole : present[island(contact)]->residual;
}

void ConeIslands::start(ConeProblem& problem)
{
    of = &problem;
    whole.start(problem);
    find_islands(problem);
    for (std::unique_ptr<Island>& island : kept)
        if (island && island->unused++ == most_unused) remove(island);
    if (number > 1) take_islands(problem);
}

ConeIslands::Outcome ConeIslands::solve(const ConeProblem& problem, Iterate& x, std::span<const double> start,
                                        ConeSolver::Tolerances to)
{
    if (number < 2) {
        to.start = *std::min_element(start.begin(), start.end());
        const Outcome outcome = whole.solve(problem, x, to);
        residual_of_whole = outcome.residual;
        return outcome;
    }
    whole.set_velocities(problem, x);
    x.offset.resize(x.p.size());
    Outcome worst;
    for (Island* of : present) {
        to.start = std::numeric_limits<double>::infinity();
        for (const int c : of->contacts) to.start = std::min(to.start, start[c]);
        const Outcome one = solve(problem, *of, x, to);
        if (one.status < worst.status) continue;
        if (one.status > worst.status || !(one.residual <= worst.residual)) {
            worst = one;
            if (one.worst >= 0) worst.worst = of->contacts[one.worst];
        }
    }
    x.residual = worst.residual;
    return worst;
}

ConeIslands::Outcome ConeIslands::solve(const ConeProblem& problem, Island& of, Iterate& x,
                                        const ConeSolver::Tolerances& to)
{
    const int n = static_cast<int>(of.bodies.size()), rows_at = 6 * problem.bodies();
    for (int b = 0; b < n; ++b) of.problem.q.segment<6>(6 * b) = problem.q.segment<6>(6 * of.bodies[b]);
    for (size_t k = 0; k < of.joint_rows.size(); ++k)
        of.problem.nu[static_cast<Eigen::Index>(k)] = problem.nu[of.joint_rows[k]];
    for (size_t c = 0; c < of.contacts.size(); ++c) {
        of.problem.beta[c] = problem.beta[of.contacts[c]];
        of.x.p[c] = x.p[of.contacts[c]];
    }
    const Outcome outcome = of.solver.solve(of.problem, of.x, to);
    of.residual = outcome.residual;
    for (int b = 0; b < n; ++b) x.y.segment<6>(6 * of.bodies[b]) = of.x.y.segment<6>(6 * b);
    for (size_t k = 0; k < of.joint_rows.size(); ++k)
        x.y[rows_at + of.joint_rows[k]] = of.x.y[6 * n + static_cast<Eigen::Index>(k)];
    for (size_t c = 0; c < of.contacts.size(); ++c) {
        x.p[of.contacts[c]] = of.x.p[c];
        x.offset[of.contacts[c]] = of.x.offset[c];
    }
    return outcome;
}

long ConeIslands::iterations() const
{
    long all = count + whole.iterations();
    for (const std::unique_ptr<Island>& island : kept)
        if (island) all += island->solver.iterations();
    return all;
}

long ConeIslands::factorizations() const
{
    long all = factored + whole.factorizations();
    for (const std::unique_ptr<Island>& island : kept)
        if (island) all += island->solver.factorizations();
    return all;
}

}  // namespace hilda::lie
