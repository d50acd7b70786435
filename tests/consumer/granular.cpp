// SPDX-License-Identifier: GPL-3.0-or-later
// The component granular of an installed HILDA: a sphere in free fall from rest has z = -g t²/2.
#include <cmath>
#include <cstdio>

#include "granular/world/world.hpp"

int main()
{
    using namespace hilda::granular;
    const Material glass = {.name = "glass", .density = 2500, .E = 1e7, .nu = 0.24};
    WorldOptions options;
    options.low = {-1, -1, -1}, options.high = {1, 1, 1};
    options.h = 1e-4;
    options.gravity = {0, 0, -9.81};
    World world(options, {glass});
    world.set_law(0, 0, hertz_mindlin(glass, 0.5));
    Particle p;
    p.radius = 0.01;
    world.add(p);
    world.step(1000);
    const double z = world.particles()[0].r.z, expected = -9.81 * 0.1 * 0.1 / 2;
    std::printf("granular: z = %.6f m\n", z);
    return std::abs(z - expected) < 1e-4 ? 0 : 1;
}
