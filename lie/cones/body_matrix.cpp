// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/cones/body_matrix.hpp"

#include "lie/solver/minimum_degree.hpp"

#include <algorithm>
#include <set>

namespace hilda::lie {

BodyMatrix::BodyMatrix(const Mass& mass, const Rows& pattern)
    : mass(mass), pattern(pattern), bodies(static_cast<int>(mass.m.size())), of_body(mass.m.size())
{
    constexpr double relative = 1e-12;
    for (const double m : mass.m) epsilon += relative / (m * bodies);
    residual.setZero(6 * bodies + pattern.rows());
}

void BodyMatrix::set_contacts(const ConeProblem& of)
{
    pairs.clear();
    for (const ConeRows::Cone& cone : *of.cones)
        if (cone.i >= 0 && cone.j >= 0) pairs.push_back({std::min(cone.i, cone.j), std::max(cone.i, cone.j)});
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    pair_of.clear();
    for (const ConeRows::Cone& cone : *of.cones) {
        const Pair pair = {std::min(cone.i, cone.j), std::max(cone.i, cone.j)};
        const auto found = std::lower_bound(pairs.begin(), pairs.end(), pair);
        pair_of.push_back(pair[0] < 0 ? -1 : static_cast<int>(found - pairs.begin()));
    }
    of_pair.resize(pairs.size());
    choose_analysis();
}

void BodyMatrix::choose_analysis()
{
    const auto found = std::find_if(analyses.begin(), analyses.end(),
                                    [&](const auto& analysis) { return analysis->pairs == pairs; });
    if (found != analyses.end()) {
        std::rotate(analyses.begin(), found, found + 1);
        return;
    }
    if (analyses.size() == most_analyses) analyses.pop_back();
    analyses.insert(analyses.begin(), analysed());
}

std::unique_ptr<BodyMatrix::Analysis> BodyMatrix::analysed() const
{
    auto analysis = std::make_unique<Analysis>();
    Analysis& a = *analysis;
    a.pairs = pairs;
    for (int b = 0; b < bodies; ++b) a.diagonal.push_back(a.N.declare(6 * b, 6 * b, 6, 6));
    for (const auto& [i, j] : pairs) {
        a.upper.push_back(a.N.declare(6 * i, 6 * j, 6, 6));
        a.lower.push_back(a.N.declare(6 * j, 6 * i, 6, 6));
    }
    for (int k = 0; k < pattern.rows(); ++k) {
        const int row = 6 * bodies + k;
        a.regularisation.push_back(a.N.declare(row, row, 1, 1));
        for (int n = pattern.start[k]; n < pattern.start[k + 1]; ++n) {
            a.row.push_back(a.N.declare(row, 6 * pattern.entry[n].body, 1, 6));
            a.column.push_back(a.N.declare(6 * pattern.entry[n].body, row, 6, 1));
        }
    }
    a.N.analyse(6 * bodies + pattern.rows(), order(a));
    return analysis;
}

std::vector<int> BodyMatrix::order(const Analysis& of) const
{
    std::vector<std::set<int>> neighbours(bodies);
    const auto connect = [&](int i, int j) {
        if (i != j) neighbours[i].insert(j), neighbours[j].insert(i);
    };
    for (const auto& [i, j] : of.pairs) connect(i, j);
    for (int k = 0; k < pattern.rows(); ++k)
        for (int n = pattern.start[k]; n < pattern.start[k + 1]; ++n)
            for (int l = pattern.start[k]; l < n; ++l) connect(pattern.entry[n].body, pattern.entry[l].body);
    const std::vector<int> body_order = minimum_degree_order(neighbours);

    std::vector<int> position(bodies);
    for (int n = 0; n < bodies; ++n) position[body_order[n]] = n;
    std::vector<std::vector<int>> rows_of(bodies);  // the rows that follow a body
    std::vector<int> all;
    for (int k = 0; k < pattern.rows(); ++k) {
        int last = -1;
        for (int n = pattern.start[k]; n < pattern.start[k + 1]; ++n)
            last = std::max(last, position[pattern.entry[n].body]);
        if (last < 0)
            all.push_back(6 * bodies + k);
        else
            rows_of[body_order[last]].push_back(6 * bodies + k);
    }
    for (const int b : body_order) {
        for (int c = 0; c < 6; ++c) all.push_back(6 * b + c);
        all.insert(all.end(), rows_of[b].begin(), rows_of[b].end());
    }
    return all;
}

void BodyMatrix::factor_joints(const ConeProblem& of)
{
    problem = &of;
    weights = nullptr;
    pairs.clear();
    choose_analysis();
    factor();
}

void BodyMatrix::factor(const ConeProblem& of, const std::vector<Mat3>& W)
{
    problem = &of;
    weights = &W;
    factor();
}

void BodyMatrix::factor()
{
    ++count;
    for (int b = 0; b < bodies; ++b) {
        of_body[b].setZero();
        of_body[b].diagonal().head<3>().setConstant(mass.m[b]);
        of_body[b].bottomRightCorner<3, 3>() = mass.J_bar[b];
    }
    for (PairBlocks& blocks : of_pair) blocks.upper.setZero(), blocks.lower.setZero();
    const int contacts = weights != nullptr ? problem->contacts() : 0;
    for (int c = 0; c < contacts; ++c) {
        const ConeRows::Cone& cone = (*problem->cones)[c];
        const Mat3& W = (*weights)[c];
        const ConeRows::Mat36 W_C_i = W * cone.C_i, W_C_j = W * cone.C_j;
        if (cone.i >= 0) of_body[cone.i].noalias() += cone.C_i.transpose() * W_C_i;
        if (cone.j >= 0) of_body[cone.j].noalias() += cone.C_j.transpose() * W_C_j;
        if (pair_of[c] < 0) continue;
        PairBlocks& blocks = of_pair[pair_of[c]];
        (cone.i < cone.j ? blocks.upper : blocks.lower).noalias() += cone.C_i.transpose() * W_C_j;
        (cone.i < cone.j ? blocks.lower : blocks.upper).noalias() += cone.C_j.transpose() * W_C_i;
    }
    Analysis& a = *analyses.front();
    a.N.set_zero();
    for (int b = 0; b < bodies; ++b) a.N.add(a.diagonal[b], of_body[b]);
    for (size_t k = 0; k < pairs.size(); ++k) {
        a.N.add(a.upper[k], of_pair[k].upper);
        a.N.add(a.lower[k], of_pair[k].lower);
    }
    const Rows& C = *problem->C_b;
    for (int k = 0; k < C.rows(); ++k) {
        a.N.add(a.regularisation[k], -epsilon);
        for (int n = C.start[k]; n < C.start[k + 1]; ++n) {
            Eigen::Matrix<double, 6, 1> entry;
            entry << C.entry[n].r, C.entry[n].pi;
            a.N.add(a.row[n], entry.transpose());
            a.N.add(a.column[n], entry);
        }
    }
    a.N.factor();
}

void BodyMatrix::solve(const Eigen::VectorXd& b, Eigen::VectorXd& y)
{
    MultifrontalLu<double>& N = analyses.front()->N;
    y = b;
    N.solve(y);
    if (pattern.rows() == 0) return;
    set_residual(b, y);
    N.solve(residual);
    y += residual;
}

void BodyMatrix::set_residual(const Eigen::VectorXd& b, const Eigen::VectorXd& y)
{
    const Rows& C = *problem->C_b;
    residual = b;
    for (int i = 0; i < bodies; ++i) {
        const ConeProblem::Vec6 of = y.segment<6>(6 * i);
        residual.segment<6>(6 * i) -= problem->times_mass(i, of);
    }
    const int contacts = weights != nullptr ? problem->contacts() : 0;
    for (int c = 0; c < contacts; ++c) problem->add_impulse(c, -((*weights)[c] * problem->u(c, y)), residual);
    C.add_transpose(-1, y.tail(C.rows()), residual);
    for (int k = 0; k < C.rows(); ++k) residual[6 * bodies + k] -= C.dot(k, y);
}

}  // namespace hilda::lie
