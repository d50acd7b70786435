// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/model_file.hpp"
#include "io/files.hpp"
#include "reference/solvers/reference_solution.hpp"
#include "run/named_model.hpp"
#include "studies/framework/problem.hpp"

#include <filesystem>

namespace hilda::studies {

Problem problem_or_file(const std::string& name_or_path)
{
    constexpr size_t most = 64 << 20;
    Problem p;
    if (!run::is_model_path(name_or_path)) {
        p = problem(name_or_path);
    } else {
        std::error_code error;  // of names that the file system does not accept
        if (!std::filesystem::exists(name_or_path, error))
            throw lie::InvalidInput(name_or_path + ": there is no such file");
        if (!std::filesystem::is_regular_file(name_or_path, error))
            throw lie::InvalidInput(name_or_path + ": a model file must be a regular file");
        p.name = std::filesystem::path(name_or_path).stem().string();
        p.what = "model file " + name_or_path;
        p.file = name_or_path;
        p.folder = std::filesystem::path(name_or_path).parent_path().string();
        p.model = io::read_file(name_or_path, most);
    }
    if (!p.reference_solution) {
        p.general_reference = true;
        p.reference_name = "kinematic analysis or index-1 equations (GSL rk8pd), 1e-13";
        p.reference_solution = [](dae::Description& d, const std::vector<double>& t) {
            return reference::reference_solution(*d.model, d.x, t);
        };
    }
    return p;
}

}  // namespace hilda::studies
