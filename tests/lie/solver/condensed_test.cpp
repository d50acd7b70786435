// SPDX-License-Identifier: GPL-3.0-or-later
/// The condensed saddle system is compared with KLU on graphs of different topology.

#include "lie/solver/condensed.hpp"
#include "lie/check.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/system.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

#include <Eigen/LU>

using namespace hilda;
using lie::Mat3;
using lie::Vec3;

namespace {

/// Bodies with random rows between them. A joint has two bodies (-1: the ground) and a number of rows.
class Graph final : public lie::System {
public:
    struct Joint {
        int i, j, rows;
    };

    Graph(int bodies, const std::vector<Joint>& joints, unsigned seed) : random(seed)
    {
        for (int b = 0; b < bodies; ++b) {
            inertia.m.push_back(std::pow(10.0, random.number()));
            const Mat3 A = random.rotation();
            inertia.J_bar.push_back(A * Vec3(1, 2, 2.5).asDiagonal() * A.transpose());
        }
        for (const Joint& joint : joints)
            for (int k = 0; k < joint.rows; ++k) {
                for (const int b : {joint.i, joint.j})
                    if (b >= 0)
                        rows_pattern.entry.push_back(
                            {.body = b, .nonzero = 0b111111, .r = random.vector(), .pi = random.vector()});
                rows_pattern.start.push_back(static_cast<int>(rows_pattern.entry.size()));
            }
    }
    const lie::Mass& mass() const override { return inertia; }
    const lie::Rows& pattern() const override { return rows_pattern; }
    void loads(const lie::State&, lie::Loads&) const override {}
    void phi(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
    void nu(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
    void gamma(const lie::State&, Eigen::Ref<Eigen::VectorXd>) const override {}
    void variation(const lie::State&, lie::Rows& out) const override { out = rows_pattern; }

    lie::Rows rows_pattern;

private:
    tests::Random random;
    lie::Mass inertia;
};

using Joints = std::vector<Graph::Joint>;

Joints chain(int n)
{
    Joints all;
    for (int b = 0; b < n; ++b) all.push_back({b - 1, b, 3});
    return all;
}

struct Shape {
    std::string name;
    int bodies;
    Joints joints;
    bool fills_in;
};

std::vector<Shape> shapes()
{
    return {
        {"one body", 1, {{-1, 0, 2}}, false},
        {"free bodies beside a chain", 6, {{-1, 2, 3}, {2, 4, 5}}, false},
        {"chain", 9, chain(9), false},
        {"chain given backwards", 4, {{2, 3, 3}, {1, 2, 3}, {0, 1, 3}, {-1, 0, 3}}, false},
        {"tree", 7, {{-1, 0, 5}, {0, 1, 3}, {0, 2, 4}, {1, 3, 3}, {1, 4, 1}, {2, 5, 2}, {2, 6, 3}}, false},
        {"loop", 5, {{-1, 0, 3}, {0, 1, 3}, {1, 2, 3}, {2, 3, 3}, {3, 4, 3}, {4, -1, 3}}, false},
        {"ring of rings",
         6,
         {{0, 1, 2}, {1, 2, 2}, {2, 0, 2}, {2, 3, 2}, {3, 4, 2}, {4, 5, 2}, {5, 3, 2}},
         true},
        {"two joints between the same bodies", 2, {{-1, 0, 3}, {0, 1, 3}, {-1, 0, 1}, {0, 1, 1}}, false},
        {"two joints with the bodies in opposite order", 2, {{0, 1, 3}, {1, 0, 2}}, false},
    };
}

}  // namespace

TEST_CASE("the condensed saddle system has the same solution as the full one", "[lie][saddle][condensed]")
{
    const unsigned seed = GENERATE(1u, 2u);
    for (const Shape& shape : shapes()) {
        const Graph graph(shape.bodies, shape.joints, seed);
        lie::Saddle K(graph, lie::Metric::mass, lie::LinearSolver::condensed), whole(graph);
        K.assemble({});
        whole.assemble({});
        const Eigen::VectorXd z = Eigen::VectorXd::Random(K.size());
        Eigen::VectorXd b(K.size()), c;
        K.multiply(z, b);
        c = b;
        K.solve(b);
        whole.solve(c);
        INFO(shape.name);
        CHECK((b - z).norm() < 1e-10 * z.norm());
        CHECK((b - c).norm() < 1e-10 * z.norm());
        CHECK(K.refactorizations() == 1);
        CHECK(K.factorizations() == 0);
    }
}

TEST_CASE("a chain or a tree has no fill-in", "[lie][condensed]")
{
    for (const Shape& shape : shapes()) {
        const Graph graph(shape.bodies, shape.joints, 1);
        INFO(shape.name);
        if (!shape.fills_in)
            CHECK(lie::Condensed(graph.mass(), graph.pattern()).fill_in() <= (shape.name == "loop" ? 3 : 0));
    }
    const Graph small(100, chain(100), 1), large(200, chain(200), 1);
    const double ratio = lie::Condensed(large.mass(), large.pattern()).operations() /
                         lie::Condensed(small.mass(), small.pattern()).operations();
    CHECK(ratio == Approx(2).epsilon(0.02));
}

TEST_CASE("rows that depend on single components of r have the same solution", "[lie][condensed]")
{
    // The masks of joints: coincident points (row k depends on component k of r), orthogonal axes (on none)
    // and distances (on all of one body); with some rows dropped, and more than four between the same bodies.
    struct Row {
        unsigned of_i, of_j;
    };
    constexpr unsigned x = 1, y = 2, z = 4, rotation = 0b111000;
    const std::vector<std::vector<Row>> joints{
        {{0, x}, {0, y}, {0, z}, {0, 0}, {0, 0}},
        {{x, x}, {y, y}, {z, z}, {0, 0}},
        {{y, y}, {z, z}, {0, 0}, {0, 0}},
        {{x, x}, {z, z}, {7, 7}},
        {{7, 0}, {0, 7}},
        {{x, x}, {y, y}, {z, z}, {x, x}, {y, y}, {z, z}},
    };
    const int bodies_i[] = {-1, 0, 1, 1, 2, 0}, bodies_j[] = {0, 1, 2, 3, 3, 4};
    Joints all;
    for (size_t n = 0; n < joints.size(); ++n)
        all.push_back({bodies_i[n], bodies_j[n], static_cast<int>(joints[n].size())});
    Graph graph(5, all, 6);
    auto entry = graph.rows_pattern.entry.begin();
    for (size_t n = 0; n < joints.size(); ++n)
        for (const Row& row : joints[n])
            for (const int end : {0, 1}) {
                if ((end == 0 ? bodies_i : bodies_j)[n] < 0) continue;
                entry->nonzero = rotation | (end == 0 ? row.of_i : row.of_j);
                for (int c = 0; c < 3; ++c)
                    if (!(entry->nonzero >> c & 1)) entry->r[c] = 0;
                ++entry;
            }
    REQUIRE(entry == graph.rows_pattern.entry.end());
    lie::Saddle K(graph, lie::Metric::mass, lie::LinearSolver::condensed);
    K.assemble({});
    const Eigen::VectorXd exact = Eigen::VectorXd::Random(K.size());
    Eigen::VectorXd b(K.size());
    K.multiply(exact, b);
    K.solve(b);
    CHECK(K.factorizations() == 0);
    CHECK((b - exact).norm() < 1e-10 * exact.norm());
}

TEST_CASE("KLU replaces the condensed system while rows are nearly dependent", "[lie][condensed]")
{
    Graph graph(2, {{-1, 0, 3}, {0, 1, 3}}, 4);
    auto& entry = graph.rows_pattern.entry;
    lie::Saddle K(graph, lie::Metric::mass, lie::LinearSolver::condensed);
    K.assemble({});
    CHECK(K.factorizations() == 0);
    const lie::Rows healthy = graph.rows_pattern;

    const Eigen::VectorXd z = Eigen::VectorXd::Random(K.size());
    Eigen::VectorXd b(K.size()), c;
    const Vec3 difference = entry[1].r;
    entry[1].pi = entry[0].pi;
    // Row 1 equals row 0 up to 1e-5. S contains the square of the difference: the multipliers lose ten
    // digits, and the motion five, which are refined in a step.
    const auto solve_with = [&](double part) {
        entry[1].r = entry[0].r + part * difference;
        K.assemble({});
        K.multiply(z, b);
        c = b;
        K.solve(b);
    };
    solve_with(1e-5);
    CHECK(K.factorizations() == 0);
    K.solve_in_step(c);
    const auto error_of_motion = [&](const Eigen::VectorXd& of) { return (of - z).head(12).norm(); };
    CHECK((b - z).norm() < 1e-3 * z.norm());
    CHECK(error_of_motion(b) < 1e-7 * z.norm());
    CHECK(error_of_motion(c) < 1e-10 * z.norm());

    solve_with(1e-7);
    CHECK(K.factorizations() == 1);
    lie::Saddle whole(graph);
    whole.assemble({});
    whole.solve(c);
    CHECK(b == c);

    entry[1].r = entry[0].r;  // equal rows
    CHECK_THROWS_AS(K.assemble({}), lie::SingularMatrix);
    entry[1].r.x() = std::nan("");
    CHECK_THROWS_AS(K.assemble({}), lie::NonFinite);

    graph.rows_pattern = healthy;
    K.assemble({});
    K.multiply(z, b);
    K.solve(b);
    CHECK((b - z).norm() < 1e-11 * z.norm());
}

TEST_CASE("the automatic choice of the solver takes the one with fewer operations", "[lie][condensed]")
{
    const Graph long_chain(50, chain(50), 1);
    CHECK(lie::Saddle(long_chain, lie::Metric::mass, lie::LinearSolver::automatic).is_condensed());
    // All rows share body 0: S is dense, K is sparse.
    Joints spokes;
    for (int b = 1; b < 40; ++b) spokes.push_back({0, b, 3});
    const Graph hub(40, spokes, 1);
    CHECK_FALSE(lie::Saddle(hub, lie::Metric::mass, lie::LinearSolver::automatic).is_condensed());
}
