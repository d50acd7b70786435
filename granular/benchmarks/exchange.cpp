// SPDX-License-Identifier: GPL-3.0-or-later
/// Benchmark: time that an exchange of a co-simulation adds to the steps of the grains, in one process and
/// with a second process over two pipes. The grains take one step per exchange.
///
///     cmake --preset native && cmake --build --preset native --target hilda_exchange_benchmark
///     build/native/hilda_exchange_benchmark 1      with one tool
///     build/native/hilda_exchange_benchmark 20     with 20 tools

#include "granular/cosim/remote_exchange.hpp"
#include "granular/cosim/soil.hpp"
#include "granular/running/earlier_run.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <omp.h>
#include <sys/wait.h>
#include <unistd.h>

using namespace hilda::granular;
namespace io = hilda::io;

namespace {

constexpr int rounds = 41;
constexpr long exchanges = 1000;  ///< of a round

std::vector<std::string> names_of(long tools)
{
    std::vector<std::string> names;
    for (long k = 0; k < tools; ++k) names.push_back("tool" + std::to_string(k));
    return names;
}

/// Some grains, and tools that touch none of them
std::string text_of_case(long tools)
{
    std::string boundaries;
    for (const std::string& name : names_of(tools))
        boundaries += (boundaries.empty() ? "" : ", ") + std::string(R"({"name": ")") + name +
                      R"(", "type": "sphere", "radius": 1e-3, "r": [0, 0, 0.05], "material": "glass"})";
    return R"({"hilda_case": 1, "domain": {"low": [-0.01, -0.01, -0.01], "high": [0.01, 0.01, 0.06]},
        "step": 1e-6, "end": 1, "interval": 1, "frame_interval": 1, "gravity": [0, 0, 0],
        "materials": [{"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24}],
        "laws": [{"between": ["glass", "glass"], "restitution": 0.9, "mu": 0.3}],
        "fill": [{"type": "lattice", "low": [-0.005, -0.005, 0], "high": [0.005, 0.005, 0.005], "radius": 1e-3,
                  "spacing": 1.1, "material": "glass"}], "boundaries": [)" +
           boundaries + "]}";
}

RunOptions options_of(const std::string& folder)
{
    return {.file = "benchmark", .output = folder, .checkpoint = 0, .quiet = true, .force = true};
}

std::unique_ptr<Exchange> local(const std::string& folder, long tools)
{
    const RunOptions options = options_of(folder);
    return std::make_unique<Soil>(options, read_run(options, text_of_case(tools), {}), names_of(tools));
}

/// The same in a second process, which ends when the exchange is closed
std::unique_ptr<Exchange> remote(const std::string& folder, long tools)
{
    std::array<int, 2> to{}, from{};
    if (pipe(to.data()) != 0 || pipe(from.data()) != 0) throw io::IoError("no pipe");
    if (fork() == 0) {
        close(to[1]), close(from[0]);
        PipeChannel channel(to[0], from[1], "the benchmark");
        serve(channel, [&](const std::vector<std::string>&) { return local(folder, tools); });
        _exit(0);
    }
    close(to[0]), close(from[1]);
    return std::make_unique<RemoteExchange>(std::make_unique<PipeChannel>(from[0], to[1], "the grains"),
                                            names_of(tools));
}

/// Wall time of f [s]
template <class F>
double seconds_of(const F& f)
{
    const auto begin = std::chrono::steady_clock::now();
    f();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double median(std::vector<double> of)
{
    std::nth_element(of.begin(), of.begin() + rounds / 2, of.end());
    return of[rounds / 2];
}

void measure(const std::string& folder, long tools)
{
    const std::unique_ptr<Exchange> other = remote(folder + "/remote", tools),
                                    here = local(folder + "/local", tools);
    const RunOptions options = options_of(folder + "/alone");
    const std::unique_ptr<SteppedRun> alone =
        SteppedRun::open(options, read_run(options, text_of_case(tools), {}));
    const std::vector<ToolBody> bodies(static_cast<std::size_t>(tools), {.mass = 1});
    std::vector<ToolMotion> motions;
    for (const Tool& tool : here->tools()) motions.push_back(tool.place);
    std::vector<ToolImpulse> impulses;
    other->open(bodies, 0), here->open(bodies, 0);
    const auto exchange = [&](Exchange& grains) {
        return seconds_of([&] {
            for (long n = 0; n < exchanges; ++n) grains.advance(motions, 1, impulses);
        });
    };
    std::vector<double> step, in_process, pipe;
    for (int round = 0; round < rounds; ++round) {
        const double s = seconds_of([&] {
            for (long n = 0; n < exchanges; ++n) alone->step();
        });
        step.push_back(s);
        in_process.push_back(exchange(*here) - s);
        pipe.push_back(exchange(*other) - s);
    }
    constexpr double us = 1e6 / exchanges;
    std::printf("tools  step of %zu grains [us]  added by an exchange in process  with pipes [us]\n",
                alone->case_of_run().world->count());
    std::printf("%5ld %24.2f %33.2f %16.2f\n", tools, us * median(step), us * median(in_process),
                us * median(pipe));
    other->close(0), here->close(0), alone->close(0);
    while (wait(nullptr) > 0) {
    }
}

}  // namespace

int main(int argc, char** argv)
try {
    const long tools = argc == 2 ? std::strtol(argv[1], nullptr, 10) : 0;
    if (tools < 1 || tools > 1000) {
        std::fprintf(stderr, "usage: hilda_exchange_benchmark TOOLS\n");
        return 2;
    }
    omp_set_num_threads(1);
    const std::string folder =
        std::filesystem::temp_directory_path() / ("hilda-exchange-" + std::to_string(getpid()));
    measure(folder, tools);
    std::filesystem::remove_all(folder);
} catch (const std::exception& e) {
    std::fprintf(stderr, "hilda_exchange_benchmark: %s\n", e.what());
    return 1;
}
