// SPDX-License-Identifier: GPL-3.0-or-later
/// Ordinary differential equations: GSL's adaptive Runge-Kutta method of Prince and Dormand, 8(9), "rk8pd".

#pragma once

#include <Eigen/Core>

#include <functional>
#include <memory>

namespace hilda::reference {

using VectorRef = Eigen::Ref<Eigen::VectorXd>;
using ConstVectorRef = Eigen::Ref<const Eigen::VectorXd>;

/// Tolerance of the local error of each component in a step: absolute + relative |y_k|.
struct OdeTolerance {
    double relative = 1e-13, absolute = 1e-14;
};

/// Initial-value problem ẏ = f(t, y) of n unknowns, integrated with adaptive step size.
class Ode {
public:
    /// ydot = f(t, y). The function must set every component of ydot.
    using RightHandSide = std::function<void(double t, const ConstVectorRef& y, VectorRef ydot)>;
    /// Called after every accepted step with its end
    using Observer = std::function<void(double t, const ConstVectorRef& y)>;

    /// n is the number of unknowns. Throws lie::InvalidInput if n < 1 or a tolerance is not positive.
    Ode(int n, RightHandSide f, const OdeTolerance& tolerance = {});
    ~Ode();

    /// Integrates y from t to t_end ≥ t and sets t = t_end exactly.
    ///
    /// Throws lie::InvalidInput if t_end < t, lie::NonFinite if f is not finite, lie::NumericalFailure
    /// "ode_failed" if GSL fails, and rethrows exceptions of f. After an exception t and y are those of the
    /// last accepted step.
    void advance(double& t, VectorRef y, double t_end, const Observer& observer = {});

    long evaluations() const;  ///< number of evaluations of f

private:
    struct Gsl;
    std::unique_ptr<Gsl> gsl;
};

}  // namespace hilda::reference
