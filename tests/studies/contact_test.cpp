// SPDX-License-Identifier: GPL-3.0-or-later
/// Models with contacts in the program.

#include "io/error.hpp"
#include "tests/support/program/program.hpp"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace hilda;
using tests::call;
using tests::Ended;

namespace {

/// A model file with a ball in a spherical bowl without gravity, at (x, 0, 0) with a velocity of 1 m/s along
/// x
std::string in_bowl(const std::string& x, const std::string& radius = "0.1")
{
    return R"({"hilda_model": 1, "name": "bowl", "gravity": [0, 0, 0], "end": 0.03125,
 "bodies": [{"name": "ball", "mass": 1, "inertia": [0.01, 0.01, 0.01], "r": [)" +
           x + R"(, 0, 0], "r_dot": [1, 0, 0]}],
 "contacts": [{"name": "ball-bowl", "body_i": "ball", "body_j": "ground",
   "surface_i": {"type": "sphere", "radius": )" +
           radius + R"(}, "surface_j": {"type": "sphere", "radius": 1, "concave": true},
   "normal": {"type": "hooke", "stiffness": 1000}}]}
)";
}

}  // namespace

TEST_CASE("run and check accept a valid model file with contacts and reject an invalid one",
          "[studies][contact]")
{
    const tests::Scratch in;
    tests::write(in / "good.json", in_bowl("0.25"));
    tests::write(in / "bad.json", in_bowl("0.25", "-1"));
    CHECK(call(in, {"check", "good.json"}).code == io::exit_code::done);
    CHECK(call(in, {"run", "good.json", "--no-plot"}).code == io::exit_code::done);
    const Ended bad = call(in, {"run", "bad.json", "--no-plot"});
    CHECK(bad.code == io::exit_code::invalid_input);
    CHECK_THAT(bad.err, Catch::Contains("bad.json:4:46 (/contacts/0/surface_i/radius): radius must be "
                                        "positive, got -1"));
    const Ended stiff = call(in, {"run", "good.json", "--no-plot", "--force", "--accept-step", "--set",
                                  "/contacts/0/normal/stiffness=1e8"});
    CHECK(stiff.code == io::exit_code::done);
    CHECK_THAT(stiff.err, Catch::Contains("the stability limit of contact 'ball-bowl'"));
}

TEST_CASE("check prints the initial state of each contact", "[studies][contact]")
{
    const tests::Scratch in;
    tests::write(in / "m.json", in_bowl("0.90625"));  // an overlap of 6.25 mm
    const Ended words = call(in, {"check", "m.json"});
    CHECK_THAT(words.out, Catch::Contains("forces              0\n") &&
                              Catch::Contains("contacts            1\n") &&
                              Catch::Contains("  ball-bowl         overlap 6.250e-03 m, 6.250e+00 N, "
                                              "curvature 9 1/m, stable up to "));
    // stability limit of symplectic Euler for a spring: h = 2 sqrt(m/k)
    const Ended json = call(in, {"check", "m.json", "--json"});
    CHECK_THAT(json.out, Catch::Contains(R"("forces": 0)") && Catch::Contains(R"("name": "ball-bowl")") &&
                             Catch::Contains(R"("stable_step": 0.0632)"));
    tests::write(in / "apart.json", in_bowl("0.5"));
    CHECK_THAT(call(in, {"check", "apart.json"}).out, Catch::Contains("gap 4.000e-01 m, 0.000e+00 N"));
}

TEST_CASE("a contact point that is not found ends the run with the contact, the bodies and the time",
          "[studies][contact]")
{
    const tests::Scratch in;
    tests::write(in / "start.json", in_bowl("0"));
    const Ended start = call(in, {"run", "start.json", "--no-plot"});
    CHECK(start.code == io::exit_code::invalid_input);
    CHECK_THAT(
        start.err,
        Catch::Contains("start.json:3:15 (/contacts/0): contact 'ball-bowl': the centres of two spheres"));

    // The ball passes the centre of the bowl in the eighth step of 1/1024 s.
    tests::write(in / "on.json", in_bowl("-0.0078125"));
    const Ended on =
        call(in, {"run", "on.json", "--no-plot", "--step", "0.0009765625", "--interval", "0.0009765625"});
    CHECK(on.code == io::exit_code::numerical_failure);
    CHECK_THAT(on.err, Catch::Contains("error[contact_not_converged]: t=0.0078") &&
                           Catch::Contains("contact 'ball-bowl': the centres of two spheres coincide") &&
                           Catch::Contains("bodies 'ball', 'ground', t = 0.0078125 s"));
    const std::string rows = tests::read(in / "out/on/trajectory.csv");
    CHECK(std::count(rows.begin(), rows.end(), '\n') == 1 + 8);  // each node once, up to the last valid one
    CHECK_THAT(tests::read(in / "out/on/summary.json"), Catch::Contains("contact_not_converged"));
}

TEST_CASE("a study of a model file with contacts has a reference of fixed step", "[studies][contact]")
{
    const tests::Scratch in;
    tests::write(in / "m.json", in_bowl("0.89"));
    const std::vector<std::string> study = {
        "study",   "convergence",          "--problem", "m.json",   "--integrator", "rA-half-1",
        "--steps", "7.8125e-4,3.90625e-4", "--no-plot", "--output", "out",          "--force"};
    const Ended by_default = call(in, study);
    CHECK(by_default.code == io::exit_code::done);
    CHECK_THAT(by_default.err, Catch::Contains("the reference is rA-half-1-momentum at h = ") &&
                                   Catch::Contains("--reference selects another"));
    std::vector<std::string> evaluated = study;
    evaluated.insert(evaluated.end(), {"--reference", "rA-rattle"});
    CHECK(call(in, evaluated).code == io::exit_code::done);
}
