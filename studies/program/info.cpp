// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/info.hpp"

#include "io/files.hpp"
#include "io/json.hpp"
#include "io/provenance.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "run/cosim/grains.hpp"
#include "run/provenance.hpp"
#include "studies/framework/problem.hpp"
#include "studies/framework/study.hpp"
#include "studies/program/plot.hpp"

#include <fmt/format.h>
#include <hilda/version.hpp>

#include <sys/utsname.h>

#include <iostream>
#include <thread>

namespace hilda::studies {

namespace {

std::string system_name()
{
    utsname u{};
    return uname(&u) == 0 ? fmt::format("{} {} {}", u.sysname, u.release, u.machine) : "unknown";
}

constexpr const char* devices = "CPU; hilda does not use GPUs (see hilda granular --device)";

}  // namespace

int info(bool json, const std::string& command_line)
{
    const auto cores = static_cast<int>(std::thread::hardware_concurrency());
    io::Json all = run::provenance(command_line, cores);
    all["system"] = system_name();
    all["devices"] = devices;
    const std::string figures = python_and_matplotlib();
    all["figures"] = figures;
    const run::GrainFunctions* const of_grains = run::find_grains("info");
    const std::string vectors =
        of_grains != nullptr ? of_grains->vector_instructions() : "the module hilda-grains was not built";
    all["vector_instructions_of_grains"] = vectors;
    if (json) {
        std::cout << all.text();
        return io::exit_code::done;
    }
    const auto line = [](const char* what, const std::string& text) {
        std::cout << fmt::format("{:<14}{}\n", what, text);
    };
    line("version", fmt::format("{}, git {}", version::number, version::git));
    line("build", run::build_line());
    line("modules", run::modules_line());
    std::string versions;
    for (const auto& [name, number] : run::libraries())
        versions += (versions.empty() ? "" : ", ") + name + ' ' + number;
    line("libraries", versions);
    line("system", system_name());
    line("processor", fmt::format("{}, {} threads", io::processor(), cores));
    line("grains", vectors);
    line("devices", devices);
    line("figures", figures);
    line("registered", fmt::format("{} integrators, {} models, {} studies", lie::schemes().size(),
                                   problems().size(), studies().size()));
    return io::exit_code::done;
}

}  // namespace hilda::studies
