// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/provenance.hpp"

#include "io/module.hpp"
#include "io/provenance.hpp"

#include <fmt/format.h>
#include <CLI/Version.hpp>
#include <hilda/version.hpp>

namespace hilda::run {

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

std::string version_line() { return fmt::format("hilda {} ({})", version::number, version::git); }

std::string build_line()
{
    return fmt::format("{}, {}, {}", version::build_type, version::compiler, version::flags);
}

std::string modules_line()
{
    std::string present, missing;
    for (const auto& [name, file] : {std::pair{"grains", "hilda-grains.so"},
                                     {"HDF5", "hilda-hdf5.so"},
                                     {"MPI", "hilda-mpi.so"},
                                     {"URDF", "hilda-urdf.so"},
                                     {"MJCF", "hilda-mjcf.so"}}) {
        const bool exists = !io::find_module({.name = file,
                                              .library_folder = HILDA_LIBRARY_FOLDER,
                                              .caller = reinterpret_cast<const void*>(&modules_line)})
                                 .empty();
        std::string& to = exists ? present : missing;
        to += (to.empty() ? "" : ", ") + std::string(name);
    }
    return (present.empty() ? "none" : present) + (missing.empty() ? "" : "; missing: " + missing);
}

io::Json provenance(const std::string& command_line, int threads)
{
    return io::provenance(
        {version::number, version::git, version::build_type, version::flags, version::compiler}, libraries(),
        command_line, threads);
}

}  // namespace hilda::run
