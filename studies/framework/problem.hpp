// SPDX-License-Identifier: GPL-3.0-or-later
/// Built-in models: a model file each, with the truth its runs are judged by.

#pragma once

#include "dae/model_file.hpp"
#include "lie/trajectory.hpp"

#include <functional>

namespace hilda::studies {

/// States of a trusted solution at these instants [s], ascending, the first not before 0. Complete states:
/// with accelerations and multipliers.
using ReferenceSolution =
    std::function<lie::Trajectory(dae::Description&, const std::vector<double>& instants)>;

/// A scalar of one body, such as the height of bar 2: what the figures of the dissertation plot.
struct Observable {
    std::string body;              ///< "" for the last
    std::string component = "rz";  ///< rx ry rz vx vy vz wx wy wz

    std::string name() const { return body + "." + component; }
};

struct Problem {
    std::string name;
    std::string what;                      ///< one line: what moves, and where its numbers come from
    std::string model;                     ///< the text of its model file
    std::string reference_name;            ///< what the truth is, for tables
    ReferenceSolution reference_solution;  ///< after dae::start() has been called on the description
    Observable observable;                 ///< what single-scalar figures show of it
};

/// All built-in problems, by name. n_pendulum stands for the family n_pendulum_N.
const std::vector<Problem>& problems();

/// The problem of that name: one of the list, or n_pendulum_N for any N from 1 to 100000. lie::InvalidInput
/// with the nearest name otherwise.
Problem problem(const std::string& name);

/// The same, or else a model file at that path, whose truth is kinematic analysis where nothing is free and
/// the index-1 equations of motion, integrated to 1e-13, otherwise.
Problem problem_or_file(const std::string& name_or_path);

/// Puts a problem into the list: the last line of its file.
bool register_problem(Problem problem);

}  // namespace hilda::studies
