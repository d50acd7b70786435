// SPDX-License-Identifier: GPL-3.0-or-later
/// Forces: negative gradient of the potential energy, action and reaction, power of dampers, revolutions of
/// torsion springs.

#include "dae/forces/bushing.hpp"
#include "dae/forces/limits.hpp"
#include "dae/forces/prescribed.hpp"
#include "dae/forces/spring_damper.hpp"
#include "dae/forces/torsion_spring.hpp"
#include "dae/model.hpp"
#include "dae/start.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "tests/support/finite_difference.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

#include <numbers>

using namespace hilda;
using namespace hilda::dae;
using tests::Random;

namespace {

using std::numbers::pi;

void add_bodies(Model& model, int bodies)
{
    for (int b = 0; b < bodies; ++b)
        model.add(
            {.name = "body " + std::to_string(b), .m = 1.5 + b, .J_bar = Vec3(1, 1.2, 1.4).asDiagonal()});
}

lie::Loads loads(const Force& force, const State& x)
{
    lie::Loads out(static_cast<int>(x.body.size()));
    force.add(x, out);
    return out;
}

Vec3 total_force(const lie::Loads& l)
{
    Vec3 sum = Vec3::Zero();
    for (const Vec3& F : l.F) sum += F;
    return sum;
}

/// Moment about the origin, global frame
Vec3 total_moment(const lie::Loads& l, const State& x)
{
    Vec3 sum = Vec3::Zero();
    for (size_t b = 0; b < x.body.size(); ++b) sum += x.body[b].r.cross(l.F[b]) + x.body[b].A * l.n_bar[b];
    return sum;
}

double power(const lie::Loads& l, const State& x)
{
    double sum = 0;
    for (size_t b = 0; b < x.body.size(); ++b)
        sum += l.F[b].dot(x.body[b].rdot) + l.n_bar[b].dot(x.body[b].omega_bar);
    return sum;
}

/// Two bodies with a common axis, axis_i in the first and axis_j in the second. twist() rotates the second
/// about it.
struct Twisted {
    State x;
    Vec3 axis_i, axis_j;
    Mat3 A_j0;

    explicit Twisted(Random& random) : axis_i(random.unit()), axis_j(random.unit())
    {
        x = random.state(2);
        x.discrete_state.assign(1, 0);
        const Vec3 axis = x.body[0].A * axis_i;
        A_j0 =
            Eigen::Quaterniond::FromTwoVectors(x.body[1].A * axis_j, axis).toRotationMatrix() * x.body[1].A;
        twist(0);
    }
    void twist(double angle) { x.body[1].A = lie::exp(angle * (x.body[0].A * axis_i)) * A_j0; }
};

/// A user-defined force: Newtonian attraction of a body to the origin, V = -k/r
class Attraction final : public Force {
public:
    Attraction(int body, double k) : body(body), k(k) {}
    void add(const State& x, lie::Loads& out) const override
    {
        const Vec3& r = x.body[body].r;
        out.F[body] -= k / std::pow(r.norm(), 3) * r;
    }
    double potential_energy(const State& x) const override { return -k / x.body[body].r.norm(); }
    int last_body() const override { return body; }

private:
    int body;
    double k;
};

}  // namespace

TEST_CASE("forces are the negative gradient of the potential energy", "[dae][forces]")
{
    // all forces with a potential in one model, with gravity
    Random random(GENERATE(range(1u, 11u)));
    Twisted twisted(random);
    State& x = twisted.x;
    x.body.push_back(random.motion());
    Model model;
    add_bodies(model, 3);
    model.gravity = random.vector(10);
    model.load(SpringDamper(0, random.vector(), 2, random.vector(), 50, 0, 0.4));
    model.load(SpringDamper(ground, random.vector(), 1, random.vector(), 20, 0, 3));
    model.load(SpringDamper(2, random.vector(), ground, random.vector(), 30, 0, 0));
    model.load(TorsionSpring(0, twisted.axis_i, 1, twisted.axis_j, 7, 0, 0.3, x));
    model.load(Attraction(2, 4));
    model.prepare(x);
    twisted.twist(random.number(-2, 2));

    lie::Loads exact(3);
    model.loads(x, exact);
    for (int b = 0; b < 3; ++b)
        for (int c = 0; c < 6; ++c) {
            const double gradient = tests::derivative([&](double s) {
                State moved = x;
                moved.body[b] = tests::displaced(x.body[b], s * Eigen::Matrix<double, 6, 1>::Unit(c));
                return model.potential_energy(moved);
            });
            INFO("body " << b << ", component " << c);
            CHECK((c < 3 ? exact.F[b][c] : exact.n_bar[b][c - 3]) ==
                  Approx(-gradient).epsilon(1e-7).margin(1e-7));
        }
}

TEST_CASE("the power of a force is minus its force times its rate in the output", "[dae][forces]")
{
    Random random(GENERATE(range(1u, 11u)));
    Twisted twisted(random);
    State& x = twisted.x;
    std::vector<std::unique_ptr<Force>> forces;
    forces.push_back(std::make_unique<SpringDamper>(0, random.vector(), 1, random.vector(), 50, 3, 0.4,
                                                    io::Expression("l^2 - 5*ldot", {"l", "ldot", "t"})));
    forces.push_back(std::make_unique<SpringDamper>(ground, random.vector(), 1, random.vector(), 20, 2, 3));
    forces.push_back(std::make_unique<TorsionSpring>(0, twisted.axis_i, 1, twisted.axis_j, 7, 2, 0.3, x));
    const Stop stop{.minimum = 20, .stiffness = 40, .damping = 0.1};
    forces.push_back(std::make_unique<DistanceLimit>(0, random.vector(), 1, random.vector(), stop));
    forces.push_back(std::make_unique<AngleLimit>(0, twisted.axis_i, 1, twisted.axis_j, stop, x));
    twisted.twist(random.number(-2, 2));
    for (const auto& force : forces) {
        REQUIRE(force->quantities().size() == 3);
        double value[3];
        force->values(x, value);
        const double rate = value[1], load = value[2];
        CHECK(load != 0);
        CHECK(power(loads(*force, x), x) == Approx(-load * rate).epsilon(1e-12));
    }
}

TEST_CASE("the deflection of a bushing in the output gives its potential energy", "[dae][forces]")
{
    Random random(GENERATE(range(1u, 6u)));
    State x = random.state(2);
    const Bushing::Coefficients k{.stiffness = {1, 2, 3}, .rotational_stiffness = {4, 5, 6}};
    const Bushing bushing(0, random.vector(), 1, random.vector(), k, x);
    x.body[0] = tests::displaced(x.body[0], 0.3 * Eigen::Matrix<double, 6, 1>::Ones());
    REQUIRE(bushing.quantities().size() == 6);
    double value[6];
    bushing.values(x, value);
    const Vec3 d = Vec3::Map(value), psi = Vec3::Map(value + 3);
    CHECK(bushing.potential_energy(x) == Approx(0.5 * (d.dot(k.stiffness.cwiseProduct(d)) +
                                                       psi.dot(k.rotational_stiffness.cwiseProduct(psi))))
                                             .epsilon(1e-12));
}

TEST_CASE("springs between two bodies satisfy Newton's third law", "[dae][forces]")
{
    Random random(GENERATE(range(11u, 21u)));
    const State x = random.state(2);
    const SpringDamper spring(0, random.vector(), 1, random.vector(), 40, 3, 0.5,
                              io::Expression("2*l^2 + ldot*abs(ldot) + sin(t)", {"l", "ldot", "t"}));
    const lie::Loads of_spring = loads(spring, x);
    CHECK(of_spring.F[0].norm() > 0.1);
    CHECK(total_force(of_spring).norm() < 1e-13);
    CHECK(total_moment(of_spring, x).norm() < 1e-12);

    Twisted twisted(random);
    const TorsionSpring torsion(0, twisted.axis_i, 1, 2 * twisted.axis_j, 5, 0.7, 0.1, twisted.x);
    twisted.twist(1.1);
    const lie::Loads of_torsion = loads(torsion, twisted.x);
    CHECK(of_torsion.n_bar[0].norm() > 0.1);
    CHECK(total_force(of_torsion).norm() == 0);
    CHECK(total_moment(of_torsion, twisted.x).norm() < 1e-13);
}

TEST_CASE("dampers dissipate the power c ldot^2 and c thetadot^2", "[dae][forces]")
{
    Random random(GENERATE(range(21u, 31u)));
    const State x = random.state(2);
    const Vec3 s_i = random.vector(), s_j = random.vector();
    const lie::Loads damper = loads(SpringDamper(0, s_i, 1, s_j, 0, 3, 0), x);
    const double ldot = tests::derivative([&](double tau) {
        const Motion a = tests::pose_after(x.body[0], tau), b = tests::pose_after(x.body[1], tau);
        return (b.r + b.A * s_j - a.r - a.A * s_i).norm();
    });
    CHECK(power(damper, x) < 0);
    CHECK(power(damper, x) == Approx(-3 * ldot * ldot).epsilon(1e-7));

    Twisted twisted(random);
    State& y = twisted.x;
    const lie::Loads torsion = loads(TorsionSpring(0, twisted.axis_i, 1, twisted.axis_j, 0, 0.7, 0, y), y);
    const double thetadot = (y.body[0].A * twisted.axis_i)
                                .dot(y.body[1].A * y.body[1].omega_bar - y.body[0].A * y.body[0].omega_bar);
    CHECK(power(torsion, y) < 0);
    CHECK(power(torsion, y) == Approx(-0.7 * thetadot * thetadot));
}

TEST_CASE("the force of a spring is k (l - l0) + c ldot + F(l, ldot, t)", "[dae][forces]")
{
    // along x: l = 2, ldot = 0.5, so f = 10 (2 - 1.5) + 4 * 0.5 + (3*4 - 0.5 + 100*0.25) = 43.5
    State x;
    x.t = 0.25;
    x.body.resize(2);
    x.body[1].r = {2, 0, 0};
    x.body[0].rdot = {0.25, 3, 0};
    x.body[1].rdot = {0.75, 0, -5};
    const SpringDamper spring(0, Vec3::Zero(), 1, Vec3::Zero(), 10, 4, 1.5,
                              io::Expression("3*l^2 - ldot + 100*t", {"l", "ldot", "t"}));
    const lie::Loads l = loads(spring, x);
    CHECK(l.F[0].isApprox(Vec3(43.5, 0, 0), 1e-14));  // positive: body i is pulled towards body j
    CHECK(l.F[1].isApprox(Vec3(-43.5, 0, 0), 1e-14));
    CHECK(spring.potential_energy(x) == Approx(0.5 * 10 * 0.25));

    x.body[1].r.setZero();
    CHECK_THROWS_AS(loads(spring, x), lie::NonFinite);
}

TEST_CASE("a torsion spring counts three revolutions forwards and backwards", "[dae][forces]")
{
    Random random(GENERATE(range(31u, 34u)));
    const double step = GENERATE(0.1, 1.0, 2.3) * GENERATE(1, -1);  // 3/8 of a revolution is 2.356
    const bool first_is_ground = GENERATE(true, false);
    Twisted twisted(random);
    State& x = twisted.x;
    if (first_is_ground) {
        x.body[0] = Motion();
        twisted.A_j0 = Eigen::Quaterniond::FromTwoVectors(x.body[1].A * twisted.axis_j, twisted.axis_i)
                           .toRotationMatrix() *
                       x.body[1].A;
        twisted.twist(0);
    }
    Model model;
    add_bodies(model, 2);
    model.load(TorsionSpring(first_is_ground ? ground : 0, twisted.axis_i, 1, twisted.axis_j, 2, 0, 0.5, x));
    const auto& spring = dynamic_cast<const TorsionSpring&>(*model.forces()[0]);
    model.prepare(x);
    const int n = static_cast<int>(std::ceil(6 * pi / std::abs(step)));
    for (int k = 1; k <= 2 * n; ++k) {
        const State before = x;
        const double angle = step * (k <= n ? k : 2 * n - k);
        twisted.twist(angle);
        CHECK(spring.angle(x) == Approx(angle).margin(1e-13));
        CHECK(x.discrete_state == before.discrete_state);  // a rejected step does not change the state
        model.accepted(before, x);
        CHECK(spring.angle(x) == Approx(angle).margin(1e-13));
        CHECK(spring.potential_energy(x) == Approx(std::pow(angle - 0.5, 2)).margin(1e-12));
        // n = k (theta - theta_0) acts along the axis on body i, and -n on body j
        const Vec3 axis = x.body[0].A * twisted.axis_i;
        const Vec3 n_j = x.body[1].A * loads(spring, x).n_bar[1];
        CHECK((n_j + 2 * (angle - 0.5) * axis).norm() < 1e-12);
    }
    CHECK(x.discrete_state[0] == 0);
}

TEST_CASE("a step in which a rotation cannot be counted is refused by every scheme", "[dae][forces]")
{
    // ω h = 2.3 rad is counted, 2.8 rad is not, and from π on no body may rotate further in a step
    const double h = 1e-2, turn = GENERATE(1.0, 2.3, 2.8, 3.1, 3.2, 7.0);
    const bool has_spring = GENERATE(true, false);
    for (const lie::Scheme& scheme : lie::schemes()) {
        if (scheme.adaptive) continue;  // it limits the rotation in its steps
        Model model;
        State x;
        x.body.resize(1);
        x.body[0].omega_bar = {0, 0, turn / h};
        model.add({.name = "disk", .m = 1, .J_bar = Vec3(1, 1, 2).asDiagonal()});
        if (has_spring) {
            TorsionSpring spring(ground, Vec3::UnitZ(), 0, Vec3::UnitZ(), 1e-9, 0, 0, x);
            spring.name = "soft";
            model.load(std::move(spring));
        }
        start(model, x);
        const auto integrator = scheme.make(model, {});
        lie::March march(x, *integrator, h);
        std::string message;
        try {
            for (int n = 0; n < 20; ++n) march.advance({});
        } catch (const lie::NumericalFailure& e) {
            CHECK(e.status == "step_too_large");
            message = e.what();
        }
        INFO(scheme.name << ", " << turn << " rad: " << message);
        CHECK(message.empty() == (turn < (has_spring ? 0.75 * pi : pi)));
        if (turn > pi) CHECK_THAT(message, Catch::Contains("disk") && Catch::Contains("rotates by"));
        if (message.empty() && has_spring) {
            double value[3];
            model.forces()[0]->values(march.node(), value);
            CHECK(value[0] == Approx(20 * turn).epsilon(1e-6));
        }
    }
}

TEST_CASE("adaptive steps count the revolutions between two nodes", "[dae][forces][adaptive]")
{
    // a disk on a torsion spring, k/J = 1/4: the rate is 100 rad/s cos(t/2), 16 revolutions in a second
    Model model;
    State x;
    x.body.resize(1);
    x.body[0].omega_bar = {0, 0, 100};
    model.add({.name = "disk", .m = 1, .J_bar = Vec3(1, 1, 2).asDiagonal()});
    model.load(TorsionSpring(ground, Vec3::UnitZ(), 0, Vec3::UnitZ(), 0.5, 0, 0, x));
    start(model, x);
    for (const lie::Scheme& scheme : lie::schemes()) {
        if (!scheme.adaptive_form) continue;
        const auto integrator = scheme.adaptive_form->make(model, {.rtol = 1e-10});
        lie::March march(x, *integrator, 1);
        for (int n = 1; n <= 10; ++n) {
            march.advance({});
            double value[3];
            model.forces()[0]->values(march.node(), value);
            INFO(scheme.name << " at " << n << " s");
            CHECK(value[0] == Approx(200 * std::sin(n / 2.)).margin(1e-6));
            CHECK(value[1] == Approx(100 * std::cos(n / 2.)).margin(1e-6));
        }
    }
}

TEST_CASE("a torsion spring rejects axes that are zero or not parallel", "[dae][forces]")
{
    State x;
    x.body.resize(2);
    const Vec3 X = Vec3::UnitX(), Y = Vec3::UnitY(), O = Vec3::Zero();
    CHECK_THROWS_AS(TorsionSpring(0, O, 1, X, 1, 0, 0, x), lie::InvalidInput);
    CHECK_THROWS_AS(TorsionSpring(0, X, 1, O, 1, 0, 0, x), lie::InvalidInput);
    CHECK_THROWS_WITH(TorsionSpring(0, X, 1, Y, 1, 0, 0, x),
                      Catch::Contains("parallel") && Catch::Contains("got 0"));
    CHECK_THROWS_AS(TorsionSpring(0, X, 1, -X, 1, 0, 0, x), lie::InvalidInput);
}

TEST_CASE("prescribed loads act in their frame", "[dae][forces]")
{
    Random random(GENERATE(range(41u, 46u)));
    const State x = random.state(2);
    const Motion& b = x.body[1];
    const Vec3 s_bar = random.vector();
    const std::array<io::Expression, 3> formulas{io::Expression("2*t"), io::Expression("cos(t)"),
                                                 io::Expression("-1")};
    const Vec3 F(2 * x.t, std::cos(x.t), -1);

    const lie::Loads global = loads(PrescribedForce(1, s_bar, Frame::global, formulas), x);
    CHECK((global.F[1] - F).norm() < 1e-15);
    CHECK((b.A * global.n_bar[1] - (b.A * s_bar).cross(F)).norm() < 1e-14);
    const lie::Loads body = loads(PrescribedForce(1, s_bar, Frame::body, formulas), x);
    CHECK((b.A.transpose() * body.F[1] - F).norm() < 1e-14);
    CHECK((body.n_bar[1] - s_bar.cross(F)).norm() < 1e-14);
    CHECK(global.F[0].norm() + global.n_bar[0].norm() + body.F[0].norm() + body.n_bar[0].norm() == 0);

    const lie::Loads n_global = loads(PrescribedTorque(1, Frame::global, formulas), x);
    CHECK((b.A * n_global.n_bar[1] - F).norm() < 1e-14);
    const lie::Loads n_body = loads(PrescribedTorque(1, Frame::body, formulas), x);
    CHECK((n_body.n_bar[1] - F).norm() < 1e-15);
    CHECK(n_global.F[1].norm() + n_body.F[1].norm() == 0);
}

TEST_CASE("a load on the ground or on a missing body is rejected", "[dae][forces]")
{
    const std::array<io::Expression, 3> one{io::Expression("1"), io::Expression("1"), io::Expression("1")};
    const Vec3 O = Vec3::Zero();
    CHECK_THROWS_WITH(PrescribedForce(ground, O, Frame::body, one), Catch::Contains("ground"));
    CHECK_THROWS_WITH(PrescribedTorque(ground, Frame::global, one), Catch::Contains("ground"));
    Model model;
    add_bodies(model, 2);
    CHECK_THROWS_WITH(model.load(PrescribedTorque(2, Frame::global, one)), Catch::Contains("got 2"));
    CHECK_THROWS_AS(model.load(SpringDamper(ground, O, 2, O, 1, 0, 0)), lie::InvalidInput);
    model.load(SpringDamper(ground, O, 1, O, 1, 0, 0));
    CHECK(model.forces().size() == 1);
}

TEST_CASE("a user-defined central force gives a circular orbit", "[dae][forces]")
{
    // r = 1, k/m = 4: omega = 2, one revolution in pi seconds
    Model model;
    model.gravity.setZero();
    model.add({.name = "moon", .m = 0.5, .J_bar = Mat3::Identity()});
    model.load(Attraction(0, 2));
    State x;
    x.body.resize(1);
    x.body[0].r = {1, 0, 0};
    x.body[0].rdot = {0, 2, 0};
    dae::start(model, x);
    CHECK((x.body[0].rddot - Vec3(-4, 0, 0)).norm() < 1e-15);
    const double energy = lie::energy(model, x);
    CHECK(energy == Approx(-1));  // -k/2r
    const auto scheme = lie::scheme("rA-half-2").make(model, {});
    const lie::Trajectory orbit =
        lie::march(x, *scheme, lie::TimeGrid{.h = pi / 4000, .steps = 4000, .interval = 1000});
    const State& end = orbit.row.back();
    CHECK((end.body[0].r - x.body[0].r).norm() <
          1e-4);  // the scheme is of second order: (2 pi / 4000)² of 2 pi rad
    CHECK((orbit.row[2].body[0].r + x.body[0].r).norm() < 1e-4);
    CHECK(lie::energy(model, end) == Approx(energy).epsilon(1e-5));
}
