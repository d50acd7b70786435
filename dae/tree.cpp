// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/tree.hpp"

#include "dae/constraints/dp1.hpp"
#include "dae/constraints/dp2.hpp"
#include "dae/joints/rows.hpp"
#include "dae/model.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

namespace hilda::dae {

namespace {

using Kind = lie::TreeJoint::Kind;

// Largest sine of an angle between two directions that are taken as parallel, and smallest one of two that
// are taken as independent
constexpr double parallel_sine = 1e-9, independent_sine = 1e-6;

/// The rows between two bodies
struct PairOfBodies {
    std::vector<int> row;
    std::vector<PointRow> point;
    std::vector<const DP1*> angle;
    std::vector<const DP2*> line;
};

bool is_zero(const Driver& f) { return f.is_constant() && f.f(0) == 0; }

/// A frame whose third axis is this unit vector
Mat3 frame(const Vec3& axis)
{
    const Perpendicular p(axis);
    Mat3 F;
    F << p.first, p.second, axis;
    return F;
}

/// Adds a row. Returns false if it is not one of a joint that keeps two points or directions together.
bool add(PairOfBodies& pair, const Block& block, int k)
{
    pair.row.push_back(k);
    if (const std::optional<PointRow> of = block.point_row(); of) {
        pair.point.push_back(*of);
        // Points on the ground may have an offset.
        PointRow& row = pair.point.back();
        if (row.f != 0 && row.i == ground) row.s_bar_i[row.axis] += row.f / row.c, row.f = 0;
        if (row.f != 0 && row.j == ground) row.s_bar_j[row.axis] -= row.f / row.c, row.f = 0;
        return row.f == 0;
    }
    if (const auto* angle = dynamic_cast<const DP1*>(&block)) {
        pair.angle.push_back(angle);
        return is_zero(angle->f);
    }
    if (const auto* line = dynamic_cast<const DP2*>(&block)) {
        pair.line.push_back(line);
        return is_zero(line->f);
    }
    return false;
}

/// A vector of a DP1 row in body b
const Vec3& vector_in(const DP1& row, int b) { return row.i == b ? row.a_bar_i : row.a_bar_j; }

bool are_parallel(const Vec3& a, const Vec3& b)
{
    return a.cross(b).norm() < parallel_sine * a.norm() * b.norm();
}

/// The direction, in body b, that both rows keep perpendicular to two directions of the other body, which is
/// then an axis of both; nothing if there is none
std::optional<Vec3> common_axis(const PairOfBodies& pair, int b, int other)
{
    const DP1 &first = *pair.angle[0], &second = *pair.angle[1];
    if (!are_parallel(vector_in(first, b), vector_in(second, b))) return {};
    const Vec3 p = vector_in(first, other).normalized(), q = vector_in(second, other).normalized();
    if (p.cross(q).norm() < independent_sine) return {};
    return vector_in(first, b).normalized();
}

/// Whether the DP1 rows keep the orientation
bool keeps_orientation(const PairOfBodies& pair, const State& x)
{
    if (pair.angle.size() != 3) return false;
    Mat3 directions;  // of the relative rotations that each row prevents
    for (int k = 0; k < 3; ++k) {
        const DP1& row = *pair.angle[static_cast<size_t>(k)];
        directions.col(k) = (motion(x, row.i).A * row.a_bar_i).cross(motion(x, row.j).A * row.a_bar_j);
        directions.col(k).normalize();
    }
    return std::abs(directions.determinant()) > independent_sine;
}

/// The joint with these rows, from body i to body j; nothing if they are not those of one joint
std::optional<lie::TreeJoint> joint_of(PairOfBodies& pair, int i, int j, const State& x)
{
    lie::TreeJoint joint{.before = i, .body = j};
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    if (pair.point.size() == 3 && pair.line.empty()) {
        Vec3 s_i = Vec3::Zero(), s_j = Vec3::Zero();
        unsigned axes = 0;
        for (PointRow& row : pair.point) {
            if (row.i != i) std::swap(row.i, row.j), std::swap(row.s_bar_i, row.s_bar_j);
            axes |= 1u << row.axis;
        }
        // A point of the ground may be given by one component in each row.
        const PointRow& first = pair.point.front();
        s_i = first.s_bar_i, s_j = first.s_bar_j;
        for (const PointRow& row : pair.point) {
            if (i == ground) s_i[row.axis] = row.s_bar_i[row.axis];
            if (j == ground) s_j[row.axis] = row.s_bar_j[row.axis];
            if ((i != ground && row.s_bar_i != s_i) || (j != ground && row.s_bar_j != s_j)) return {};
        }
        if (axes != 0b111) return {};
        joint.s_bar_i = s_i, joint.s_bar_j = s_j;
        if (pair.angle.empty()) {
            joint.kind = Kind::ball;
            return joint;
        }
        if (pair.angle.size() == 2) {
            Vec3 axis_i, axis_j;
            if (const auto in_j = common_axis(pair, j, i); in_j) {
                axis_j = *in_j;
                axis_i = vector_in(*pair.angle[0], i).cross(vector_in(*pair.angle[1], i)).normalized();
            } else if (const auto in_i = common_axis(pair, i, j); in_i) {
                axis_i = *in_i;
                axis_j = vector_in(*pair.angle[0], j).cross(vector_in(*pair.angle[1], j)).normalized();
            } else {
                return {};
            }
            if ((bi.A * axis_i).dot(bj.A * axis_j) < 0) axis_i = -axis_i;
            joint.kind = Kind::hinge;
            joint.F_i = frame(axis_i), joint.F_j = frame(axis_j);
            return joint;
        }
        if (!keeps_orientation(pair, x)) return {};
        joint.kind = Kind::fixed;
        joint.F_j = lie::nearest_rotation(bj.A.transpose() * bi.A);
        return joint;
    }
    if (pair.point.empty() && pair.line.size() == 2 && keeps_orientation(pair, x)) {
        // The rows keep Q on a line through P in body `of`, and the orientation is fixed.
        const DP2 &first = *pair.line[0], &second = *pair.line[1];
        const int of = first.i;
        if (second.i != of || first.s_bar_i != second.s_bar_i || first.s_bar_j != second.s_bar_j) return {};
        const Vec3 across = first.a_bar_i.normalized().cross(second.a_bar_i.normalized());
        if (across.norm() < independent_sine) return {};
        const Vec3 axis = motion(x, of).A * across.normalized();
        joint.kind = Kind::slide;
        joint.s_bar_i = of == i ? first.s_bar_i : first.s_bar_j;
        joint.s_bar_j = of == i ? first.s_bar_j : first.s_bar_i;
        joint.F_i = frame(bi.A.transpose() * axis);
        joint.F_j = lie::nearest_rotation(bj.A.transpose() * (bi.A * joint.F_i));
        return joint;
    }
    return {};
}

}  // namespace

lie::Tree find_tree(const Model& model, const State& x)
{
    lie::Tree tree;
    const auto refused = [&](const std::string& why) { return lie::Tree{.joint = {}, .refusal = why}; };
    if (!model.general_constraints().empty())
        return refused(model.name_of(*model.general_constraints().front()) + " is not a joint of a tree");
    if (!model.dropped_rows().empty())
        return refused(model.name_of(model.all_rows()[model.dropped_rows().front()]) +
                       " is redundant, and not a row of a tree");
    std::map<std::pair<int, int>, PairOfBodies> pairs;
    for (const int k : model.active_rows()) {
        const Model::Row& row = model.all_rows()[k];
        const auto [i, j] = std::minmax(row.block->i, row.block->j);
        if (!add(pairs[{i, j}], *row.block, k))
            return refused(model.name_of(row) +
                           " is not a row of a revolute, translational, spherical or fixed joint");
    }

    // Breadth first from the ground; then from the first body that is not reached, which is free
    const int bodies = model.bodies();
    std::vector<std::vector<std::pair<int, PairOfBodies*>>> neighbours(static_cast<size_t>(bodies) + 1);
    for (auto& [of, pair] : pairs) {
        neighbours[of.first + 1].emplace_back(of.second, &pair);
        neighbours[of.second + 1].emplace_back(of.first, &pair);
    }
    std::vector<const PairOfBodies*> joined(static_cast<size_t>(bodies) + 1, nullptr);
    std::vector<bool> reached(static_cast<size_t>(bodies) + 1, false);
    std::vector<int> next{ground};
    reached[0] = true;
    int unreached = 0;
    for (size_t n = 0; n < next.size(); ++n) {
        const int i = next[n];
        for (const auto& [j, pair] : neighbours[i + 1]) {
            if (pair == joined[i + 1]) continue;
            const std::string of = model.name_of(model.all_rows()[pair->row.front()]);
            if (reached[j + 1]) return refused(of + " closes a loop");
            std::optional<lie::TreeJoint> joint = joint_of(*pair, i, j, x);
            if (!joint)
                return refused(of +
                               " and the other rows between its bodies are not those of one revolute, "
                               "translational, spherical or fixed joint");
            tree.joint.push_back(std::move(*joint));
            joined[j + 1] = pair;
            reached[j + 1] = true;
            next.push_back(j);
        }
        if (n + 1 < next.size()) continue;
        while (unreached < bodies && reached[unreached + 1]) ++unreached;
        if (unreached == bodies) break;
        tree.joint.push_back({.kind = Kind::free, .body = unreached});
        reached[unreached + 1] = true;
        next.push_back(unreached);
    }
    return tree;
}

}  // namespace hilda::dae
