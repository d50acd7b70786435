// SPDX-License-Identifier: GPL-3.0-or-later
/// The mass with which a body of a mechanism reacts to a force.

#pragma once

#include "lie/solver/saddle.hpp"

namespace hilda::lie {
class System;
}

namespace hilda::run {

/// The smallest mass that a force at the centre of mass of a body accelerates, over all directions [kg]:
///
///     1/λ_max(Y),     r̈ = Y F     from the saddle system with the force F alone
///
/// It is the mass of a free body, and infinite if the constraints and drivers prescribe the motion of the
/// centre. A force beside the centre of mass also turns the body and accelerates a smaller mass.
class EffectiveMass {
public:
    /// Analyses the saddle matrix. The system must outlive the object.
    explicit EffectiveMass(const lie::System& system);

    /// The effective mass of a body in the state x. Throws lie::SingularMatrix.
    double operator()(const lie::State& x, int body);

private:
    const lie::System& system;
    lie::Saddle K;
    Eigen::VectorXd z;
};

}  // namespace hilda::run
