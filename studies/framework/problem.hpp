// SPDX-License-Identifier: GPL-3.0-or-later
/// Built-in models: the text of a model file with a reference solution.

#pragma once

#include "io/registry.hpp"
#include "lie/trajectory.hpp"

#include <functional>
#include <string>
#include <vector>

namespace hilda::dae {
struct Description;
}

namespace hilda::studies {

/// Computes the reference solution at these times [s], ascending, the first >= 0. The states are complete,
/// with accelerations and multipliers.
using ReferenceSolution =
    std::function<lie::Trajectory(dae::Description&, const std::vector<double>& instants)>;

/// A scalar of one body, for example the height of bar 2, as plotted in the figures of the dissertation
struct Observable {
    std::string body;              ///< name; "": the last body
    std::string component = "rz";  ///< rx ry rz vx vy vz wx wy wz

    std::string name() const { return body + "." + component; }
};

/// A built-in model
struct Problem {
    std::string name;
    std::string what;                 ///< one line: description and source of the data
    std::string model;                ///< text of the model file
    std::string reference_name = {};  ///< description of the reference solution, for tables
    /// To be called after dae::start(). Empty: that of a model file, see problem_or_file().
    ReferenceSolution reference_solution = {};
    Observable observable = {};      ///< scalar shown in figures
    std::string file = {};           ///< path of the model file, for messages; "": a built-in model
    std::string folder = {};         ///< of the files that the model names
    bool general_reference = false;  ///< reference_solution is that of a model file
};

/// Problems NAME_N of N equal parts
struct ProblemFamily {
    std::string name;
    int most = 1;  ///< largest N
    Problem (*member)(int N, const std::string& name) = nullptr;
};

}  // namespace hilda::studies

extern template class hilda::io::Registry<hilda::studies::Problem>;

namespace hilda::studies {

/// All built-in problems, sorted by name; a file adds one by io::Registry<Problem>::add. A family has one
/// member in this list, with the name of the family.
inline const std::vector<Problem>& problems() { return io::Registry<Problem>::all(); }

/// The problem with this name: one of the list, or a member of a family. lie::InvalidInput with the nearest
/// name otherwise.
Problem problem(const std::string& name);

/// The problem with this name, or the model file at this path. The reference solution of a model file is
/// kinematic analysis if it has no degree of freedom, and the index-1 equations of motion, integrated with
/// tolerance 1e-13, otherwise. It does not cover models with internal states: Reference selects an integrator
/// for these.
Problem problem_or_file(const std::string& name_or_path);

}  // namespace hilda::studies
