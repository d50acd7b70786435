// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/problem.hpp"

#include "io/nearest.hpp"
#include "lie/check.hpp"
#include "studies/problems/n_four_bar.hpp"
#include "studies/problems/n_pendulum.hpp"

#include <algorithm>
#include <optional>

namespace hilda::studies {

namespace {

/// N of FAMILY_N; empty for other names. lie::InvalidInput for N out of range.
std::optional<int> member_number(const std::string& name, const std::string& family, int most)
{
    if (!name.starts_with(family + '_')) return std::nullopt;
    const std::string digits = name.substr(family.size() + 1);
    if (digits.empty() || digits.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
    const int n = digits.size() > 6 ? most + 1 : std::stoi(digits);
    if (n < 1 || n > most || digits.front() == '0')
        lie::reject("studies::problem", "N of " + family + "_N must be from 1 to " + std::to_string(most),
                    name);
    return n;
}

}  // namespace

Problem problem(const std::string& name)
{
    if (const Problem* known = io::Registry<Problem>::find(name)) return *known;
    if (const auto n = member_number(name, "n_pendulum", most_bars)) return n_pendulum(*n, name);
    if (const auto n = member_number(name, "n_four_bar", most_windows)) return n_four_bar(*n, name);

    const std::vector<std::string> names = io::Registry<Problem>::names();
    std::string all;
    for (const std::string& known : names) all += (all.empty() ? "" : ", ") + known;
    const std::string meant = io::nearest(name, names);
    throw lie::InvalidInput("no built-in model is called '" + name + "'" +
                            (meant.empty() ? "." : "; did you mean '" + meant + "'?") + " Built-in models: " +
                            all + ", n_pendulum_N for N from 1 to " + std::to_string(most_bars) +
                            ", and n_four_bar_N for N from 1 to " + std::to_string(most_windows));
}

}  // namespace hilda::studies

template class hilda::io::Registry<hilda::studies::Problem>;
