// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/experiments/sweep/swept_model.hpp"

#include "io/error.hpp"
#include "io/json.hpp"
#include "lie/check.hpp"
#include "studies/framework/study_options.hpp"

#include <fmt/format.h>

namespace hilda::studies {

std::vector<std::string> SweptModel::changes(size_t k) const
{
    std::vector<std::string> all = combination(entries, k);
    for (size_t e = 0; e < all.size(); ++e) all[e] = entries[e].pointer + '=' + all[e];
    return all;
}

std::string SweptModel::name(size_t k) const
{
    return fmt::format("{} with {}", problem.name, fmt::join(changes(k), ", "));
}

Benchmark SweptModel::benchmark(size_t k) const
{
    StudyOptions changed = options;
    changed.quiet = true;  // warnings would come once for each combination
    const std::vector<std::string> of_sweep = changes(k);
    changed.set.insert(changed.set.end(), of_sweep.begin(), of_sweep.end());
    try {
        Benchmark c = make_benchmark(problem, changed);
        c.problem.name = name(k);
        return c;
    } catch (const lie::InvalidInput& error) {
        std::string what = error.what();
        for (const std::string& change : of_sweep) {
            const std::string from = "--set " + io::in_quotes(change);
            if (const size_t at = what.find(from); at != std::string::npos)
                what.replace(at, from.size(), "--sweep " + change);
        }
        if (what.find("--sweep ") == std::string::npos) what += " (" + name(k) + ")";
        throw lie::InvalidInput(what);
    }
}

}  // namespace hilda::studies
