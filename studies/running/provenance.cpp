// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/running/provenance.hpp"

#include "io/provenance.hpp"

#include <fmt/format.h>
#include <CLI/Version.hpp>
#include <hilda/version.hpp>

namespace hilda::studies {

std::vector<std::pair<std::string, std::string>> libraries()
{
    return {
        {"Eigen", version::eigen},
        {"KLU", version::klu},
        {"SPQR", version::spqr},
        {"GSL", version::gsl},
        {"SUNDIALS", version::sundials},
        {"CLI11", CLI11_VERSION},
        {"fmt", fmt::format("{}.{}.{}", FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100)}};
}

io::Json provenance(const std::string& command_line, int threads)
{
    io::Json all = io::Json::object();
    for (const auto& [library, number] : libraries()) all[library] = number;
    return {
        {"version", version::number},   {"git", version::git},           {"build_type", version::build_type},
        {"flags", version::flags},      {"compiler", version::compiler}, {"libraries", all},
        {"command_line", command_line}, {"cpu", io::processor()},        {"threads", threads}};
}

}  // namespace hilda::studies
