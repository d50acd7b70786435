// SPDX-License-Identifier: GPL-3.0-or-later
/// Chains of bars with spherical joints, from rest (Fang 2022, chapter 3), and two such bars in spatial
/// motion. From rest the chain remains in the plane of its bars and gravity.

#include "studies/problems/n_pendulum.hpp"

#include "dae/model_file.hpp"
#include "io/json.hpp"
#include "reference/solvers/reference_solution.hpp"

#include <random>

namespace hilda::studies {

namespace {

/// Bar i of 2 m x 0.05 m x 0.05 m, 7800 kg/m³, along -z: its body x axis points down
std::string bar(int i, const std::string& velocities = "")
{
    return R"(    {"name": "bar_)" + std::to_string(i) +
           R"(", "mass": 39, "inertia": [0.01625, 13.008125, 13.008125], "r": [0, 0, )" +
           std::to_string(1 - 2 * i) + R"(], "A": [[0, 0, 1], [0, 1, 0], [-1, 0, 0]])" + velocities + "}";
}

/// The spherical joint above bar i: CD rows along the three global axes
std::string bob(int i)
{
    const auto name = [](int b) { return "\"bar_" + std::to_string(b) + "\""; };
    const std::string bodies = i == 1 ? R"("body_i": "bar_1", "body_j": "ground", "s_bar_p_i": [-1, 0, 0])"
                                      : "\"body_i\": " + name(i - 1) + ", \"body_j\": " + name(i) +
                                            R"(, "s_bar_p_i": [1, 0, 0], "s_bar_q_j": [-1, 0, 0])";
    const std::string row = "    {\"name\": \"sph_" + std::to_string(i);
    return row + R"(_i", "type": "CD", "c": [1, 0, 0], )" + bodies + "},\n" +  //
           row + R"(_j", "type": "CD", "c": [0, 1, 0], )" + bodies + "},\n" +  //
           row + R"(_k", "type": "CD", "c": [0, 0, 1], )" + bodies + "}";
}

Problem chain(const std::string& name, const std::string& what, const std::string& note,
              const std::string& bodies, const std::string& constraints)
{
    return {.name = name,
            .what = what,
            .model = R"({"hilda_model": 1, "name": ")" + name + "\",\n  \"note\": \"" + note + R"(",
  "gravity": [0.7032947922, 6.717281251500001, 7.1147458602], "end": 3,
  "bodies": [
)" + bodies + "\n  ],\n  \"constraints\": [\n" +
                     constraints + "\n  ]\n}\n",
            .reference_name = "index-1 equations by rk8pd at 1e-13",
            .reference_solution =
                [](dae::Description& d, const std::vector<double>& instants) {
                    return reference::reference_solution(*d.model, d.x, instants);
                },
            .observable = {}};
}

const std::string pendulum_family = "n_pendulum";

}  // namespace

Problem n_pendulum(int N, const std::string& name)
{
    std::string bodies, constraints;
    for (int i = 1; i <= N; ++i) {
        const char* before = i == 1 ? "" : ",\n";
        bodies += before + bar(i);
        constraints += before + bob(i);
    }
    return chain(
        name,
        (name == pendulum_family ? "chain of 2 bars (n_pendulum_N: N bars)"
                                 : "chain of " + std::to_string(N) + (N == 1 ? " bar" : " bars")) +
            " with spherical joints, from rest under oblique gravity (Fang 2022, chapter 3)",
        "bars of 2 m, section 0.05 m, 7800 kg/m3; gravity of the published code; at rest, because its "
        "random spins without seed violate the joints",
        bodies, constraints);
}

std::vector<double> spins(int N, std::uint64_t seed)
{
    std::mt19937_64 bits(seed);
    std::vector<double> rate(N);
    // The highest 53 bits as a double in [0, 1). std::uniform_real_distribution differs between standard
    // libraries.
    for (double& w : rate) w = 10 * (2 * (static_cast<double>(bits() >> 11) * 0x1p-53) - 1);
    return rate;
}

Problem spinning_n_pendulum(int N, std::uint64_t seed)
{
    const std::string name = "n_pendulum_" + std::to_string(N);
    const std::vector<double> spin = spins(N, seed);
    std::string bodies, constraints;
    for (int i = 1; i <= N; ++i) {
        const char* before = i == 1 ? "" : ",\n";
        bodies += before + bar(i, R"(, "omega": [)" + io::shortest(spin[i - 1]) + ", 0, 0]");
        constraints += before + bob(i);
    }
    return chain(name, "chain of " + std::to_string(N) + " spinning bars",
                 "each bar spins about its long axis, seed " + std::to_string(seed), bodies, constraints);
}

namespace {

const bool two = io::Registry<Problem>::add(n_pendulum(2, pendulum_family));
const bool pendulums =
    io::Registry<ProblemFamily>::add({.name = pendulum_family, .most = most_bars, .member = n_pendulum});

const bool spin = io::Registry<Problem>::add(chain(
    "n_pendulum_2_spin",
    "two bars with spherical joints in spatial motion with initial spins; not in the dissertation",
    "n_pendulum_2 with consistent initial velocities: a spin of each bar and a spatial motion of the joints",
    bar(1, R"(, "r_dot": [-0.5, -1, 0], "omega": [3, 0.5, -1])") + ",\n" +
        bar(2, R"(, "r_dot": [-2, 0, 0], "omega": [-4, 1, 2])"),
    bob(1) + ",\n" + bob(2)));

}  // namespace

}  // namespace hilda::studies
