// SPDX-License-Identifier: GPL-3.0-or-later
/// Benchmark: particle-steps per second of a bed of glass beads of 1 mm radius in a box, while it falls and
/// at rest. LIGGGHTS, LAMMPS and YADE are compared by the same measure.
///
///     cmake --preset native && cmake --build --preset native --target hilda_granular_benchmark
///     build/native/hilda_granular_benchmark 50000         with 1, 2, 4 … threads
///     build/native/hilda_granular_benchmark 1000000 cuda  on a GPU
///     build/native/hilda_granular_benchmark watch 10000   cost of the watch: CPU time of steps with and without it
///     build/native/hilda_granular_benchmark rows 50000    cost of a row of run.csv and of a frame, in CPU times of a step
///     build/native/hilda_granular_benchmark mesh 10000    cost of triangles, in CPU times of a step with planes
///
/// For the bed at rest the program then prints the memory throughput of each part of a step: the bytes that
/// it has to transfer at least, divided by its time, also as a fraction of the throughput of a copy.

#include "granular/mesh/mesh_shapes.hpp"
#include "granular/world/output.hpp"
#include "granular/world/world.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <tuple>
#include <vector>

#include <omp.h>

using namespace hilda::granular;

namespace {

constexpr double R = 1e-3, h = 5e-6;

/// What the bed lies in: a box of planes; a box of about 10 000 triangles; a box of planes above a terrain of
/// about 1 000 000 triangles, which no particle is near
enum class Container { planes, triangles, terrain };

World bed(std::size_t n, Device device, Container container = Container::planes)
{
    const Material glass{"glass", 2500, 7e7, 0.24};
    const double d = 2 * R, spacing = 1.05 * d, width = std::cbrt(static_cast<double>(n)) * d;
    const int per_row = static_cast<int>((width - d) / spacing) + 1;
    const double layers = std::ceil(static_cast<double>(n) / per_row / per_row);
    WorldOptions o;
    o.low = {-d, -d, -d}, o.high = {width + d, width + d, layers * spacing + 3 * d};
    if (container == Container::terrain) o.low.z -= 5 * d;
    o.h = h;
    o.device = device;
    World world(o, {glass});
    world.set_law(0, 0, hertz_mindlin(glass, 0.9, 0.3));
    Boundary mesh;
    mesh.shape = Boundary::Shape::mesh;
    if (container == Container::triangles) {
        // of five squares, with two triangles for each cell
        const double height = layers * spacing + 2 * d,
                     edge = std::sqrt(2 * width * (width + 4 * height) / 10'000);
        world.add(mesh, box_mesh({0, 0, 0}, {width, width, height}, {false, false, false, false, false, true},
                                 true, edge));
    } else {
        for (const Boundary& b : open_box({0, 0, 0}, {width, width, 0})) world.add(b);
    }
    if (container == Container::terrain) {
        mesh.r = {width / 2, width / 2, -4 * d};
        world.add(mesh, plate_mesh(width, width, width / 707));
    }
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

/// Prints the line of one phase. On a GPU the parts of a step are timed in a separate pass with
/// synchronisation between them.
void report(const char* phase, World& world, long steps, bool gpu)
{
    world.step(20);  // warm-up: memory allocation, and loading of the kernels on a GPU
    const long rebuilds = world.rebuilds();
    world.take_times();
    const auto begin = std::chrono::steady_clock::now();
    world.step(steps);
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const long found = world.rebuilds() - rebuilds;
    if (gpu) {
        world.set_timed(true);
        world.take_times();
        world.step(steps);
        world.set_timed(false);
    }
    const World::Times t = world.take_times();
    const double n = static_cast<double>(world.count()), work = n * static_cast<double>(steps);
    std::size_t touching = 0;
    for (const ContactRecord& c : world.contacts()) touching += c.boundary ? 1 : 2;
    std::printf("%9zu %3d %-8s %8.2f %8.1f %8.1f %8.1f %8ld %6.2f %6.2f %8.0f\n", world.count(),
                omp_get_max_threads(), phase, 1e-6 * work / wall, 1e9 * t.loads / work,
                1e9 * t.advance / work, 1e9 * t.neighbours / work, found,
                static_cast<double>(world.candidates()) / n, static_cast<double>(touching) / n,
                static_cast<double>(world.bytes()) / n);
    std::fflush(stdout);
}

/// Prints the memory throughput. The number of bytes counts every array once that a step has to read or
/// write.
void report_memory(World& world, long steps)
{
    const double n = static_cast<double>(world.count());
    const double pairs = static_cast<double>(world.candidates()) / n,
                 touching = static_cast<double>(world.contacts().size()) / n;
    constexpr double state = sizeof(Position) + 2 * sizeof(Float4);
    const double loads = state + pairs * (2 * sizeof(std::uint32_t) + 1) +
                         touching * (2 * sizeof(Float4) + sizeof(Load)),
                 advance = 2 * (state + sizeof(Compensation)) + 2 * sizeof(std::uint32_t) +
                           pairs * sizeof(std::uint32_t) + 2 * touching * sizeof(Load);
    const double copy = world.copy_rate();
    world.set_timed(true);
    world.take_times();
    world.step(steps);
    const World::Times t = world.take_times();
    world.set_timed(false);
    std::printf("\ncopy: %.1f GB/s (reads and writes)\n", 1e-9 * copy);
    std::printf("part       bytes per particle   us per step     GB/s  of a copy\n");
    for (const auto& [name, bytes, seconds] :
         {std::tuple{"loads", loads, t.loads}, {"advance", advance, t.advance}}) {
        const double rate = bytes * n * static_cast<double>(steps) / seconds;
        std::printf("%-10s %18.0f %13.1f %8.1f %9.0f%%\n", name, bytes,
                    1e6 * seconds / static_cast<double>(steps), 1e-9 * rate, 100 * rate / copy);
    }
    std::printf("%-10s %18s %13.1f\n", "neighbours", "", 1e6 * t.neighbours / static_cast<double>(steps));
}

/// CPU time of this process [s]
double cpu_time()
{
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Prints the CPU time of a step of the bed with and without the watch, and the median of the ratios. Blocks
/// of steps of one world alternate, so that the load of the machine affects both.
void report_watch(const char* phase, World& world, long first)
{
    world.step(first);
    constexpr int rounds = 31;
    constexpr long steps = 3 * watch_limit::interval;
    std::vector<double> ratios;
    double total[2] = {0, 0};
    for (int round = 0; round < rounds; ++round) {
        double seconds[2];
        for (const int on : {round % 2, 1 - round % 2}) {
            world.set_watch(on == 1);
            world.step(1);  // the watch begins with a sample
            const double begin = cpu_time();
            world.step(steps);
            total[on] += seconds[on] = cpu_time() - begin;
        }
        ratios.push_back(seconds[1] / seconds[0]);
    }
    std::nth_element(ratios.begin(), ratios.begin() + rounds / 2, ratios.end());
    std::printf("%9zu %-8s %10.2f %10.2f %10.4f\n", world.count(), phase, 1e6 * total[0] / (rounds * steps),
                1e6 * total[1] / (rounds * steps), ratios[rounds / 2]);
    std::fflush(stdout);
}

/// Prints the CPU times of a step and of the parts of a row of run.csv: the totals, the kinetic energy, and
/// the sample of the watch; and of a frame without its disk. Medians of rounds in which all of them
/// alternate.
void report_row(const char* phase, World& world, long first)
{
    world.set_watch(true);
    world.step(first);
    world.step(2 * watch_limit::interval - world.steps() % watch_limit::interval);
    enum Part { step, totals, kinetic, sampled, frame, parts };
    std::vector<double> times[parts];
    constexpr long many = 8;
    for (int round = 0; round < 41; ++round) {
        const auto measure = [&](Part part, const auto& f) {
            const double begin = cpu_time();
            f();
            times[part].push_back(cpu_time() - begin);
        };
        world.set_watch(true);
        world.step(1);
        measure(step, [&] { world.step(many); });
        times[step].back() /= many;
        measure(totals, [&] { world.totals(); });
        measure(kinetic, [&] { world.kinetic_energy(); });
        world.set_watch(true, world.steps() + 1);  // a sample in the next step
        measure(sampled, [&] { world.step(1); });
        std::size_t bytes = 0;
        measure(frame, [&] { particles_vtp(world, [&](std::string_view piece) { bytes += piece.size(); }); });
    }
    for (std::vector<double>& t : times)
        std::nth_element(t.begin(), t.begin() + static_cast<std::ptrdiff_t>(t.size() / 2), t.end());
    const auto median = [&](Part part) { return times[part][times[part].size() / 2]; };
    const double one = median(step), sample = median(sampled) - one;
    std::printf("%9zu %-8s %9.0f %9.2f %9.2f %9.2f %9.2f %9.2f\n", world.count(), phase, 1e6 * one,
                median(totals) / one, median(kinetic) / one, sample / one,
                (median(totals) + median(kinetic) + sample) / one, median(frame) / one);
    std::fflush(stdout);
}

/// Prints the CPU time of a step of the bed in a box of planes, and the medians of the ratios to it for the
/// other containers. Blocks of steps alternate, so that the load of the machine affects all.
void report_mesh(const char* phase, std::vector<World>& worlds, long first)
{
    for (World& world : worlds) world.step(first);
    constexpr int rounds = 31;
    constexpr long steps = 100;
    std::vector<double> seconds(worlds.size()), planes;
    std::vector<std::vector<double>> ratios(worlds.size());
    for (int round = 0; round < rounds; ++round) {
        for (std::size_t k = 0; k < worlds.size(); ++k) {
            const std::size_t which = round % 2 == 0 ? k : worlds.size() - 1 - k;
            const double begin = cpu_time();
            worlds[which].step(steps);
            seconds[which] = (cpu_time() - begin) / steps;
        }
        planes.push_back(seconds[0]);
        for (std::size_t k = 0; k < worlds.size(); ++k) ratios[k].push_back(seconds[k] / seconds[0]);
    }
    const auto median = [](std::vector<double>& of) {
        std::nth_element(of.begin(), of.begin() + rounds / 2, of.end());
        return of[rounds / 2];
    };
    std::printf("%9zu %-8s %11.1f", worlds[0].count(), phase, 1e6 * median(planes));
    for (std::size_t k = 1; k < worlds.size(); ++k)
        std::printf(" %9zu %6.3f", worlds[k].all_meshes().triangle.size(), median(ratios[k]));
    std::printf("\n");
    std::fflush(stdout);
}

void steps_benchmark(std::size_t n, bool gpu)
{
    World world = bed(n, {.kind = gpu ? Device::cuda : Device::cpu});
    std::printf(
        "                          million  ns per particle-step in             pairs  contacts bytes\n"
        "particles thr phase    per s      loads  advance neighb. rebuilds   per particle\n");
    const int most = gpu ? 1 : omp_get_max_threads();
    const auto report_all = [&](const char* phase, long steps) {
        for (int threads = 1; threads <= most; threads *= 2) {
            omp_set_num_threads(threads);
            report(phase, world, steps, gpu);
        }
    };
    report_all("falling", 400);
    const double settled = 0.25;  // [s]
    world.step(std::lround(settled / h));
    report_all("at rest", 1000);
    report_memory(world, 200);
}

void watch_benchmark(std::size_t n)
{
    World world = bed(n, {});
    std::printf(
        "          CPU time of a step [us], watch    median of\n"
        "particles phase       without       with     ratios\n");
    report_watch("falling", world, 20);
    report_watch("at rest", world, std::lround(0.25 / h));
}

void rows_benchmark(std::size_t n)
{
    World world = bed(n, {});
    std::printf(
        "                       step  parts of a row, in steps                   a frame,\n"
        "particles phase        [us]    totals    energy    sample       all  in steps\n");
    report_row("falling", world, 20);
    report_row("at rest", world, std::lround(0.1 / h));
}

void mesh_benchmark(std::size_t n)
{
    std::vector<World> worlds;
    for (const Container in : {Container::planes, Container::triangles, Container::terrain})
        worlds.push_back(bed(n, {}, in));
    std::printf(
        "                   step with    box of triangles    terrain below\n"
        "particles phase    planes [us]    number  ratio    number  ratio\n");
    report_mesh("falling", worlds, 20);
    report_mesh("at rest", worlds, std::lround(0.25 / h));
}

/// The benchmarks with a name, on one thread
struct NamedBenchmark {
    const char* name;
    void (*run)(std::size_t particles);
};
constexpr NamedBenchmark benchmarks[] = {
    {"watch", watch_benchmark}, {"rows", rows_benchmark}, {"mesh", mesh_benchmark}};

/// A number of particles; 0 if the text is not one
std::size_t number_of_particles(const char* text)
{
    char* end = nullptr;
    const unsigned long n = std::strtoul(text, &end, 10);
    return *text >= '0' && *text <= '9' && *end == 0 ? n : 0;
}

int usage()
{
    std::fprintf(stderr, "usage: hilda_granular_benchmark [PARTICLES [cuda]]");
    for (const NamedBenchmark& b : benchmarks) std::fprintf(stderr, " | %s PARTICLES", b.name);
    std::fprintf(stderr, "\n");
    return 2;
}

}  // namespace

int main(int argc, char** argv)
try {
    for (const NamedBenchmark& b : benchmarks) {
        if (argc < 2 || std::strcmp(argv[1], b.name) != 0) continue;
        const std::size_t n = argc == 3 ? number_of_particles(argv[2]) : 0;
        if (n == 0) return usage();
        omp_set_num_threads(1);
        b.run(n);
        return 0;
    }
    const std::size_t n = argc > 1 ? number_of_particles(argv[1]) : 10000;
    const bool gpu = argc == 3 && std::strcmp(argv[2], "cuda") == 0;
    if (n == 0 || argc > 3 || (argc == 3 && !gpu)) return usage();
    steps_benchmark(n, gpu);
} catch (const std::exception& e) {
    std::fprintf(stderr, "hilda_granular_benchmark: %s\n", e.what());
    return 1;
}
