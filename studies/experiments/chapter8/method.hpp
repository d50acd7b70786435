// SPDX-License-Identifier: GPL-3.0-or-later
/// Common interface of the contact methods: evolving contact constraints, a differential variational
/// inequality (DVI) and springs (DEM).

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
    /// Accumulated iterations: of Newton's method or of the cone solver; for springs the number of steps
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
/// Frictionless evolving contacts. Bodies without a finite mass are part of the ground. InvalidInput for a
/// moving body without a finite mass and for a scene with friction.
Method evolving(const ContactScene& setup, const EvolvingOptions& options);

/// Options of the differential variational inequality; the tolerance is on impulse over mass [m/s]
struct DviMethodOptions {
    bool stabilised = true;
    bool half_kick = true;
    double tolerance = 1e-10;
    int max_iterations = 10000;
};
Method dvi(const ContactScene& setup, const DviMethodOptions& options);

/// Contact springs; the bodies start exactly as in the scene
Method compliant_springs(const ContactScene& setup, const Compliance& options);

}  // namespace hilda::studies::methods
