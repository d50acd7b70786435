// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/program/provenance.hpp"

#include "granular/build.hpp"

#if __has_include(<hilda/version.hpp>)
#include <hilda/version.hpp>
#endif

#include <CLI/Version.hpp>

#include <fstream>

namespace hilda::granular {

namespace {

// A build of the folder granular alone has no generated version header.
#if __has_include(<hilda/version.hpp>)
constexpr const char* git = studies::version::git;
#else
constexpr const char* git = "unknown";
#endif

std::string processor()
{
    std::ifstream in("/proc/cpuinfo");
    for (std::string line; std::getline(in, line);)
        if (line.starts_with("model name"))
            if (const std::size_t at = line.find(": "); at != std::string::npos) return line.substr(at + 2);
    return "unknown";
}

}  // namespace

std::string version_line()
{
    return std::string("hilda-granular ") + build::number + " (git " + git + ", " + build::build_type + ")";
}

nlohmann::ordered_json provenance(const std::string& command_line, int threads, const std::string& device)
{
    nlohmann::ordered_json libraries = {
        {"Thrust", build::thrust},
        {"OpenMP", build::openmp},
        {"CLI11", CLI11_VERSION},
        {"nlohmann_json", std::to_string(NLOHMANN_JSON_VERSION_MAJOR) + '.' +
                              std::to_string(NLOHMANN_JSON_VERSION_MINOR) + '.' +
                              std::to_string(NLOHMANN_JSON_VERSION_PATCH)}};
    if (*build::cuda != '\0') libraries["CUDA"] = build::cuda;
    return {{"version", build::number},
            {"git", git},
            {"build_type", build::build_type},
            {"flags", build::flags},
            {"compiler", build::compiler},
            {"libraries", libraries},
            {"command_line", command_line},
            {"cpu", processor()},
            {"threads", threads},
            {"device", device}};
}

}  // namespace hilda::granular
