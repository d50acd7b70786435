// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/arguments.hpp"

#include "io/error.hpp"
#include "lie/schemes.hpp"
#include "run/figures.hpp"
#include "run/frames/vtk.hpp"
#include "studies/framework/study_options.hpp"
#include "studies/problems/n_pendulum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace hilda::studies {

namespace {

std::vector<double> descending(const std::string& option, const std::string& text,
                               double (*read)(const std::string&, const std::string&), const char* once)
{
    std::vector<double> all;
    for (const std::string& part : list(option, text)) all.push_back(read(option, part));
    std::sort(all.rbegin(), all.rend());
    if (std::adjacent_find(all.begin(), all.end()) != all.end()) refuse_option(option, once, text);
    return all;
}

}  // namespace

std::string preset(const std::string& option, const std::string& text)
{
    return one_of(option, text, std::vector<std::string>{"balanced", "dissertation"});
}

std::string normal_rows(const std::string& option, const std::string& text)
{
    return one_of(option, text, std::vector<std::string>{"tangent", "fixed-xy"});
}

std::vector<std::string> formats_of_figures(const std::string& option, const std::string& text)
{
    std::vector<std::string> selected = list(option, text);
    const std::vector<std::string>& known = run::figure_formats();
    for (auto format = selected.begin(); format != selected.end(); ++format) {
        if (std::find(known.begin(), known.end(), *format) == known.end())
            throw io::UsageError(fmt::format("{}: unknown format{} (formats: {})", option,
                                             with_nearest(*format, known), fmt::join(known, ", ")));
        if (std::find(selected.begin(), format, *format) != format)
            refuse_option(option, "must contain each format once", text);
    }
    return selected;
}

int frames(const std::string& option, const std::string& text)
{
    return io::count_up_to(run::Snapshots::max_frames, option, text);
}

std::vector<double> steps(const std::string& option, const std::string& text)
{
    return descending(option, text, positive_number, "must contain each step once");
}

std::vector<double> relative_tolerances(const std::string& option, const std::string& text)
{
    return descending(option, text, relative_tolerance, "must contain each tolerance once");
}

std::vector<int> bars(const std::string& option, const std::string& text)
{
    std::vector<int> N;
    for (const std::string& part : list(option, text)) {
        const std::optional<int> n = io::number_in<int>(part);
        if (!n || *n < 1 || *n > most_bars)
            refuse_option(option, "N must be a whole number from 1 to " + std::to_string(most_bars), part);
        N.push_back(*n);
    }
    std::sort(N.begin(), N.end());
    if (std::adjacent_find(N.begin(), N.end()) != N.end())
        refuse_option(option, "must contain each N once", text);
    return N;
}

run::Shard shard(const std::string& option, const std::string& text)
{
    constexpr long most = 1000000;
    const size_t slash = text.find('/');
    const auto index = io::number_in<long>(text.substr(0, slash));
    const auto count = io::number_in<long>(slash == std::string::npos ? "" : text.substr(slash + 1));
    if (!index || !count || *index < 1 || *index > *count || *count > most)
        refuse_option(option, fmt::format("must be I/N, part I of N with 1 <= I <= N <= {}", most), text);
    return {.index = *index, .count = *count};
}

Expectation expectation(const std::string& option, const std::string& text)
{
    const size_t equals = text.find('='), plus_minus = text.find("+-");
    const std::string form = "must be KEY=VALUE or KEY=VALUE+-TOL, such as order=2+-0.1";
    if (equals == std::string::npos || equals == 0) refuse_option(option, form, text);
    Expectation e{.key = text.substr(0, equals), .text = text};
    e.value = io::finite_number_in(
        std::string_view(text).substr(equals + 1, plus_minus - std::min(plus_minus, equals + 1)));
    if (plus_minus != std::string::npos)
        e.tolerance = io::finite_number_in(std::string_view(text).substr(plus_minus + 2));
    if (std::isnan(e.value) || !(e.tolerance >= 0)) refuse_option(option, form, text);
    return e;
}

std::vector<std::string> integrators(const std::string& option, const std::string& text)
{
    std::vector<std::string> known;
    for (const lie::Scheme& scheme : lie::schemes()) known.push_back(scheme.name);
    std::vector<std::string> selected = list(option, text);
    for (size_t k = 0; k < selected.size(); ++k) {
        if (std::find(known.begin(), known.end(), selected[k]) == known.end())
            throw io::UsageError(option + ": unknown integrator" + with_nearest(selected[k], known) +
                                 " (hilda integrators lists them)");
        if (std::find(selected.begin(), selected.begin() + static_cast<std::ptrdiff_t>(k), selected[k]) !=
            selected.begin() + static_cast<std::ptrdiff_t>(k))
            refuse_option(option, "must contain each integrator once", text);
    }
    return selected;
}

std::string integrator(const std::string& option, const std::string& text)
{
    const std::vector<std::string> named = integrators(option, text);
    if (named.size() != 1) refuse_option(option, "must be one integrator", text);
    return named.front();
}

}  // namespace hilda::studies
