// SPDX-License-Identifier: GPL-3.0-or-later
/// Values on the command line: numbers, lists, names. Each is refused with the option it belongs to and what
/// was typed.

#pragma once

#include "studies/framework/study.hpp"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hilda::studies {

/// A finite number, all of the text
double number(const std::string& option, const std::string& text);
/// The same, larger than zero, or at least zero
double positive_number(const std::string& option, const std::string& text);
double nonnegative_number(const std::string& option, const std::string& text);
/// From 0 to 1
double fraction(const std::string& option, const std::string& text);
/// A relative tolerance that double precision can keep: from 1e-14 to below 1
double relative_tolerance(const std::string& option, const std::string& text);
/// The same for the absolute one, which has no upper bound
double absolute_tolerance(const std::string& option, const std::string& text);
/// auto, klu or condensed
lie::LinearSolver linear_solver(const std::string& option, const std::string& text);
/// One of these words; UsageError lists them.
std::string one_of(const std::string& option, const std::string& text, std::span<const std::string> words);
/// balanced or dissertation
std::string preset(const std::string& option, const std::string& text);
/// tangent or fixed-xy
std::string normal_rows(const std::string& option, const std::string& text);
/// A whole number, at least 1
int positive_count(const std::string& option, const std::string& text);
/// The same, of frames that can be told apart by their names
int frames(const std::string& option, const std::string& text);

/// A whole number from 0, of 64 bits
std::uint64_t seed(const std::string& option, const std::string& text);

/// A,B,C: no part empty
std::vector<std::string> list(const std::string& option, const std::string& text);
/// Step sizes H1,H2,...: positive, the largest first
std::vector<double> steps(const std::string& option, const std::string& text);
/// Relative tolerances R1,R2,...: each as relative_tolerance(), the largest first
std::vector<double> relative_tolerances(const std::string& option, const std::string& text);
/// Numbers of bars N1,N2,...: whole numbers from 1 to most_bars, the smallest first
std::vector<int> bars(const std::string& option, const std::string& text);

/// /json/pointer=VALUE, as it is
std::string setting(const std::string& option, const std::string& text);
/// KEY=VALUE[+-TOL]
Expectation expectation(const std::string& option, const std::string& text);

/// " 'x'; did you mean 'y'?" with the known word nearest to x, where one is near
std::string with_nearest(const std::string& word, std::span<const std::string> known);

/// The integrators named; UsageError for one that is not there.
std::vector<std::string> integrators(const std::string& option, const std::string& text);
/// The same of one name
std::string integrator(const std::string& option, const std::string& text);

}  // namespace hilda::studies
