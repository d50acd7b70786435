// SPDX-License-Identifier: GPL-3.0-or-later
/// Cone problems of the islands of bodies that contact points and joints connect.
///
/// The ground does not connect bodies. The problem of each island has its own matrix, penalty, acceleration
/// and iteration: islands at rest need no iteration while others move, and an island does not depend on the
/// others. The velocities of bodies without contact points follow from the joints alone, whose matrix is
/// factored as a whole. If all contact points belong to one island, the problem is solved as a whole.

#pragma once

#include "lie/cones/cone_solver.hpp"

#include <memory>
#include <span>
#include <vector>

namespace hilda::lie {

class ConeIslands {
public:
    using Iterate = ConeProblem::Iterate;
    using Outcome = ConeSolver::Outcome;

    ConeIslands(const Mass& mass, const Rows& pattern);

    /// Finds the islands, and factors the matrices of the joints. Called once before solve() for each
    /// configuration. The contact points must remain unchanged until the last solve().
    void start(ConeProblem& problem);
    /// See ConeSolver::set_velocities().
    void set_velocities(const ConeProblem& problem, Iterate& x) { whole.set_velocities(problem, x); }
    /// See ConeSolver::solve(). An island takes the smallest one of the tolerances `start` of its contact
    /// points. The status, the residual and the contact point of the outcome are those of the worst island.
    Outcome solve(const ConeProblem& problem, Iterate& x, std::span<const double> start,
                  ConeSolver::Tolerances to);

    int islands() const { return number; }  ///< with contact points
    int island(int contact) const;          ///< of a contact point, from 0
    double residual(int contact) const;     ///< of its island in the last solution [m/s]
    long iterations() const;
    long factorizations() const;

private:
    struct Island {
        Island(const ConeProblem& of, std::vector<int> of_bodies, std::vector<int> of_rows);

        const std::vector<int> bodies, joint_rows;  ///< their numbers in the whole problem, ascending
        Mass mass;
        Rows rows;
        std::vector<int> contacts;  ///< the same
        ConeProblem::Cones cones;   ///< with the body numbers of the island
        ConeProblem problem;
        ConeSolver solver;
        Iterate x;
        double residual = 0;  ///< of the last solution [m/s]
        int unused = 0;       ///< number of calls of start() since the last one with this island
    };
    void find_islands(const ConeProblem& problem);
    void take_islands(const ConeProblem& problem);
    void remove(std::unique_ptr<Island>& island);
    int root(int body);
    Outcome solve(const ConeProblem& problem, Island& of, Iterate& x, const ConeSolver::Tolerances& to);

    const Rows& pattern;
    const ConeProblem* of = nullptr;  ///< the problem of start()
    ConeSolver whole;
    double residual_of_whole = 0;
    int number = 0;
    std::vector<int> parent;                     ///< of each body, for the search
    std::vector<int> number_of;                  ///< island of a body; -1 without contact points
    std::vector<int> index;                      ///< of a body in its island
    std::vector<std::vector<int>> bodies, rows;  ///< of each island
    std::vector<std::unique_ptr<Island>> kept;   ///< by the first body; null without an island
    std::vector<Island*> present;                ///< the islands of this problem
    long count = 0, factored = 0;                ///< of the islands that were removed
};

}  // namespace hilda::lie
