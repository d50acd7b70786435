// SPDX-License-Identifier: GPL-3.0-or-later
/// Option values of hilda, as in io/option_values.hpp.

#pragma once

#include "io/nearest.hpp"
#include "io/option_values.hpp"
#include "run/jobs/shard.hpp"
#include "run/recording/setting_options.hpp"

#include <string>
#include <vector>

namespace hilda::studies {

struct Expectation;

using io::fraction;
using io::list;
using io::nonnegative_number;
using io::number;
using io::one_of;
using io::positive_count;
using io::positive_number;
using io::refuse_option;
using io::seed;
using io::setting;
using io::with_nearest;
using run::relative_tolerance;

/// balanced or dissertation
std::string preset(const std::string& option, const std::string& text);
/// tangent or fixed-xy
std::string normal_rows(const std::string& option, const std::string& text);
/// Formats of figures NAME,NAME,...: those of figure_formats() in run/figures.hpp, each once
std::vector<std::string> formats_of_figures(const std::string& option, const std::string& text);
/// A number of frames, from 1 to Snapshots::max_frames
int frames(const std::string& option, const std::string& text);

/// Step sizes H1,H2,... > 0, sorted in descending order. Each may occur once.
std::vector<double> steps(const std::string& option, const std::string& text);
/// Relative tolerances R1,R2,..., each as in relative_tolerance(), sorted in descending order
std::vector<double> relative_tolerances(const std::string& option, const std::string& text);
/// Numbers of bars N1,N2,...: integers from 1 to most_bars, sorted in ascending order
std::vector<int> bars(const std::string& option, const std::string& text);

/// I/N with 1 <= I <= N <= 1000000
run::Shard shard(const std::string& option, const std::string& text);

/// KEY=VALUE[+-TOL]
Expectation expectation(const std::string& option, const std::string& text);

/// The integrators of a list NAME,NAME,...; io::UsageError for an unknown name or for a name given twice.
std::vector<std::string> integrators(const std::string& option, const std::string& text);
/// One integrator
std::string integrator(const std::string& option, const std::string& text);

}  // namespace hilda::studies
