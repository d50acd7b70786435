// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/model_file.hpp"
#include "io/files.hpp"
#include "reference/solvers/reference_solution.hpp"
#include "studies/framework/problem.hpp"
#include "studies/running/named_model.hpp"

#include <filesystem>

namespace hilda::studies {

Problem problem_or_file(const std::string& name_or_path)
{
    if (!is_model_path(name_or_path)) return problem(name_or_path);
    constexpr size_t most = 64 << 20;
    if (!std::filesystem::exists(name_or_path))
        throw lie::InvalidInput(name_or_path + ": there is no such file");
    return {.name = std::filesystem::path(name_or_path).stem().string(),
            .what = "model file " + name_or_path,
            .model = io::read_file(name_or_path, most),
            .reference_name = "kinematic analysis or index-1 equations (GSL rk8pd), 1e-13",
            .reference_solution =
                [](dae::Description& d, const std::vector<double>& t) {
                    return reference::reference_solution(*d.model, d.x, t);
                },
            .observable = {}};
}

}  // namespace hilda::studies
