// SPDX-License-Identifier: GPL-3.0-or-later
/// Comparison of the derivatives that constraints and forces compute with differences.

#pragma once

#include "lie/state.hpp"

#include <map>
#include <string>
#include <typeindex>
#include <vector>

namespace hilda::dae {

class Model;

/// The functions that contradict differences. Of each class the first twenty objects are compared.
class DerivativeFindings {
public:
    /// Whether the next object of this class is compared
    bool is_next(const std::type_info& type) { return ++compared[type] <= of_each_class; }
    void add(std::string text) { lines.push_back(std::move(text)); }

    std::vector<std::string> lines;

private:
    static constexpr int of_each_class = 20;
    std::map<std::type_index, int> compared;
};

/// Compares, for the constraints and forces of a model, the functions that follow from another one:
///
///     Φ_r, Π̄   with differences of Φ               (position rows)
///     ν        with -∂Φ/∂t                        (position rows)
///     γ        with -d(C v - ν)/dt along the motion with constant ṙ and ω̄
///     second variations of blocks with differences of Φ_r, Π̄, ν, γ
///     load_derivatives() with differences of add()
///
/// A wrong one of them gives a wrong motion, or slow Newton iterations, without an error: a wrong γ is a
/// wrong acceleration for the schemes that use accelerations and no error for the others. They are compared
/// at x with velocities of the order of 1 added. Constraints with algebraic variables are left out, and
/// functions where differences are not accurate. The parts of forces and contacts, such as surfaces and laws,
/// are compared by their check_derivatives().
///
/// Returns one line for each wrong function, such as "constraint 'rod': gamma of row 1 is 0.2, by differences
/// -0.2".
std::vector<std::string> wrong_derivatives(const Model& model, const lie::State& x);

}  // namespace hilda::dae
