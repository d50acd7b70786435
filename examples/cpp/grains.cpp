// SPDX-License-Identifier: GPL-3.0-or-later
/// A granular bed from C++: grains settle in a box, then one wall is moved by a controller until the bed
/// presses on it with a given force. A controller needs C++; walls that move by formulas of time need only a
/// case file, see examples/cases/moving_wall.json.

#include "granular/world/world.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

using namespace hilda::granular;

int main()
{
    constexpr double R = 2e-3, F_set = 0.3;  // [m, N]
    const Material glass = {.name = "glass", .density = 2500, .E = 1e7, .nu = 0.24};

    WorldOptions options;
    options.low = {-0.005, -0.005, -0.005},
    options.high = {0.035, 0.025, 0.065};  // a grain outside is an error [m]
    options.h = 2e-5;                      // explicit, so small [s]
    World world(options, {glass});
    // Hertz with restitution 0.3 and Mindlin friction with mu = 0.4, between material 0 and itself
    world.set_law(0, 0, hertz_mindlin(glass, 0.3, 0.4));

    // The floor, the walls x = 0, y = 0, x = 0.03 and y = 0.02 m; add() returns their numbers 0 to 4.
    for (const Boundary& b : open_box({0, 0, 0}, {0.03, 0.02, 0.06})) world.add(b);
    constexpr int moved = 1;  // the wall x = 0

    // A lattice with gaps; the shifts of the layers make the grains collide off-centre.
    double weight = 0;
    for (int layer = 0; layer < 5; ++layer)
        for (int i = 0; i < 6; ++i)
            for (int j = 0; j < 4; ++j) {
                Particle grain;
                grain.radius = R;
                grain.r = {0.0025 + 0.0048 * i + 2e-4 * (layer % 3), 0.0025 + 0.0048 * j + 3e-4 * (layer % 2),
                           0.0025 + 0.0045 * layer};
                world.add(grain);
                weight += glass.density * 4 / 3 * std::numbers::pi * R * R * R * 9.81;
            }

    world.step(std::lround(0.15 / options.h));  // settles for 0.15 s

    // Called at the beginning of each step. The speed of the wall is proportional to the missing force and at
    // most 0.02 m/s, so that the bed remains near equilibrium.
    world.before_each_step([](World& w) {
        const double F =
            -w.wrench(moved).F.x;  // of the bed on the wall, positive where the bed is compressed [N]
        const double v = 0.02 * (F_set - F) / F_set;
        w.boundary(moved).v = {std::clamp(v, -0.02, 0.02), 0, 0};
    });
    world.step(std::lround(0.9 / options.h));

    // Forces on all boundaries, from one pass over the contacts
    Vec3 sum = {0, 0, 0};
    for (const Wrench& on : world.totals().on_boundary) sum += on.F;
    const double F = -world.wrench(moved).F.x, x = world.boundary(moved).r.x;
    std::printf("%zu grains of %.4f N; kinetic energy %.1e J\n", world.count(), weight,
                world.kinetic_energy());
    std::printf("the wall has moved to x = %.2f mm, where the bed presses on it with %.4f N (set: %.4f N)\n",
                1e3 * x, F, F_set);
    std::printf("sum of the forces on the boundaries: x %.5f N, z %.5f N\n", sum.x, sum.z);
    if (!(std::abs(F - F_set) < 0.01 * F_set) || !(std::abs(sum.z + weight) < 0.01 * weight) ||
        !(std::abs(sum.x) < 0.01 * weight)) {
        std::printf("FAILED: the wall has not reached its force, or the bed is not in equilibrium\n");
        return 1;
    }
    return 0;
}
