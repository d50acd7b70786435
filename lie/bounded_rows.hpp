// SPDX-License-Identifier: GPL-3.0-or-later
/// How much softer rows that give way are taken, so that their multipliers keep to their bounds.
///
/// With p times the softness the multipliers of a pair are of length |λ|(p), and p is sought with
///
///     f(p) = μ N/|λ| = 1,  p > 1,    or p = 1 where f(1) ≥ 1: it sticks
///
/// 1/|λ| is linear in p where the mass against both rows is the same, as that of a sphere is, and nearly so elsewhere: this
/// is the secular equation of the step of least length within a trust region. The first step is p/f, exact where nothing but
/// p resists, and from then on they are those of the secant: the third solution is that of a sphere. N is of the same
/// solution. The solution is the return to the bound against the motion that is left, also where the mass depends on the
/// direction and the force that would stick does not point there.

#pragma once

#include "lie/solver/saddle.hpp"

namespace hilda::lie {

class BoundedRows {
public:
    explicit BoundedRows(const Rows& pattern) : search(pattern.regularised.size()) {}

    /// To begin with; K is assembled after it.
    void all_stick(Saddle& K);
    /// Whether the multipliers in z keep to the bounds of C, the rows at the node. If not K is factored with other p, those
    /// that are early first, and is to be solved again.
    bool operator()(Saddle& K, const Rows& C, Eigen::VectorXd& z, const State& x);

private:
    struct Search {
        int solutions = 0;
        double p = 1, f = 1;  ///< of the last but one
        double sticking = 0;  ///< |λ|(1)
    };
    static double next_scale(Search& s, double p, double bound, double length);

    std::vector<Search> search;
};

}  // namespace hilda::lie
