// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/problem.hpp"

#include "io/nearest.hpp"
#include "lie/check.hpp"
#include "run/named_model.hpp"

#include <algorithm>
#include <optional>

namespace hilda::studies {

namespace {

/// N of NAME_N; empty for other names. lie::InvalidInput for N out of range.
std::optional<int> member_number(const std::string& name, const ProblemFamily& family)
{
    if (!name.starts_with(family.name + '_')) return std::nullopt;
    const std::string digits = name.substr(family.name.size() + 1);
    if (digits.empty() || digits.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
    const int n = digits.size() > 6 ? family.most + 1 : std::stoi(digits);
    if (n < 1 || n > family.most || digits.front() == '0')
        lie::reject("studies::problem",
                    "N of " + family.name + "_N must be from 1 to " + std::to_string(family.most), name);
    return n;
}

/// The problems as models that have names
const bool registered_problems =
    io::Registry<run::ModelSource>::add({.name = "problems", .find = [](const std::string& name) {
                                             const Problem found = problem(name);
                                             return run::NamedText{found.name, found.model};
                                         }});

}  // namespace

Problem problem(const std::string& name)
{
    if (const Problem* known = io::Registry<Problem>::find(name)) return *known;
    const std::vector<ProblemFamily>& families = io::Registry<ProblemFamily>::all();
    for (const ProblemFamily& family : families)
        if (const auto n = member_number(name, family)) return family.member(*n, name);

    const std::vector<std::string> names = io::Registry<Problem>::names();
    std::string all;
    for (const std::string& known : names) all += (all.empty() ? "" : ", ") + known;
    for (const ProblemFamily& family : families)
        all += ", " + family.name + "_N for N from 1 to " + std::to_string(family.most);
    const std::string meant = io::nearest(name, names);
    throw lie::InvalidInput("no built-in model is called '" + name + "'" +
                            (meant.empty() ? "." : "; did you mean '" + meant + "'?") +
                            " Built-in models: " + all);
}

}  // namespace hilda::studies

template class hilda::io::Registry<hilda::studies::Problem>;
