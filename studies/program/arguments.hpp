// SPDX-License-Identifier: GPL-3.0-or-later
/// Conversion of option values of the command line to numbers, lists and names. Each function takes the name
/// of the option and its text. An invalid text is a io::UsageError that states the option, the valid range and
/// the text.

#pragma once

#include "lie/solver/linear_solver.hpp"
#include "studies/framework/study.hpp"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hilda::studies {

/// A finite number. The whole text must be the number.
double number(const std::string& option, const std::string& text);
/// A finite number > 0, and a finite number >= 0
double positive_number(const std::string& option, const std::string& text);
double nonnegative_number(const std::string& option, const std::string& text);
/// A number from 0 to 1
double fraction(const std::string& option, const std::string& text);
/// A relative tolerance: 1e-14 <= value < 1. Smaller tolerances are below the rounding errors of double
/// precision.
double relative_tolerance(const std::string& option, const std::string& text);
/// An absolute tolerance: value >= 1e-14
double absolute_tolerance(const std::string& option, const std::string& text);
/// auto, klu or condensed
lie::LinearSolver linear_solver(const std::string& option, const std::string& text);
/// One of the words; the error lists them.
std::string one_of(const std::string& option, const std::string& text, std::span<const std::string> words);
/// balanced or dissertation
std::string preset(const std::string& option, const std::string& text);
/// tangent or fixed-xy
std::string normal_rows(const std::string& option, const std::string& text);
/// An integer >= 1
int positive_count(const std::string& option, const std::string& text);
/// A number of frames, from 1 to Snapshots::max_frames
int frames(const std::string& option, const std::string& text);

/// An unsigned 64-bit integer
std::uint64_t seed(const std::string& option, const std::string& text);

/// The parts of A,B,C. No part may be empty.
std::vector<std::string> list(const std::string& option, const std::string& text);
/// Step sizes H1,H2,... > 0, sorted in descending order. Each may occur once.
std::vector<double> steps(const std::string& option, const std::string& text);
/// Relative tolerances R1,R2,..., each as in relative_tolerance(), sorted in descending order
std::vector<double> relative_tolerances(const std::string& option, const std::string& text);
/// Numbers of bars N1,N2,...: integers from 1 to most_bars, sorted in ascending order
std::vector<int> bars(const std::string& option, const std::string& text);

/// The text of a setting. It must have the form /json/pointer=VALUE.
std::string setting(const std::string& option, const std::string& text);
/// KEY=VALUE[+-TOL]
Expectation expectation(const std::string& option, const std::string& text);

/// The text " 'x'; did you mean 'y'?", where y is the known word nearest to x; without the question if no
/// known word is near.
std::string with_nearest(const std::string& word, std::span<const std::string> known);

/// The integrators of a list NAME,NAME,...; io::UsageError for an unknown name or for a name given twice.
std::vector<std::string> integrators(const std::string& option, const std::string& text);
/// One integrator
std::string integrator(const std::string& option, const std::string& text);

}  // namespace hilda::studies
