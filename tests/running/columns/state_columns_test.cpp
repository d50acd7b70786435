// SPDX-License-Identifier: GPL-3.0-or-later
/// Tables of contacts and of forces: the equations of motion and closed forms hold for their numbers.
#include "tests/support/program/csv.hpp"
#include "tests/support/program/refused.hpp"
#include "tests/support/program/resumed_run.hpp"

#include "lie/so3.hpp"

#include <catch2/catch.hpp>

using namespace hilda::tests;
using Catch::Matchers::Contains;
using hilda::lie::Mat3;
using hilda::lie::Vec3;

namespace {

Vec3 vector(const CsvRow& row, const std::string& name)
{
    return {number(row, name + "x"), number(row, name + "y"), number(row, name + "z")};
}

Mat3 matrix(const CsvRow& row, const std::string& body)
{
    Mat3 A;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            A(i, j) = number(row, body + ".A" + std::to_string(i + 1) + std::to_string(j + 1));
    return A;
}

/// A ball of 2 kg and radius 0.1 m that is thrown onto a floor with friction and rolling resistance
std::string thrown_ball(const std::string& contact, bool ball_first)
{
    const std::string ball = R"({"type": "sphere", "radius": 0.1})", floor = R"({"type": "plane"})";
    return R"({"hilda_model": 1, "name": "ball", "bodies": [{"name": "ball", "mass": 2, "inertia": [0.008, 0.008, 0.008],
        "r": [0, 0, 0.1], "r_dot": [1, 0.5, 0], "omega": [2, 0, 3]}], "constraints": [],
        "contacts": [{"name": "floor", )" +
           (ball_first ? R"("body_i": "ball", "body_j": "ground", "surface_i": )" + ball +
                             R"(, "surface_j": )" + floor
                       : R"("body_i": "ground", "body_j": "ball", "surface_i": )" + floor +
                             R"(, "surface_j": )" + ball) +
           ", " + contact + "}]}";
}

}  // namespace

TEST_CASE("the contact loads of contacts.csv accelerate the body as Newton's and Euler's equations demand",
          "[run][contacts]")
{
    const auto contact =
        GENERATE(as<std::string>(),
                 R"("normal": {"type": "hertz", "E_star": 1e7, "restitution": 0.5},
           "friction": {"mu_s": 0.3, "mu_k": 0.2, "K_E": 1e5, "eta_r": 0.05})",
                 R"("normal": {"type": "constraint"}, "friction": {"mu_s": 0.2, "K_E": 1e5, "eta_r": 0.05})",
                 R"("normal": {"type": "constraint"},
           "friction": {"law": "implicit", "mu_s": 0.2, "K_E": 1e5, "eta_r": 0.05})");
    const bool ball_first = GENERATE(true, false);
    const double sign =
        ball_first ? 1 : -1;  // the loads in the table act on body i, the normal points into it
    const double tolerance = 1e-9;
    CAPTURE(contact, ball_first);
    const Scratch in;
    write(in / "ball.json", thrown_ball(contact, ball_first));
    const Ended ended = call(in, {"run", "ball.json", "--integrator", "rA-half-1", "--step", "1e-4", "--end",
                                  "0.3", "--interval", "0.01", "--contacts", "--output", "out"});
    CAPTURE(ended.err);
    REQUIRE(ended.code == 0);
    const auto motion = csv(in / "out/trajectory.csv"), contacts = csv(in / "out/contacts.csv");
    REQUIRE(motion.size() == 31);
    REQUIRE(contacts.size() == motion.size());
    size_t slipping = 0;
    for (size_t k = 1; k < contacts.size(); ++k) {
        const CsvRow &m = motion[k], &c = contacts[k];
        CHECK(c.at("t") == m.at("t"));
        const Vec3 n = sign * vector(c, "floor.n"), Ff = sign * vector(c, "floor.Ff_"),
                   T = sign * vector(c, "floor.Tf_");
        const Vec3 C = vector(c, "floor.C"), r = vector(m, "ball.r");
        const Vec3 arm = C + 0.5 * number(c, "floor.gap") * n - r;  // to the point on the surface of the ball
        const Mat3 A = matrix(m, "ball");
        const Vec3 omega = A * vector(m, "ball.w"), v = vector(m, "ball.v");
        const double F_N = number(c, "floor.F_N");
        CHECK((n - Vec3::UnitZ()).norm() < 1e-9);
        CHECK(std::abs(Ff.dot(n)) < 1e-9 * F_N);
        CHECK((2 * (vector(m, "ball.a") + 9.81 * Vec3::UnitZ()) - F_N * n - Ff).norm() < tolerance * F_N);
        CHECK((A * (0.008 * vector(m, "ball.al")) - (C - r).cross(F_N * n + Ff) - T).norm() <
              tolerance * F_N);
        CHECK(number(c, "floor.slip") == Approx((v + omega.cross(arm)).head<2>().norm()).margin(1e-9));
        if (number(c, "floor.slipping") == 1) {
            ++slipping;
            CHECK(Ff.norm() == Approx(0.2 * F_N).epsilon(1e-6));
            CHECK(Ff.normalized().dot((v + omega.cross(arm)).normalized()) == Approx(-1).epsilon(1e-3));
        }
    }
    CHECK(slipping > 3);
    CHECK_THAT(read(in / "out/summary.json"), Contains("contacts.csv"));
}

TEST_CASE("the contact of a constraint is the same in contacts.csv and in trajectory.csv",
          "[run][contacts][evolving]")
{
    const Scratch in;
    REQUIRE(call(in, {"run", "rolling_ball_in_bowl", "--end", "0.1", "--contacts", "--reactions", "--output",
                      "out"})
                .code == 0);
    const auto motion = csv(in / "out/trajectory.csv"), contacts = csv(in / "out/contacts.csv");
    REQUIRE(contacts.size() == motion.size());
    REQUIRE(contacts.size() > 10);
    const std::string header = first_line(read(in / "out/contacts.csv"));
    const std::string name = header.substr(2, header.find('.') - 2);
    for (size_t k = 0; k < contacts.size(); ++k) {
        for (const char* column : {".F_N", ".Cx", ".Cy", ".Cz", ".Ff_x", ".Ff_y", ".Ff_z"})
            CHECK(contacts[k].at(name + column) == motion[k].at(name + column));
        CHECK(number(contacts[k], name + ".rolling") == 1);
        CHECK(std::abs(number(contacts[k], name + ".slip")) < 1e-9);
    }
}

TEST_CASE("the force of a spring in forces.csv is its law, and the rate is the derivative of the length",
          "[run][forces]")
{
    const Scratch in;
    REQUIRE(call(in, {"run", std::string(source_dir) + "/examples/models/slider_crank_with_spring.json",
                      "--integrator", "rA-half-1-kick", "--step", "1e-4", "--interval", "1e-4", "--end",
                      "0.2", "--forces", "--output", "out"})
                .code == 0);
    const auto rows = csv(in / "out/forces.csv"), motion = csv(in / "out/trajectory.csv");
    REQUIRE(rows.size() == 2001);
    CHECK(first_line(read(in / "out/forces.csv")) == "t,spring.length,spring.rate,spring.force");
    for (size_t k = 1; k + 1 < rows.size(); ++k) {
        const double l = number(rows[k], "spring.length"), ldot = number(rows[k], "spring.rate");
        CHECK(l == Approx(0.6 - number(motion[k], "slider.rx")).epsilon(1e-9));
        CHECK(number(rows[k], "spring.force") == Approx(200 * (l - 0.25) + 20 * ldot).epsilon(1e-12));
        const double difference =
            (number(rows[k + 1], "spring.length") - number(rows[k - 1], "spring.length")) / 2e-4;
        CHECK(ldot == Approx(difference).margin(1e-2 * (std::abs(ldot) + 0.01)));
    }
}

TEST_CASE("a run rejects tables of contacts and forces that the model does not have", "[run][contacts]")
{
    const Scratch in;
    check_refused(in, {"run", "double_pendulum", "--contacts"}, 2, "double_pendulum has no contacts");
    check_refused(in, {"run", "double_pendulum", "--forces"}, 2, "double_pendulum has none");
}

TEST_CASE("a killed and resumed run writes the tables of an uninterrupted run", "[run][contacts][resume]")
{
    const Scratch in;
    check_resumed(in, {"run", "rolling_ball", "--end", "0.5", "--contacts", "--interval", "0.001"});
    CHECK(csv(in / "parts/contacts.csv").size() == 501);
}
