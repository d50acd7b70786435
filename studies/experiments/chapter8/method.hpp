// SPDX-License-Identifier: GPL-3.0-or-later
/// Common interface of the contact methods: evolving contact constraints, rigid contacts as a differential
/// variational inequality (DVI) and springs (DEM).

#pragma once

#include "contact/evolving/unilateral.hpp"
#include "lie/solver/linear_solver.hpp"
#include "studies/experiments/chapter8/contact_scenes.hpp"

#include <functional>

namespace hilda::studies::methods {

/// A scene being integrated by one contact method
struct Method {
    std::function<void(double h)> step;
    /// Body b of the scene at the current node, with the velocities that the method stores
    std::function<const lie::Motion&(int b)> body;
    std::function<int()> contacts;  ///< number of active contacts in the last step
    /// Accumulated iterations: of Newton's method or of the methods for rigid contacts; for springs the
    /// number of steps
    std::function<long()> iterations;
    /// Number of contact events (closing, impact, lift-off, switch to the fallback), for methods that locate
    /// them
    std::function<int()> events = [] { return 0; };
};

/// Options of evolving contact constraints
struct EvolvingOptions {
    std::string scheme = "rA-half-1-momentum";
    lie::LinearSolver solver = lie::LinearSolver::automatic;
    double tolerance = 1e-12;  ///< of Newton's method
    double reach = 0;          ///< pairs with a smaller gap at the start are contacts [m]
    bool unilateral = false;   ///< unilateral contacts with restitution 0
};
/// Frictionless evolving contacts of the bodies of a ModelScene. InvalidInput for a scene with friction.
Method evolving(const ContactScene& setup, const EvolvingOptions& options);

/// Rigid contacts with Coulomb's law and rA-moreau-1, of the bodies of a ModelScene
Method dvi(const ContactScene& setup);

/// Contact springs; the bodies start exactly as in the scene
Method compliant_springs(const ContactScene& setup, const Compliance& options);

}  // namespace hilda::studies::methods
