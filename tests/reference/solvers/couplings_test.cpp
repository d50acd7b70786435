// SPDX-License-Identifier: GPL-3.0-or-later
/// Gear, screw, rack and pinion, planar joint, point on a curve, bushing and limits: motions in closed form,
/// with schemes on rotation matrices, on Euler parameters and with IDA.

#include "dae/constraints/point_on_curve.hpp"
#include "dae/forces/bushing.hpp"
#include "dae/forces/limits.hpp"
#include "dae/forces/prescribed.hpp"
#include "dae/joints.hpp"
#include "dae/model.hpp"
#include "dae/start.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"
#include "tests/support/mechanisms.hpp"

#include <catch2/catch.hpp>
#include <numbers>

using namespace hilda;
using namespace hilda::dae;

namespace {

using std::numbers::pi;
constexpr double g = 9.81;
const Vec3 X = Vec3::UnitX(), Y = Vec3::UnitY(), Z = Vec3::UnitZ(), O = Vec3::Zero();

struct Mechanism {
    Model model;
    State x;

    int add(const char* name, double m, const Vec3& J_bar, const Vec3& r)
    {
        return tests::add_body(model, x, name, m, J_bar, r, Mat3::Identity());
    }
    void torque(int body, double n)
    {
        model.load(
            PrescribedTorque(body, Frame::body,
                             {io::Expression("0"), io::Expression("0"), io::Expression(std::to_string(n))}));
    }
};

struct Scheme {
    const char* name;
    double h, tolerance;  ///< [s]; relative error of the results in this file
};
const Scheme schemes[] = {
    {"rA-half-1-momentum", 1e-3, 1e-5}, {"rA-rattle", 1e-3, 1e-5}, {"rA-rkmk-4", 2e-3, 1e-8},
    {"rA-genalpha", 1e-3, 1e-5},        {"rA-full-1", 1e-3, 4e-3}, {"rA-full-1-exact", 1e-3, 4e-3},
    {"rp-full-1", 1e-3, 8e-3},          {"rp-bdf2", 1e-3, 4e-5},   {"ida-rp", 0, 1e-6},
    {"ida-rp-index1", 0, 1e-6}};

/// The state at `end`
State run(const Scheme& s, Mechanism& m, double end)
{
    start(m.model, m.x);
    const auto integrator = lie::scheme(s.name).make(m.model, {.tolerance = 1e-11, .rtol = 1e-9});
    return lie::march(m.x, *integrator, lie::TimeGrid::over(end, s.h > 0 ? s.h : 0.01)).row.back();
}

/// Angle about z of a body that rotates with a constant acceleration to the angle `expected`, with the
/// expected number of revolutions
double angle(const lie::Motion& body, double expected)
{
    const double within = std::atan2(body.A(1, 0), body.A(0, 0));
    return within + 2 * pi * std::round((expected - within) / (2 * pi));
}

}  // namespace

TEST_CASE("a gear pair accelerates with the inertia reduced to one axis", "[reference][constraints]")
{
    const Scheme scheme = GENERATE(from_range(std::begin(schemes), std::end(schemes)));
    const bool internal = GENERATE(false, true);
    const double R_1 = 0.1, R_2 = 0.25, n = 0.5, J_1 = 0.02, J_2 = 0.3, end = 2;
    Mechanism m;
    const int a = m.add("pinion", 1, {1, 1, J_1}, O),
              b = m.add("wheel", 1, {1, 1, J_2}, (internal ? R_2 - R_1 : R_1 + R_2) * X);
    m.model.constrain("bearing 1", revolute(ground, O, Z, a, O, Z));
    m.model.constrain("bearing 2", revolute(ground, m.x.body[b].r, Z, b, O, Z));
    m.model.constrain("gear", gear(a, O, Z, R_1, b, O, Z, internal ? -R_2 : R_2, m.x));
    m.torque(a, n);
    const State x = run(scheme, m, end);
    const double ratio = (internal ? 1 : -1) * R_1 / R_2;
    const double phi = 0.5 * n / (J_1 + ratio * ratio * J_2) * end * end;  // 14.7 rad
    INFO(scheme.name);
    CHECK(angle(x.body[a], phi) == Approx(phi).epsilon(scheme.tolerance));
    CHECK(angle(x.body[b], ratio * phi) == Approx(ratio * phi).epsilon(scheme.tolerance));
    CHECK(x.body[b].omega_bar.z() == Approx(ratio * x.body[a].omega_bar.z()).epsilon(scheme.tolerance));
}

TEST_CASE("the planet of a planetary gear train rotates as Willis' equation says", "[reference][constraints]")
{
    // Ring fixed to the ground, sun and three planets on a carrier: two of the rows for the planets are
    // redundant.
    const double R_sun = 0.1, R_planet = 0.05, R_ring = R_sun + 2 * R_planet, end = 1.5;
    Mechanism m;
    const int sun = m.add("sun", 1, {1, 1, 0.01}, O), carrier = m.add("carrier", 1, {1, 1, 0.05}, O);
    m.model.constrain("sun bearing", revolute(ground, O, Z, sun, O, Z));
    m.model.constrain("carrier bearing", revolute(ground, O, Z, carrier, O, Z));
    for (int k = 0; k < 3; ++k) {
        const std::string name = "planet " + std::to_string(k);
        const Vec3 centre = (R_sun + R_planet) * Vec3(std::cos(2 * pi * k / 3), std::sin(2 * pi * k / 3), 0);
        const int planet = m.add(name.c_str(), 0.1, {1, 1, 1e-3}, centre);
        m.model.constrain(name + " bearing", revolute(carrier, centre, Z, planet, O, Z));
        m.model.constrain(name + " and sun", gear(planet, O, Z, R_planet, sun, O, Z, R_sun, m.x));
        m.model.constrain(name + " and ring", gear(planet, O, Z, R_planet, ground, O, Z, -R_ring, m.x));
    }
    m.model.gravity.setZero();
    m.torque(sun, 0.3);
    const State x = run({"rA-half-1-momentum", 1e-3, 0}, m, end);
    const double omega_sun = x.body[sun].omega_bar.z(), omega_carrier = x.body[carrier].omega_bar.z();
    CHECK(omega_sun > 10);
    CHECK(omega_carrier / omega_sun == Approx(R_sun / (R_sun + R_ring)).epsilon(1e-9));
    // in the frame of the carrier: omega_planet - omega_carrier = -omega_carrier R_ring/R_planet
    for (int planet = 2; planet < 5; ++planet)
        CHECK((x.body[planet].omega_bar.z() - omega_carrier) / omega_carrier ==
              Approx(-R_ring / R_planet).epsilon(1e-9));
    CHECK(m.model.dropped_rows().size() >= 2);
    CHECK(m.model.largest_residual(x).value < 1e-9);
}

TEST_CASE("a nut falls on a screw with the reduced acceleration", "[reference][constraints]")
{
    const Scheme scheme = GENERATE(from_range(std::begin(schemes), std::end(schemes)));
    const double mass = 2, J = 0.15, pitch = -0.5, end = 1.5;
    Mechanism m;
    const int nut = m.add("nut", mass, {1, 1, J}, {0.3, 0, 0});
    m.model.constrain("screw", screw(ground, {0.3, 0, 0}, Z, nut, O, Z, pitch, m.x));
    const State x = run(scheme, m, end);
    const double rho = pitch / (2 * pi), z = -0.5 * g / (1 + J / (mass * rho * rho)) * end * end;
    INFO(scheme.name);
    CHECK(x.body[nut].r.z() == Approx(z).epsilon(scheme.tolerance));
    CHECK(angle(x.body[nut], z / rho) == Approx(z / rho).epsilon(scheme.tolerance));
}

TEST_CASE("a pinion drives a rack with the reduced inertia", "[reference][constraints]")
{
    const Scheme scheme = GENERATE(from_range(std::begin(schemes), std::end(schemes)));
    const double radius = 0.1, mass = 3, J = 0.02, n = -0.4, end = 2;
    Mechanism m;
    const int rack = m.add("rack", mass, {1, 1, 1}, {0, -radius, 0}),
              pinion = m.add("pinion", 1, {1, 1, J}, O);
    m.model.constrain("guide", translational(ground, {0, -radius, 0}, X, rack, O, X, m.x));
    m.model.constrain("bearing", revolute(ground, O, Z, pinion, O, Z));
    // The pinion is above the rack. A rotation about z moves the pinion along -x of the rack, the rack along
    // +x.
    m.model.constrain("teeth", rack_and_pinion(rack, O, -X, Z, pinion, O, Z, radius, m.x));
    m.torque(pinion, n);
    const State x = run(scheme, m, end);
    const double phi = 0.5 * n / (J + mass * radius * radius) * end * end;
    INFO(scheme.name);
    CHECK(x.body[rack].r.x() == Approx(radius * phi).epsilon(scheme.tolerance));
    CHECK(angle(x.body[pinion], phi) == Approx(phi).epsilon(scheme.tolerance));
}

TEST_CASE("a puck on a plane moves like a free body in two dimensions", "[reference][constraints]")
{
    const Scheme scheme = GENERATE(from_range(std::begin(schemes), std::end(schemes)));
    Mechanism m;
    const int puck = m.add("puck", 1, {0.1, 0.1, 0.2}, O);
    m.x.body[puck].rdot = Vec3(1, -2, 0), m.x.body[puck].omega_bar = 3 * Z;
    m.model.constrain("table", planar(ground, O, Z, puck, O, Z));
    const State x = run(scheme, m, 1);
    INFO(scheme.name);
    CHECK((x.body[puck].r - Vec3(1, -2, 0)).norm() < 1e-7);
    CHECK(angle(x.body[puck], 3) == Approx(3).epsilon(scheme.tolerance));
}

TEST_CASE("a bead on a cycloid has the same period at every amplitude", "[reference][constraints]")
{
    // Huygens: x = a (s + sin s), z = a (1 - cos s). The arc length from the lowest point, 4 a sin(s/2), is
    // harmonic with the frequency sqrt(g/(4 a)).
    const Scheme scheme = GENERATE(from_range(std::begin(schemes), std::end(schemes)));
    const double s_0 = GENERATE(0.4, 2.2), a = 0.5, end = 3;
    Mechanism m;
    const int bead =
        m.add("bead", 0.7, {0.1, 0.2, 0.3}, {a * (s_0 + std::sin(s_0)), 0, a * (1 - std::cos(s_0))});
    m.model.constrain("wire",
                      std::make_unique<PointOnCurve>(
                          bead, O, ground,
                          std::array{io::Expression("0.5*(s+sin(s))", {"s"}), io::Expression("0", {"s"}),
                                     io::Expression("0.5*(1-cos(s))", {"s"})},
                          s_0));
    const State x = run(scheme, m, end);
    const double arc = 4 * a * std::sin(s_0 / 2) * std::cos(std::sqrt(g / (4 * a)) * end);
    const double s = 2 * std::asin(arc / (4 * a));
    INFO(scheme.name);
    const double error = (x.body[bead].r - Vec3(a * (s + std::sin(s)), 0, a * (1 - std::cos(s)))).norm();
    CHECK(error < 6 * scheme.tolerance);
    CHECK(m.model.largest_residual(x, Model::RowSet::all).value < 1e-8);
}

TEST_CASE("a body on a bushing oscillates with the frequencies of its springs", "[reference][forces]")
{
    // Small amplitudes along and about one axis; the exact solution of the linear oscillator
    const Scheme scheme = GENERATE(from_range(std::begin(schemes), std::end(schemes)));
    const double mass = 2, J = 0.3, end = 1;
    Mechanism m;
    const int body = m.add("body", mass, {0.1, 0.2, J}, O);
    Bushing::Coefficients c;
    c.stiffness = Vec3(100, 80, 60), c.rotational_stiffness = Vec3(5, 6, 7);
    m.model.gravity.setZero();
    m.model.load(Bushing(ground, O, body, O, c, m.x));
    m.x.body[body].rdot = 0.1 * Y, m.x.body[body].omega_bar = 0.2 * Z;
    const State x = run(scheme, m, end);
    const double w = std::sqrt(80 / mass), W = std::sqrt(7 / J);
    INFO(scheme.name);
    CHECK(std::abs(x.body[body].r.y() - 0.1 / w * std::sin(w * end)) < 2 * scheme.tolerance);
    CHECK(std::abs(lie::log(x.body[body].A).z() - 0.2 / W * std::sin(W * end)) < 2 * scheme.tolerance);
}

TEST_CASE("a mass on a slack rope rebounds and keeps its energy", "[reference][forces]")
{
    // Free fall until the rope is tight, half a period of the oscillator, and free flight upwards
    Mechanism m;
    const double mass = 1, k = 1e4, l = 0.5, end = 0.7;
    const int load = m.add("load", mass, {0.1, 0.1, 0.1}, {0, 0, -0.1});
    m.model.load(DistanceLimit(ground, O, load, O, Stop{.maximum = l, .stiffness = k}));
    const State x = run({"rA-rkmk-4", 1e-4, 0}, m, end);
    const double v = std::sqrt(2 * g * (l - 0.1)), w = std::sqrt(k / mass), sag = mass * g / k;
    const double t_fall = v / g, t_tight = 2 * (pi - std::atan(v / (w * sag))) / w,
                 t = end - t_fall - t_tight;
    CHECK(x.body[load].r.z() == Approx(-l + v * t - 0.5 * g * t * t).margin(2e-6));
    CHECK(lie::energy(m.model, x) == Approx(mass * g * -0.1).margin(1e-5));
}

TEST_CASE("a door rests at its stop", "[reference][forces]")
{
    Mechanism m;
    const double k = 200, n = 3;
    const int door = m.add("door", 5, {1, 1, 0.8}, O);
    m.model.constrain("hinge", revolute(ground, O, Z, door, O, Z));
    m.model.load(AngleLimit(ground, Z, door, Z, Stop{.maximum = 7, .stiffness = k, .damping = 5}, m.x));
    m.torque(door, n);
    const State x = run({"rA-half-1-momentum", 1e-3, 0}, m, 60);
    CHECK(angle(x.body[door], 7) == Approx(7 + n / k).epsilon(1e-3));
}
