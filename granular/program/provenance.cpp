// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/program/provenance.hpp"

#include "granular/backend/instruction_set.hpp"
#include "granular/build.hpp"
#include "io/provenance.hpp"

#if __has_include(<hilda/version.hpp>)
#include <hilda/version.hpp>
#endif

#include <CLI/Version.hpp>

namespace hilda::granular {

namespace {

// A build of the folder granular alone has no generated version header.
#if __has_include(<hilda/version.hpp>)
constexpr const char* git = version::git;
#else
constexpr const char* git = "unknown";
#endif

}  // namespace

std::string version_line()
{
    return std::string("hilda-granular ") + build::number + " (git " + git + ", " + build::build_type + ")" +
           (*build::added_laws != '\0' ? std::string(", added laws: ") + build::added_laws : "");
}

std::string build_line()
{
    std::string sets;
    for (const InstructionSet& set : instruction_sets())
        sets += (sets.empty() ? "" : ", ") + std::string(set.name);
    return std::string("build: ") + build::compiler + ", " + build::flags +
           "\nvector instructions: " + described_instruction_set() + ", of " + sets + "\ndevices: CPU" +
           (*build::cuda != '\0' ? std::string(", CUDA ") + build::cuda : "; built without CUDA");
}

io::Json provenance(const std::string& command_line, int threads, const std::string& device)
{
    std::vector<std::pair<std::string, std::string>> libraries = {
        {"Thrust", build::thrust}, {"OpenMP", build::openmp}, {"CLI11", CLI11_VERSION}};
    if (*build::cuda != '\0') libraries.emplace_back("CUDA", build::cuda);
    io::Json all = io::provenance({build::number, git, build::build_type, build::flags, build::compiler},
                                  libraries, command_line, threads);
    all["device"] = device;
    all["vector_instructions"] = instruction_set().name;
    if (*build::added_laws != '\0') all["added_laws"] = build::added_laws;
    return all;
}

}  // namespace hilda::granular
