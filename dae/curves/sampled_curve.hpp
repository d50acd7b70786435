// SPDX-License-Identifier: GPL-3.0-or-later
/// A function of time given by samples, for prescribed motions.

#pragma once

#include "io/arithmetic/jet.hpp"

#include <Eigen/Core>
#include <unsupported/Eigen/Splines>

#include <cstddef>
#include <span>
#include <vector>

namespace hilda::dae {

/// The quintic spline through the samples (t_k, f_k), with four continuous derivatives. Its knots are
/// averages of the t_k (de Boor 1978, Ch. XIII). For a smooth function sampled at the distance dt, the errors
/// of f, ḟ and f̈ are of the orders dt⁶, dt⁵ and dt⁴.
class SampledCurve {
public:
    static constexpr int degree = 5;
    static constexpr std::size_t least = degree + 1;  ///< number of samples

    /// t ascending [s]. Throws lie::InvalidInput with fewer than six samples, or if t is not ascending or a
    /// number is not finite; the message has the number of the sample, from 0.
    SampledCurve(std::vector<double> t, std::span<const double> f);

    /// Value and derivatives. A time before the first or after the last sample by at most the distance of
    /// two samples continues the polynomial there, since schemes evaluate beyond the end of a step. Throws
    /// lie::NumericalFailure "motion_ended" for other times.
    io::Jet jet(double time) const;

    /// The first knot after a time [s]; infinite behind the last one. The knots are about as dense as the
    /// samples, and the spline is a polynomial of degree 5 between them.
    double next_knot(double time) const;

    double largest() const { return spline.ctrls().cwiseAbs().maxCoeff(); }  ///< bound of the magnitude

    double first() const { return begin; }  ///< [s]
    double last() const { return end; }     ///< [s]

private:
    using Spline = Eigen::Spline<double, 1, degree>;

    double begin, end, margin;
    Spline spline;  ///< over (t - begin)/(end - begin)
};

}  // namespace hilda::dae
