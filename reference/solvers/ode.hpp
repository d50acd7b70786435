// SPDX-License-Identifier: GPL-3.0-or-later
/// Ordinary differential equations to the last digits: GSL's Runge-Kutta Prince-Dormand 8(9), "rk8pd".

#pragma once

#include <Eigen/Core>

#include <functional>
#include <memory>

namespace hilda::reference {

using VectorRef = Eigen::Ref<Eigen::VectorXd>;
using ConstVectorRef = Eigen::Ref<const Eigen::VectorXd>;

/// What a step may add to the error of each component: absolute + relative |y_k|.
struct OdeTolerance {
    double relative = 1e-13, absolute = 1e-14;
};

/// ẏ = f(t, y), integrated by steps of adaptive size.
class Ode {
public:
    /// ydot = f(t, y), all of it written
    using RightSide = std::function<void(double t, const ConstVectorRef& y, VectorRef ydot)>;
    /// Told of every accepted step
    using Accepted = std::function<void(double t, const ConstVectorRef& y)>;

    /// n unknowns. InvalidInput for n < 1 and for tolerances that are not positive.
    Ode(int n, RightSide f, const OdeTolerance& tolerance = {});
    ~Ode();

    /// Takes y from t to t_end ≥ t, where it stops exactly, and sets t to t_end. Throws what f throws;
    /// lie::NonFinite when f is not finite; lie::NumericalFailure with the time when GSL gives up. t and y
    /// are then where it got to.
    void advance(double& t, VectorRef y, double t_end, const Accepted& accepted = {});

    long evaluations() const;  ///< of f, so far

private:
    struct Gsl;
    std::unique_ptr<Gsl> gsl;
};

}  // namespace hilda::reference
