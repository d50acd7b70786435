// SPDX-License-Identifier: GPL-3.0-or-later
/// The built-in problems: models, initial states and reference solutions.

#include "studies/framework/problem.hpp"

#include "dae/kinematics.hpp"
#include "dae/model_file.hpp"
#include "reference/solvers/index1.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using studies::Problem;

namespace {

dae::Description started(const Problem& problem, const std::vector<std::string>& set = {})
{
    dae::Description d = dae::read_model(problem.model, problem.name, set);
    dae::start(*d.model, d.x);
    return d;
}

std::vector<std::string> all_names()
{
    std::vector<std::string> names = {"n_pendulum_1", "n_pendulum_5", "n_four_bar_1", "n_four_bar_5"};
    for (const Problem& p : studies::problems()) names.push_back(p.name);
    return names;
}

double distance(const lie::State& x, const lie::State& y)
{
    double sum = 0;
    REQUIRE(x.body.size() == y.body.size());
    for (size_t b = 0; b < x.body.size(); ++b) {
        const lie::Motion &a = x.body[b], &c = y.body[b];
        sum += (a.r - c.r).squaredNorm() + (a.A - c.A).squaredNorm() + (a.rdot - c.rdot).squaredNorm() +
               (a.omega_bar - c.omega_bar).squaredNorm();
    }
    return std::sqrt(sum);
}

/// Residual of the Newton-Euler equations, m r̈ - F - F^c and J̄ ω̄̇ + ω̄ × J̄ ω̄ - n̄ - n̄^c with the
/// constraint loads F^c, n̄^c, relative to the sum of the norms of the terms
double newton_euler_residual(const dae::Model& model, const lie::State& x)
{
    lie::Loads loads(model.bodies());
    model.loads(x, loads);
    const std::vector<dae::Reaction> reaction = dae::reactions(model, x);
    double residual = 0, size = 0;
    for (size_t b = 0; b < x.body.size(); ++b) {
        const lie::Motion& body = x.body[b];
        const lie::Mat3& J_bar = model.mass().J_bar[b];
        const lie::Vec3 force = model.mass().m[b] * body.rddot;
        const lie::Vec3 torque = J_bar * body.omegadot_bar + body.omega_bar.cross(J_bar * body.omega_bar);
        residual +=
            (force - loads.F[b] - reaction[b].F).norm() + (torque - loads.n_bar[b] - reaction[b].T).norm();
        size +=
            force.norm() + torque.norm() + loads.F[b].norm() + reaction[b].F.norm() + reaction[b].T.norm();
    }
    return residual / size;
}

double observable(const Problem& p, const dae::Description& d)
{
    const std::string body =
        p.observable.body.empty() ? d.model->all_bodies().back().name : p.observable.body;
    const lie::Motion& m = d.x.body[d.model->find(body)];
    const lie::Vec3& v = p.observable.component[0] == 'r'   ? m.r
                         : p.observable.component[0] == 'v' ? m.rdot
                                                            : m.omega_bar;
    return v[p.observable.component[1] - 'x'];
}

}  // namespace

TEST_CASE("the initial state of each built-in problem satisfies its constraints", "[studies][problems]")
{
    for (const std::string& name : all_names()) {
        INFO(name);
        const Problem p = studies::problem(name);
        CHECK(p.name == name);
        CHECK_FALSE(p.what.empty());
        CHECK_FALSE(p.reference_name.empty());
        dae::Description d = dae::read_model(p.model, p.name);
        CHECK(d.name == name);
        CHECK(d.warnings.empty());
        CHECK(d.end > 0);
        const dae::StartReport report = dae::start(*d.model, d.x);
        CHECK(report.position_residual < 1e-9);
        CHECK(report.velocity_residual < 1e-9);
        CHECK(std::isfinite(observable(p, d)));  // body and component exist
    }
}

TEST_CASE("each built-in problem has the expected number of degrees of freedom", "[studies][problems]")
{
    const std::pair<const char*, int> freedoms[] = {{"single_pendulum", 0},
                                                    {"slider_crank", 0},
                                                    {"four_link", 0},
                                                    {"four_link_table33", 0},
                                                    {"double_pendulum", 2},
                                                    {"double_pendulum_w005", 2},
                                                    {"n_pendulum", 6},
                                                    {"double_pendulum_moving", 2},
                                                    {"n_pendulum_2_spin", 6},
                                                    {"n_pendulum_8", 24},
                                                    {"free_top", 6},
                                                    {"heavy_top", 3},
                                                    {"rolling_ball", 6},
                                                    {"bouncing_ellipsoid", 6},
                                                    {"edge_mill", 3},
                                                    {"ball_in_bowl", 5},
                                                    {"rolling_ball_in_bowl", 3},
                                                    {"rocking_ellipsoid", 5},
                                                    {"rattleback", 3},
                                                    {"n_four_bar", 1},
                                                    {"n_four_bar_10", 1},
                                                    {"bricard", 1},
                                                    {"flyball_governor", 4}};
    for (const auto& [name, freedom] : freedoms) {
        INFO(name);
        dae::Description d = dae::read_model(studies::problem(name).model, name);
        const dae::StartReport report = dae::start(*d.model, d.x);
        CHECK(report.degrees_of_freedom == freedom);
        CHECK(report.dropped.empty());
    }
}

TEST_CASE(
    "the reference solution of each built-in problem satisfies its constraints and the Newton-Euler "
    "equations",
    "[studies][problems]")
{
    for (const std::string& name : all_names()) {
        const Problem p = studies::problem(name);
        dae::Description d = started(p);
        const std::vector<double> instants = {0, 0.02 * d.end};
        const lie::Trajectory reference_solution = p.reference_solution(d, instants);
        REQUIRE(reference_solution.row.size() == instants.size());
        CHECK(distance(reference_solution.row[0], d.x) < 1e-12);
        for (size_t k = 0; k < instants.size(); ++k) {
            const lie::State& x = reference_solution.row[k];
            INFO(name << " at " << instants[k]);
            CHECK(x.t == instants[k]);
            CHECK(d.model->largest_residual(x).value < 1e-12);
            CHECK(d.model->largest_velocity_residual(x).value < 1e-11);
            REQUIRE(x.lambda.size() == d.model->rows());
            CHECK(newton_euler_residual(*d.model, x) < 1e-11);
            for (const lie::Motion& body : x.body) CHECK(lie::orthogonality_error(body.A) < 1e-13);
        }
        CHECK(distance(reference_solution.row[0], reference_solution.row[1]) > 1e-3);  // it moves
    }
}

TEST_CASE("reference solutions agree with the index-1 equations, for changed models as well",
          "[studies][problems]")
{
    const std::pair<const char*, std::vector<std::string>> models[] = {
        {"double_pendulum", {}},
        {"double_pendulum", {"/bodies/0/mass=200", "/gravity=[1, 2, -5]"}},
        {"double_pendulum", {"/bodies/0/inertia=[300, 400, 500]", "/constraints/9/s_bar_q_j=[-1, 0, 0]"}},
        {"free_top", {}},
        {"free_top", {"/bodies/0/inertia=[0.02, 0.015, 0.01]", "/gravity=[0, 0, 0]"}},
        {"heavy_top", {}},
        {"heavy_top", {"/bodies/0/omega=[0, 1.2, 20]"}},
    };
    for (const auto& [name, set] : models) {
        INFO(name << (set.empty() ? "" : ", " + set[0]));
        const Problem p = studies::problem(name);
        dae::Description d = started(p, set);
        const std::vector<double> instants = {0.1};
        const lie::Trajectory reference_solution = p.reference_solution(d, instants),
                              by_index1 = reference::index1(*d.model, d.x, instants);
        for (size_t k = 0; k < instants.size(); ++k) {
            CHECK(distance(reference_solution.row[k], by_index1.row[k]) < 1e-9);
            CHECK((reference_solution.row[k].lambda - by_index1.row[k].lambda).norm() <=
                  1e-9 * by_index1.row[k].lambda.norm());
        }
    }
}

TEST_CASE("the reference solutions of driven problems agree with kinematic analysis", "[studies][problems]")
{
    for (const char* name : {"single_pendulum", "slider_crank", "four_link"}) {
        const Problem p = studies::problem(name);
        dae::Description d = started(p);
        const lie::Trajectory reference_solution = p.reference_solution(d, {0.05}),
                              run = dae::Kinematics(*d.model).run(d.x, 0.05, 1);
        CHECK(distance(reference_solution.row[0], run.row[1]) < 1e-11);
    }
}

TEST_CASE("problems are found by name, and the message of an unknown name contains the nearest one",
          "[studies][problems]")
{
    CHECK(std::is_sorted(studies::problems().begin(), studies::problems().end(),
                         [](const Problem& a, const Problem& b) { return a.name < b.name; }));
    CHECK_THROWS_WITH(studies::problem("slider_crnk"), Catch::Contains("did you mean 'slider_crank'?"));
    CHECK_THROWS_WITH(studies::problem("nothing_like_it"),
                      Catch::Contains("'nothing_like_it'") && Catch::Contains("double_pendulum, "));
    CHECK_THROWS_WITH(studies::problem("n_pendulum_0"), Catch::Contains("from 1 to 100000"));
    CHECK_THROWS_WITH(studies::problem("n_pendulum_007"), Catch::Contains("from 1 to 100000"));
    CHECK_THROWS_WITH(studies::problem("n_pendulum_100001"), Catch::Contains("from 1 to 100000"));
    CHECK_THROWS_WITH(studies::problem("n_pendulum_99999999999999999999"),
                      Catch::Contains("from 1 to 100000"));
    CHECK_THROWS_WITH(studies::problem("n_four_bar_0"), Catch::Contains("from 1 to 10000"));
    CHECK_THROWS_WITH(studies::problem("n_four_bar_10001"), Catch::Contains("N of n_four_bar_N"));
    CHECK_THROWS_WITH(studies::problem("n_pendulum_x"), Catch::Contains("no built-in model"));
    CHECK(studies::problem("n_pendulum").reference_solution);
    CHECK_THROWS_AS(io::Registry<Problem>::add(studies::problem("n_pendulum")), std::logic_error);
}

TEST_CASE("Andrews' squeezer agrees with the reference solution of Hairer and Wanner", "[studies][problems]")
{
    // Reference solution at 0.03 s: Solving ODEs II, Sec. VII.7. The angle of a body is the rotation of its
    // frame.
    dae::Description d = started(studies::problem("andrews_squeezer"));
    CHECK(d.model->dropped_rows().size() == 9);  // three loops of revolute joints in space
    const lie::State x = studies::problem("andrews_squeezer").reference_solution(d, {0.0, 0.03}).row.back();
    const auto angle = [&](const char* body) {
        const lie::Mat3& A = x.body[d.model->find(body)].A;
        return std::atan2(A(1, 0), A(0, 0));
    };
    constexpr double beta = 15.8107711962990, gamma = 0.0408222401307310, delta = 0.524409965880530,
                     epsilon = 1.04808074104226;
    constexpr double turn = 6.283185307179586;
    CHECK(std::abs(std::remainder(angle("K1") - beta, turn)) < 1e-8);
    CHECK(angle("K3") == Approx(gamma).margin(1e-9));
    CHECK(angle("K5") == Approx(delta).margin(1e-9));
    CHECK(angle("K7") == Approx(epsilon).margin(1e-9));
}
