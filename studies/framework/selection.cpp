// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/selection.hpp"

#include "io/error.hpp"

#include <algorithm>

namespace hilda::studies {

Schemes any_schemes(const StudyOptions& options, const std::vector<std::string>& defaults)
{
    Schemes selected;
    for (const std::string& name : options.integrators) selected.push_back(&lie::scheme(name));
    if (!selected.empty()) return selected;
    for (const std::string& name : defaults)
        for (const lie::Scheme& s : lie::schemes())
            if (s.name == name) selected.push_back(&s);
    if (defaults.empty())
        for (const lie::Scheme& s : lie::schemes()) selected.push_back(&s);
    return selected;
}

Schemes fixed_step_schemes(const std::string& kind, const StudyOptions& options,
                           const std::vector<std::string>& defaults)
{
    Schemes fixed;
    for (const lie::Scheme* s : any_schemes(options, defaults)) {
        if (!s->adaptive)
            fixed.push_back(s);
        else if (!options.integrators.empty())
            throw io::UsageError(
                "study " + kind + ": " + s->name +
                " chooses its own steps by --rtol and --atol; hilda study work-precision compares "
                "it with the others");
    }
    return fixed;
}

std::vector<double> steps_or(const StudyOptions& options, const std::vector<double>& defaults)
{
    std::vector<double> steps = options.steps.empty() ? defaults : options.steps;
    std::sort(steps.rbegin(), steps.rend());
    return steps;
}

double one_step(const std::string& kind, const StudyOptions& options, double defaults)
{
    if (options.steps.size() > 1)
        throw io::UsageError("study " + kind + ": --steps takes one step, got " +
                             std::to_string(options.steps.size()));
    return options.steps.empty() ? defaults : options.steps.front();
}

void refuse_schemes(const std::string& kind, const StudyOptions& options)
{
    const auto reject_if = [&](bool given, const std::string& option) {
        if (given)
            throw io::UsageError("study " + kind + ": " + option +
                                 " is for studies of models; this study defines its own bodies");
    };
    reject_if(!options.integrators.empty(), "--integrator");
    reject_if(!options.set.empty(), "--set");
}

void check_vtk(const std::string& kind, const StudyOptions& options)
{
    if (options.vtk > 0 && options.output.empty())
        throw io::UsageError("study " + kind + ": --vtk writes files: with --json it needs --output");
}

void refuse_models(const std::string& kind, const StudyOptions& options)
{
    if (!options.problems.empty())
        throw io::UsageError("study " + kind +
                             ": --problem is for studies of models; this study defines its own bodies");
    refuse_schemes(kind, options);
}

}  // namespace hilda::studies
