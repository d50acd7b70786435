// SPDX-License-Identifier: GPL-3.0-or-later
/// The program hilda-granular: runs a granular case. Of its own, because it may be built for a GPU and then links CUDA.

#include "granular/files.hpp"
#include "granular/program/memory.hpp"
#include "granular/program/run.hpp"

#include <CLI/CLI.hpp>

#include <omp.h>
#include <cstdio>
#include <filesystem>

using namespace hilda::granular;

int main(int argc, char** argv)
{
    Options o;
    CLI::App app("hilda-granular: a granular case");
    app.add_option("CASE", o.file, "a case file in JSON")->required();
    app.add_option("--output", o.output, "directory of what the run leaves; by default named after the case");
    app.add_option("--threads", o.threads, "of the CPU; the results do not depend on it")
        ->check(CLI::PositiveNumber);
    app.add_option("--checkpoint", o.checkpoint, "least seconds between two checkpoints; none by default")
        ->check(CLI::PositiveNumber);
    app.add_option("--device", o.device, "cpu");
    app.add_flag("--resume", o.resume, "goes on from the checkpoint in the output directory");
    app.add_flag("--force", o.force, "writes over an earlier run");
    app.add_flag("--no-vtk", o.no_vtk, "writes no particles for ParaView");
    app.add_flag("--quiet", o.quiet, "says nothing but errors");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0) return app.exit(e);
        std::fprintf(stderr, "hilda: error: granular: %s\n", e.what());
        return usage;
    }
    if (o.device != "cpu") {
        std::fprintf(stderr, "hilda: error: --device %s: this program was built for the CPU alone\n",
                     o.device.c_str());
        return no_device;
    }
    if (o.threads > 0) omp_set_num_threads(o.threads);
    if (o.output.empty()) o.output = std::filesystem::path(o.file).stem().string();
    for (const int s : {SIGINT, SIGTERM})
        std::signal(s, [](int which) {
            caught = which;
            std::signal(which, SIG_DFL);  // who asks twice does not want to wait
        });
    std::signal(SIGXFSZ, SIG_IGN);
    try {
        std::string text;
        try {
            text = read_file(o.file, std::size_t{64} << 20);
        } catch (const FileError& e) {
            throw InvalidCase(e.what());
        }
        Case c = read_case(text, o.file, {.memory = available_memory()});
        if (!o.quiet)
            for (const std::string& n : c.notices) std::fprintf(stderr, "hilda: warning: %s\n", n.c_str());
        return run(o, std::move(c));
    } catch (const InvalidCase& e) {
        std::fprintf(stderr, "hilda: error: %s\n", e.what());
        return bad_case;
    } catch (const FileError& e) {
        std::fprintf(stderr, "hilda: error: %s\n", e.what());
        return io;
    } catch (const std::bad_alloc&) {
        std::fprintf(stderr, "hilda: error: not enough memory\n");
        return bad_case;
    }
}
