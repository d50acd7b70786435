// SPDX-License-Identifier: GPL-3.0-or-later
/// One scene by three ways to treat contact: constraints whose contact points evolve, a differential variational
/// inequality, springs.

#pragma once

#include "contact/evolving/unilateral.hpp"
#include "studies/experiments/chapter8/contact_scenes.hpp"

namespace hilda::studies::methods {

/// A scene under way
class Method {
public:
    virtual ~Method() = default;
    virtual void step(double h) = 0;
    /// Body b of the scene, at the node; velocities are those the method stores
    virtual const lie::Motion& body(int b) const = 0;
    virtual int contacts() const = 0;  ///< that touched in the last step
    /// Iterations so far: of Newton's method, of the cone solver; of springs the steps
    virtual long iterations() const = 0;
    virtual int events() const { return 0; }  ///< contacts that came or went, where each is an event
};

/// Contact by constraints
struct Evolving {
    std::string scheme = "rA-half-1-momentum";
    lie::LinearSolver solver = lie::LinearSolver::automatic;
    double tolerance = 1e-12;  ///< of Newton's method
    double reach = 0;          ///< pairs that are nearer than this at the start are contacts [m]
    bool unilateral = false;        ///< whether contacts come and go, without rebound
};
/// Without friction. Bodies without a finite mass are the ground; InvalidInput where one of those moves, and for a scene
/// with friction.
std::unique_ptr<Method> evolving(const ContactScene& of, const Evolving& how);

/// As a differential variational inequality, stabilised or not, with this tolerance of impulses over masses [m/s]
struct Rigid {
    bool stabilised = true;
    bool half_kick = true;
    double tolerance = 1e-10;
    int most_iterations = 10000;
};
std::unique_ptr<Method> rigid(const ContactScene& of, const Rigid& how);

/// By springs, started from the scene as it is
std::unique_ptr<Method> springs(const ContactScene& of, const Compliance& how);

}  // namespace hilda::studies::methods
