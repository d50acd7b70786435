// SPDX-License-Identifier: GPL-3.0-or-later
/// A new surface, a floor with waves, as a formula that is differentiated automatically. It is registered
/// under a name, so that model files can use it, and a ball slides on it without friction.
///
///     G(x, y, z) = z - a cos(2 π x/length)              the floor is where G < 0
///
/// Checks: the energy in the trough, and the quarter period of small oscillations, in which the centre of the
/// ball moves on a curve with the curvature κ/(1 - κ R), κ = a (2 π/length)²: T = 2 π √((1 - κ R)/(g κ)).

#include "contact/implicit_surface.hpp"
#include "contact/surface_types.hpp"
#include "dae/model_file.hpp"
#include "lie/schemes.hpp"
#include "run/simulation.hpp"

#include <cmath>
#include <cstdio>
#include <numbers>

namespace hilda::contact {
namespace {

/// {"type": "wave", "amplitude": a [m], "length": [m]}: the floor z < a cos(2 π x/length), with crests at x =
/// 0, ± length, ...
std::shared_ptr<const Surface> read_wave(dae::ObjectReader& o)
{
    // The reader checks type and range, and its messages have file, line and column.
    const double a = o.positive("amplitude"), length = o.positive("length");
    const double k = 2 * std::numbers::pi / length;
    // `auto`: called with numbers, and with Duals that carry the first and second derivatives. Functions of
    // <cmath> are found for both when they are called without std::. G must be negative inside the body, grow
    // by about 1 per metre near the surface, and have the origin inside.
    const auto G = [a, k](auto x, auto, auto z) {
        using std::cos;
        return z - a * cos(k * x);
    };
    // The second argument is a length that is typical of the surface; tolerances are scaled with it.
    return std::make_shared<ImplicitSurface<decltype(G)>>(G, length);
}

// Registration at program start. The file needs no header and no line elsewhere: link it, and "wave" is
// known.
const bool registered = io::Registry<SurfaceType>::add({.name = "wave", .read = read_wave});

}  // namespace
}  // namespace hilda::contact

using namespace hilda;

int main()
{
    // A model file as a text; dae::load_model(path) reads a file. The ball of R = 0.1 m touches the floor at
    // x = 0.01 m to within the digits given, and start() with fix_initial moves it onto the floor exactly.
    // The key position, which all surfaces have, shifts the wave by half a length: it has a trough at x = 0.
    const char* const text = R"({"hilda_model": 1, "name": "wave",
      "bodies": [{"name": "ball", "mass": 1, "inertia": [0.004, 0.004, 0.004], "r": [0.0061, 0, 0.0001]}],
      "contacts": [{"name": "ball-floor", "body_i": "ball", "body_j": "ground",
        "surface_i": {"type": "sphere", "radius": 0.1},
        "surface_j": {"type": "wave", "amplitude": 0.1, "length": 1, "position": [0.5, 0, 0]},
        "normal": {"type": "constraint"}}]})";
    dae::Description description = dae::read_model(text, "wave.json");
    dae::start(description, {.fix_initial = true});
    const dae::Model& model = *description.model;
    const lie::Motion begin = description.x.body[0];

    // Small oscillations: the ball is at x = 0 after T/4.
    constexpr double g = 9.81, a = 0.1, R = 0.1, pi = std::numbers::pi;
    const double kappa = a * 4 * pi * pi, T = 2 * pi * std::sqrt((1 - kappa * R) / (g * kappa));

    // Contacts as constraints need a scheme that takes algebraic variables; this one is recommended.
    run::Simulation simulation({.model = model,
                                .start = description.x,
                                .scheme = lie::scheme("rA-half-1-momentum"),
                                .grid = {.h = T / 4 / 500, .steps = 500, .interval = 500}});
    const run::Outcome outcome = simulation.run();
    if (outcome.failed()) {
        std::printf("FAILED: %s: %s\n", outcome.status.c_str(), outcome.message.c_str());
        return 1;
    }
    const lie::Motion end = simulation.state().body[0];

    const double fall = begin.r.z() - end.r.z(), speed = end.rdot.norm(),
                 speed_exact = std::sqrt(2 * g * fall);
    std::printf("start: x = %.6f m, z = %.6f m\n", begin.r.x(), begin.r.z());
    std::printf("after T/4 = %.6f s: x = %.2e m, z = %.8f m (the trough: %.8f m)\n", T / 4, end.r.x(),
                end.r.z(), R - a);
    std::printf("speed %.8f m/s, by energy %.8f m/s, difference %.1e\n", speed, speed_exact,
                speed - speed_exact);
    if (!(std::abs(end.r.x()) < 1e-2 * begin.r.x()) || !(std::abs(end.r.z() - (R - a)) < 1e-6) ||
        !(std::abs(speed - speed_exact) < 1e-4 * speed)) {
        std::printf("FAILED: the ball is not in the trough, or its energy has changed\n");
        return 1;
    }
    return 0;
}
