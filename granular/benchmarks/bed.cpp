// SPDX-License-Identifier: GPL-3.0-or-later
/// Particle-steps per second of a bed of glass beads of 1 mm radius in a box, at rest and while it falls: what LIGGGHTS,
/// LAMMPS and YADE are compared on.
///
///     cmake --preset native && cmake --build --preset native --target hilda_granular_benchmark
///     build/native/hilda_granular_benchmark 50000 [skin in diameters]      with 1, 2, 4 … threads

#include "granular/world.hpp"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <omp.h>

using namespace hilda::granular;

namespace {

constexpr double R = 1e-3, h = 5e-6;

World bed(std::size_t n, double skin)
{
    const Material glass{"glass", 2500, 7e7, 0.24};
    const double d = 2 * R, spacing = 1.05 * d, width = std::cbrt(static_cast<double>(n)) * d;
    const int per_row = static_cast<int>((width - d) / spacing) + 1;
    const double layers = std::ceil(static_cast<double>(n) / per_row / per_row);
    WorldOptions o;
    o.low = {-d, -d, -d}, o.high = {width + d, width + d, layers * spacing + 3 * d};
    o.h = h;
    o.skin = skin;
    World world(o, {glass});
    const auto c = static_cast<float>(damping(0.9));
    PairLaw law;
    law.normal = Hertz{.E_eff = static_cast<float>(effective_modulus(glass, glass)), .c = c};
    law.tangential =
        Mindlin{.spring = {.k_t = static_cast<float>(8 * effective_shear_modulus(glass, glass)), .c = c},
                .cap = {0.3f, 0.3f}};
    world.set_law(0, 0, law);
    for (const Boundary& b : open_box({0, 0, 0}, {width, width, 0})) world.add(b);
    unsigned seed = 1;
    const auto random = [&] { return (seed = seed * 1664525u + 1013904223u) * 0x1p-31 - 1; };
    for (std::size_t k = 0; k < n; ++k) {
        const int i = static_cast<int>(k) % per_row, j = static_cast<int>(k) / per_row % per_row,
                  l = static_cast<int>(k) / per_row / per_row;
        Particle p;
        p.radius = R;
        p.r = {R + (i + 0.02 * (1 + random())) * spacing, R + (j + 0.02 * (1 + random())) * spacing,
               R + l * spacing};
        p.v = {0.1 * random(), 0.1 * random(), 0.1 * random()};
        world.add(p);
    }
    return world;
}

void report(const char* phase, World& world, long steps)
{
    const long rebuilds = world.rebuilds();
    world.take_times();
    const auto begin = std::chrono::steady_clock::now();
    world.step(steps);
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const World::Times t = world.take_times();
    const double n = static_cast<double>(world.count()), work = n * static_cast<double>(steps);
    std::size_t touching = 0;
    for (const Contact& c : world.contacts()) touching += c.boundary ? 1 : 2;
    std::printf("%9zu %3d %-8s %8.2f %8.1f %8.1f %8.1f %8ld %6.2f %6.2f %8.0f\n", world.count(),
                omp_get_max_threads(), phase, 1e-6 * work / wall, 1e9 * t.loads / work,
                1e9 * t.advance / work, 1e9 * t.neighbours / work, world.rebuilds() - rebuilds,
                static_cast<double>(world.candidates()) / n, static_cast<double>(touching) / n,
                static_cast<double>(world.bytes()) / n);
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv)
{
    const std::size_t n = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 10000;
    World world = bed(n, argc > 2 ? std::strtod(argv[2], nullptr) : 0.1);
    std::printf(
        "                          million  ns per particle-step in             pairs  contacts bytes\n"
        "particles thr phase    per s      loads  advance neighb. rebuilds   per particle\n");
    const int most = omp_get_max_threads();
    const auto report_all = [&](const char* phase, long steps) {
        for (int threads = 1; threads <= most; threads *= 2) {
            omp_set_num_threads(threads);
            report(phase, world, steps);
        }
        omp_set_num_threads(most);
    };
    report_all("falling", 400);
    const double settled = 0.25;  // [s]
    world.step(std::lround(settled / h));
    report_all("at rest", 1000);
}
