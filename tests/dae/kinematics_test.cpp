// SPDX-License-Identifier: GPL-3.0-or-later
/// Kinematic analysis of the slider-crank and the four-link mechanism compared with reference trajectories,
/// and inverse dynamics.

#include "dae/kinematics.hpp"

#include "dae/constraints/dp1.hpp"
#include "dae/constraints/driven_hinge.hpp"
#include "dae/joints.hpp"
#include "dae/start.hpp"
#include "tests/support/mechanisms.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

#include <fstream>
#include <functional>
#include <numbers>

using namespace hilda;
using namespace hilda::dae;

namespace {

using std::numbers::pi;

/// The numbers of a CSV file without its header line
std::vector<std::vector<double>> table(const std::string& file)
{
    std::ifstream in(std::string(tests::test_data) + "/" + file);
    INFO("cannot read " << file);
    REQUIRE(in);
    std::vector<std::vector<double>> rows;
    std::string line, cell;
    std::getline(in, line);
    while (std::getline(in, line)) {
        rows.emplace_back();
        std::istringstream cells(line);
        while (std::getline(cells, cell, ',')) rows.back().push_back(std::strtod(cell.c_str(), nullptr));
    }
    return rows;
}

/// A row of the reference: t; then r, A (row major), ṙ, ω̄ of each body; then r̈, ω̄̇, resultant constraint
/// force (global frame) and torque (body frame) of each body
struct Reference {
    double t;
    std::vector<Motion> body;
    std::vector<Reaction> reaction;

    explicit Reference(const std::vector<double>& row) : t(row[0])
    {
        const size_t bodies = (row.size() - 1) / 30;
        for (size_t b = 0; b < bodies; ++b) {
            const double* p = &row[1 + 18 * b];
            const double* q = &row[1 + 18 * bodies + 12 * b];
            Motion m;
            m.r = Vec3(p[0], p[1], p[2]);
            m.A = tests::matrix({p[3], p[4], p[5]}, {p[6], p[7], p[8]}, {p[9], p[10], p[11]});
            m.rdot = Vec3(p[12], p[13], p[14]), m.omega_bar = Vec3(p[15], p[16], p[17]);
            m.rddot = Vec3(q[0], q[1], q[2]), m.omegadot_bar = Vec3(q[3], q[4], q[5]);
            body.push_back(m);
            reaction.push_back({Vec3(q[6], q[7], q[8]), Vec3(q[9], q[10], q[11])});
        }
    }
};

std::vector<Reference> references(const std::string& file)
{
    std::vector<Reference> all;
    for (const auto& row : table(file)) all.emplace_back(row);
    return all;
}

/// Largest deviations over a run: absolute for r and A; relative to max(1, norm) for velocities and
/// accelerations; relative to the largest value of the run for forces and torques
struct Deviation {
    double r = 0, A = 0, rdot = 0, omega_bar = 0, rddot = 0, omegadot_bar = 0, F = 0, T = 0;
};

Deviation deviation(const Model& model, const std::vector<State>& run,
                    const std::vector<Reference>& reference)
{
    Deviation result;
    double largest_F = 0, largest_T = 0;
    const auto update_max = [](double& largest, double value) { largest = std::max(largest, value); };
    const auto relative = [](const Vec3& a, const Vec3& b) {
        return (a - b).norm() / std::max(1.0, b.norm());
    };
    REQUIRE(run.size() <= reference.size());
    for (size_t k = 0; k < run.size(); ++k) {
        REQUIRE(run[k].t == Approx(reference[k].t).margin(1e-14));
        const std::vector<Reaction> reaction = reactions(model, run[k]);
        REQUIRE(reference[k].body.size() == reaction.size());
        for (size_t b = 0; b < reaction.size(); ++b) {
            const Motion &x = run[k].body[b], &y = reference[k].body[b];
            update_max(result.r, (x.r - y.r).norm());
            update_max(result.A, (x.A - y.A).norm());
            update_max(result.rdot, relative(x.rdot, y.rdot));
            update_max(result.omega_bar, relative(x.omega_bar, y.omega_bar));
            update_max(result.rddot, relative(x.rddot, y.rddot));
            update_max(result.omegadot_bar, relative(x.omegadot_bar, y.omegadot_bar));
            update_max(result.F, (reaction[b].F - reference[k].reaction[b].F).norm());
            update_max(result.T, (reaction[b].T - reference[k].reaction[b].T).norm());
            update_max(largest_F, reference[k].reaction[b].F.norm());
            update_max(largest_T, reference[k].reaction[b].T.norm());
        }
    }
    result.F /= largest_F;
    result.T /= largest_T;
    return result;
}

void check_deviation(const Deviation& d)
{
    INFO("r " << d.r << ", A " << d.A << ", rdot " << d.rdot << ", omega " << d.omega_bar << ", rddot "
              << d.rddot << ", omegadot " << d.omegadot_bar << ", F " << d.F << ", T " << d.T);
    CHECK(d.r < 1e-11);
    CHECK(d.A < 1e-11);
    CHECK(d.rdot < 1e-10);
    CHECK(d.omega_bar < 1e-10);
    CHECK(d.rddot < 1e-10);
    CHECK(d.omegadot_bar < 1e-10);
    CHECK(d.F < 1e-9);
    CHECK(d.T < 1e-9);
}

struct Mechanism {
    std::string name;
    void (*build)(Model&, State&);
    double rate;  ///< angular velocity of the driven body about global x [rad/s]
};

const Mechanism mechanisms[] = {
    {"slider_crank", [](Model& m, State& x) { tests::slider_crank(m, x); }, -2 * pi},
    {"four_link", [](Model& m, State& x) { tests::four_link(m, x); }, pi},
};

/// The slider-crank modelled by joints: the same motion with other rows, and with a driver without
/// singularity
void slider_crank_of_joints(Model& model, State& x)
{
    tests::slider_crank_bodies(model, x);
    const Vec3 X = Vec3::UnitX(), Y = Vec3::UnitY(), Z = Vec3::UnitZ(), O = Vec3::Zero();
    constexpr int crank = 0, rod = 1, slider = 2;
    model.constrain("A", revolute(ground, {0, 0.1, 0.12}, X, crank, O, X));
    model.constrain("B", spherical(crank, {0, 0.08, 0}, rod, {-0.15, 0, 0}));
    model.constrain("C", revolute_cylindrical(rod, {0.15, 0, 0}, Y, slider, O, Z));
    model.constrain("D", translational(ground, {0.2, 0, 0}, X, slider, O, Z, x));
    model.constrain("C stays", distance(rod, {0.15, 0, 0}, slider, Z, 1));
    model.constrain("motor", hinge_driver(ground, X, crank, X, Driver("-2*pi*t"), x));
}

/// Torque of the driver about global x on body 0, from its multiplier
double driver_torque(const Model& model, const State& x, size_t row)
{
    const Model::Row& driver = model.all_rows()[row];
    const Block& block = driver.active_block(x);
    static const Motion at_rest;
    const bool first = block.i == 0;
    const Variation v =
        first ? block.variation({x.body[0], at_rest, x.t}) : block.variation({at_rest, x.body[0], x.t});
    const double lambda = x.lambda[static_cast<Eigen::Index>(row)];
    return -lambda * (x.body[0].A * (first ? v.pi_i : v.pi_j)).x();
}

}  // namespace

TEST_CASE("kinematic analysis reproduces the reference over whole revolutions",
          "[dae][kinematics][acceptance]")
{
    const Mechanism mechanism = GENERATE(from_range(std::begin(mechanisms), std::end(mechanisms)));
    INFO(mechanism.name);
    Model model;
    State x;
    mechanism.build(model, x);
    dae::start(model, x);
    const lie::Trajectory run = Kinematics(model).run(x, 0.1, 30);
    check_deviation(deviation(model, run.row, references(mechanism.name + ".csv")));
    for (const State& y : run.row) CHECK(model.largest_residual(y).value < 1e-13);
}

TEST_CASE("the slider-crank of joints has the motion of the slider-crank of blocks", "[dae][kinematics]")
{
    Model model;
    State x;
    slider_crank_of_joints(model, x);
    const StartReport report = dae::start(model, x);
    REQUIRE(report.rank == 18);
    REQUIRE(report.dropped.empty());
    const lie::Trajectory run = Kinematics(model).run(x, 0.1, 30);
    check_deviation(deviation(model, run.row, references("slider_crank.csv")));
}

TEST_CASE("projected initial data give the same motion through every exchange of the driver",
          "[dae][kinematics]")
{
    // The complement of the driver must be computed from the projected pose, not from the given one.
    const Mechanism mechanism = GENERATE(from_range(std::begin(mechanisms), std::end(mechanisms)));
    INFO(mechanism.name);
    tests::Random random(5);
    Model model;
    State x;
    mechanism.build(model, x);
    for (Motion& m : x.body) {
        Eigen::Matrix<double, 6, 1> delta;
        delta << random.vector(1e-3), random.vector(1e-3);
        m = tests::displaced(m, delta);
    }
    dae::start(model, x, {.fix_initial = true});
    const lie::Trajectory run = Kinematics(model).run(x, 0.1, 20);
    check_deviation(deviation(model, run.row, references(mechanism.name + ".csv")));
}

TEST_CASE("the torque of a driver is its power divided by its angular velocity", "[dae][kinematics]")
{
    const Mechanism mechanism = GENERATE(from_range(std::begin(mechanisms), std::end(mechanisms)));
    Model model;
    State x;
    mechanism.build(model, x);
    dae::start(model, x);
    const lie::Trajectory run = Kinematics(model).run(x, 0.1, 30);
    const auto reference = table("driver_" + mechanism.name + ".csv");  // t, energy, power, torque
    REQUIRE(reference.size() == run.row.size());
    double largest = 0, worst_torque = 0, worst_power = 0, worst_energy = 0;
    for (const auto& row : reference) largest = std::max(largest, std::abs(row[3]));
    for (size_t k = 0; k < run.row.size(); ++k) {
        const State& y = run.row[k];
        const double torque = driver_torque(model, y, 17);
        worst_torque = std::max(worst_torque, std::abs(torque - reference[k][3]));
        worst_energy = std::max(worst_energy, std::abs(lie::energy(model, y) - reference[k][1]));

        // power balance of the computed state: dE/dt by the chain rule, without multipliers
        double power = 0;
        for (size_t b = 0; b < y.body.size(); ++b) {
            const Motion& m = y.body[b];
            power += model.mass().m[b] * m.rdot.dot(m.rddot - model.gravity) +
                     m.omega_bar.dot(model.mass().J_bar[b] * m.omegadot_bar);
        }
        worst_power = std::max(worst_power, std::abs(torque * mechanism.rate - power));
    }
    INFO(mechanism.name << ": torque " << worst_torque / largest << ", energy " << worst_energy << ", power "
                        << worst_power);
    CHECK(worst_torque < 1e-10 * largest);
    CHECK(worst_power < 1e-10 * largest * std::abs(mechanism.rate));
    CHECK(worst_energy < 1e-10 * std::abs(reference[0][1]));
}

TEST_CASE("inverse dynamics returns the multipliers of the saddle system", "[dae][kinematics]")
{
    const Mechanism mechanism = GENERATE(from_range(std::begin(mechanisms), std::end(mechanisms)));
    INFO(mechanism.name);
    Model model;
    State x;
    mechanism.build(model, x);
    dae::start(model, x);
    Kinematics kinematics(model);
    for (int k = 0; k < 10; ++k) {
        kinematics.move_to(x, 0.13 * k);
        std::vector<Reaction> unbalanced;
        const Eigen::VectorXd lambda = inverse_dynamics(model, x, &unbalanced);
        CHECK((lambda - x.lambda).norm() < 1e-11 * x.lambda.norm());
        for (const Reaction& r : unbalanced) CHECK(r.F.norm() + r.T.norm() < 1e-11 * x.lambda.norm());
    }
}

TEST_CASE("inverse dynamics returns the torque that the constraints do not supply", "[dae][kinematics]")
{
    // A pendulum at rest at an angle: the pin supports the weight. The unbalanced load is a torque about the
    // axis of the pin.
    Model model;
    State x;
    const Vec3 X = Vec3::UnitX();
    const Vec3 arm(0, 0.6, -0.8);
    tests::add_body(model, x, "bar", 2, {0.5, 0.6, 0.7}, arm, Mat3::Identity());
    model.constrain("pin", revolute(ground, Vec3::Zero(), X, 0, -arm, X));
    dae::start(model, x);
    x.body[0].rddot.setZero();
    x.body[0].omegadot_bar.setZero();
    std::vector<Reaction> unbalanced;
    inverse_dynamics(model, x, &unbalanced);
    // The unbalanced load is the shortest of all equivalent loads: a multiple of the free motion, the
    // rotation about the pin.
    const Vec3 about_pin = arm.cross(unbalanced[0].F) + unbalanced[0].T;
    CHECK(about_pin.x() == Approx(2 * 9.81 * 0.6));
    Eigen::Matrix<double, 6, 1> free, found;
    free << X.cross(arm), X;
    found << unbalanced[0].F, unbalanced[0].T;
    CHECK((found - free * (found.dot(free) / free.squaredNorm())).norm() < 1e-13);
}

TEST_CASE("kinematic analysis runs backwards in time and with any substep", "[dae][kinematics]")
{
    Model model;
    State x;
    tests::slider_crank(model, x);
    dae::start(model, x);
    const State first = x;
    Kinematics kinematics(model);
    kinematics.move_to(x, 0.9);
    kinematics.move_to(x, 0.0, 1.7e-2);
    CHECK(x.t == 0);
    for (size_t b = 0; b < 3; ++b) {
        CHECK((x.body[b].r - first.body[b].r).norm() < 1e-12);
        CHECK((x.body[b].A - first.body[b].A).norm() < 1e-12);
        CHECK((x.body[b].rddot - first.body[b].rddot).norm() < 1e-10);
    }
}

namespace {

/// A planar four-bar: crank a, coupler b and rocker c between the pins (0, 0) and (d, 0); the coupler is
/// above (side 1) or below (-1) the line from its crank pin to the ground pin of the rocker.
struct CrankRocker {
    double a, b, c, d;
    int side;

    Vec3 crank_pin(double theta) const { return {a * std::cos(theta), a * std::sin(theta), 0}; }
    /// Closed form: the intersection of two circles
    Vec3 rocker_pin(double theta) const
    {
        const Vec3 B = crank_pin(theta), D(d, 0, 0), e = (D - B).normalized();
        const double l = (D - B).norm(), along = (l * l + b * b - c * c) / (2 * l);
        return B + along * e + side * std::sqrt(b * b - along * along) * Vec3(-e.y(), e.x(), 0);
    }

    /// The crank is driven at the angle f(t).
    void build(Model& model, State& x, const std::string& f) const
    {
        const Vec3 Z = Vec3::UnitZ(), O = Vec3::Zero(), D(d, 0, 0);
        const double theta = Driver(f).f(0);
        const Vec3 B = crank_pin(theta), C = rocker_pin(theta);
        const auto add = [&](const char* name, const Vec3& from, const Vec3& to) {
            const Vec3 along = to - from;
            tests::add_body(model, x, name, 1, {0.01, 0.1, 0.1}, 0.5 * (from + to),
                            lie::exp(std::atan2(along.y(), along.x()) * Z));
            return Vec3(0.5 * along.norm(), 0, 0);  // from the centre to the end
        };
        const Vec3 end_a = add("crank", O, B), end_b = add("coupler", B, C), end_c = add("rocker", D, C);
        model.constrain("A", revolute(ground, O, Z, 0, -end_a, Z));
        model.constrain("B", revolute(0, end_a, Z, 1, -end_b, Z));
        model.constrain("C", spherical(1, end_b, 2, end_c));
        model.constrain("D", revolute(ground, D, Z, 2, -end_c, Z));
        model.constrain("driver",
                        DrivenHinge(ground, Vec3::UnitX(), Vec3::UnitY(), 0, Vec3::UnitX(), Driver(f)));
    }
    /// Largest distance of the rocker pin from the closed form at n nodes
    double error(const std::string& f, double dt, int n) const
    {
        Model model;
        State x;
        build(model, x, f);
        dae::start(model, x, {.fix_initial = true});
        const Driver angle(f);
        double largest = 0;
        Kinematics kinematics(model);
        for (int k = 1; k <= n; ++k) {
            kinematics.move_to(x, k * dt);
            const Vec3 pin = x.body[2].r + x.body[2].A * Vec3(0.5 * c, 0, 0);
            largest = std::max(largest, (pin - rocker_pin(angle.f(x.t))).norm());
        }
        return largest;
    }
};

}  // namespace

TEST_CASE("kinematic analysis stays on its branch at any speed", "[dae][kinematics]")
{
    tests::Random random(5);
    int tried = 0;
    for (int k = 0; k < 30; ++k) {
        // The crank is the shortest link, and rotates fully.
        CrankRocker f{random.number(0.05, 0.3), 0, 0, 1, k % 2 == 0 ? 1 : -1};
        f.b = random.number(0.5, 1.5);
        f.c = random.number(std::abs(f.b - f.d) + 1.1 * f.a, f.b + f.d - 1.1 * f.a);
        if (f.c < 1.1 * f.a) continue;
        ++tried;
        for (const char* rate : {"20*t", "400*t", "1000*t", "-3000*t", "40*sin(60*t)", "1e5*t^3"}) {
            CAPTURE(f.a, f.b, f.c, f.side, rate);
            CHECK(f.error(rate, 1e-2, 10) < 1e-10);
        }
    }
    CHECK(tried > 20);
}

TEST_CASE("kinematic analysis passes a kink of a driver, and ends at a jump", "[dae][kinematics]")
{
    const CrankRocker f{0.25, 0.9, 0.6, 1, 1};
    CHECK(f.error("5*abs(t-0.023)", 1e-2, 5) < 1e-10);
    try {
        f.error("2*t+0.4*step(t-0.023)", 1e-2, 5);
        FAIL("a jump of the driver has been passed");
    } catch (const lie::NumericalFailure& failure) {
        CHECK(failure.status == "kinematic_jump");
        CHECK(std::string(failure.what()) == "the motion of body 'crank' is not continuous at t = 0.023 s");
    }
    // The rocker as crank cannot pass its dead point.
    const CrankRocker dead{0.6, 0.9, 0.25, 1, 1};
    CHECK_THROWS_AS(dead.error("1.2+20*t", 1e-2, 20), lie::NumericalFailure);
}

TEST_CASE("kinematic analysis rejects a mechanism with degrees of freedom", "[dae][kinematics]")
{
    Model model;
    State x;
    tests::add_body(model, x, "bar", 2, {0.5, 0.6, 0.7}, Vec3::Zero(), Mat3::Identity());
    model.constrain("ball", spherical(ground, Vec3::Zero(), 0, Vec3::Zero()));
    dae::start(model, x);
    CHECK_THROWS_WITH(Kinematics(model), Catch::Contains("0 degrees of freedom") && Catch::Contains("got 3"));
}
