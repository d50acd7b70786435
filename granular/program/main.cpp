// SPDX-License-Identifier: GPL-3.0-or-later
/// The program hilda-granular: runs a granular case. Of its own, because it may be built for a GPU and then links CUDA.

#include "granular/files.hpp"
#include "granular/program/formula.hpp"
#include "granular/program/memory.hpp"
#include "granular/program/run.hpp"
#include "granular/program/validate.hpp"

#include <CLI/CLI.hpp>

#include <omp.h>
#include <charconv>
#include <cstdio>
#include <filesystem>

using namespace hilda::granular;

namespace {

std::optional<Device> device_of(const std::string& name)
{
    if (name == "cpu") return Device{};
    if (name == "cuda") return Device{.kind = Device::cuda};
    int number = 0;
    const char* end = name.data() + name.size();
    if (name.starts_with("cuda:") && std::from_chars(name.data() + 5, end, number).ptr == end &&
        number >= 0 && name.size() > 5)
        return Device{.kind = Device::cuda, .number = number};
    return {};
}

}  // namespace

int main(int argc, char** argv)
{
    Options o;
    bool full = false;
    CLI::App app("hilda-granular: a granular case");
    app.add_option("CASE", o.file, "a case file in JSON, or the name of a validation")->required();
    app.add_option("--output", o.output,
                   "directory of what the run leaves; by default out/ and the name of the file");
    app.add_option("--threads", o.threads, "of the CPU; the results do not depend on it")
        ->check(CLI::PositiveNumber);
    app.add_option("--checkpoint", o.checkpoint, "least seconds between two checkpoints; none by default")
        ->check(CLI::PositiveNumber);
    app.add_option("--device", o.device, "cpu, or cuda or cuda:N for a GPU")
        ->check(CLI::Validator(
            [](const std::string& s) { return device_of(s) ? "" : "must be cpu, cuda or cuda:N"; }, "",
            "device"));
    app.add_flag("--resume", o.resume, "goes on from the checkpoint in the output directory");
    app.add_flag("--force", o.force, "writes over an earlier run");
    app.add_flag("--no-vtk", o.no_vtk, "writes no particles for ParaView");
    app.add_flag("--full", full, "all values of a validation, not only those that say most");
    app.add_flag("--quiet", o.quiet, "says nothing but errors");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0) return app.exit(e);
        std::fprintf(stderr, "hilda: error: granular: %s\n", e.what());
        return usage;
    }
    if (o.threads > 0) omp_set_num_threads(o.threads);
    if (const Validation* v = find_validation(o.file))
        return validate(*v, {.full = full, .device = *device_of(o.device)}, o.quiet);
    if (full && std::filesystem::exists(o.file)) {
        std::fprintf(stderr, "hilda: error: --full: is for validations, and %s is a file\n", o.file.c_str());
        return usage;
    }
    if (o.output.empty()) o.output = "out/" + std::filesystem::path(o.file).stem().string();
    for (const int s : {SIGINT, SIGTERM})
        std::signal(s, [](int which) {
            caught = which;
            std::signal(which, SIG_DFL);  // who asks twice does not want to wait
        });
    std::signal(SIGXFSZ, SIG_IGN);
    try {
        const Device device = *device_of(o.device);
        make_engine(device);  // one that is not there is refused before the case is read
        std::string text;
        try {
            text = read_file(o.file, std::size_t{64} << 20);
        } catch (const FileError& e) {
            throw InvalidCase(e.what() + (std::filesystem::exists(o.file) ? "" : known_validations()));
        }
        Case c =
            read_case(text, o.file, {.memory = available_memory(), .compile = compile, .device = device});
        if (!o.quiet)
            for (const std::string& n : c.notices) std::fprintf(stderr, "hilda: warning: %s\n", n.c_str());
        return run(o, std::move(c));
    } catch (const InvalidCase& e) {
        std::fprintf(stderr, "hilda: error: %s\n", e.what());
        return bad_case;
    } catch (const FileError& e) {
        std::fprintf(stderr, "hilda: error: %s\n", e.what());
        return io;
    } catch (const DeviceError& e) {
        std::fprintf(stderr, "hilda: error: --device %s: %s\n", o.device.c_str(), e.what());
        return no_device;
    } catch (const std::bad_alloc&) {
        std::fprintf(stderr, "hilda: error: not enough memory\n");
        return bad_case;
    }
}
