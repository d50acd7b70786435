// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/problem.hpp"

#include "io/nearest.hpp"
#include "lie/check.hpp"
#include "studies/problems/n_pendulum.hpp"

#include <algorithm>
#include <optional>

namespace hilda::studies {

namespace {

// Constructed on first use, because problems are registered by static initialisers in unspecified order.
std::vector<Problem>& list()
{
    static std::vector<Problem> problems;
    return problems;
}

/// N of n_pendulum_N; empty for other names. lie::InvalidInput for N out of range.
std::optional<int> bars(const std::string& name)
{
    static const std::string family = "n_pendulum_";
    if (!name.starts_with(family)) return std::nullopt;
    const std::string digits = name.substr(family.size());
    if (digits.empty() || digits.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
    const int n = digits.size() > 6 ? most_bars + 1 : std::stoi(digits);
    if (n < 1 || n > most_bars || digits.front() == '0')
        lie::reject("studies::problem", "N of n_pendulum_N must be from 1 to " + std::to_string(most_bars),
                    name);
    return n;
}

}  // namespace

const std::vector<Problem>& problems() { return list(); }

Problem problem(const std::string& name)
{
    std::vector<std::string> names;
    for (const Problem& p : problems()) {
        if (p.name == name) return p;
        names.push_back(p.name);
    }
    if (const std::optional<int> n = bars(name)) return n_pendulum(*n, name);

    std::string all;
    for (const std::string& known : names) all += (all.empty() ? "" : ", ") + known;
    const std::string meant = io::nearest(name, names);
    throw lie::InvalidInput("no built-in model is called '" + name + "'" +
                            (meant.empty() ? "." : "; did you mean '" + meant + "'?") + " Built-in models: " +
                            all + ", and n_pendulum_N for N from 1 to " + std::to_string(most_bars));
}

bool register_problem(Problem problem)
{
    std::vector<Problem>& all = list();
    const auto at = std::lower_bound(all.begin(), all.end(), problem,
                                     [](const Problem& a, const Problem& b) { return a.name < b.name; });
    if (at != all.end() && at->name == problem.name)
        throw std::logic_error("two problems are called " + problem.name);
    all.insert(at, std::move(problem));
    return true;
}

}  // namespace hilda::studies
