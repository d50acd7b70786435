// SPDX-License-Identifier: GPL-3.0-or-later
/// Elementary functions of types that hold a value with its first and second derivatives.
///
/// The type decides by what is differentiated: Jet by time, other types by several variables.

#pragma once

#include <cmath>

namespace hilda::io {

/// A type with a value f, and with a function chain(x, g, g', g'') that returns g(x) and its derivatives by
/// the chain rule
template <class D>
concept TwiceDifferentiable = requires(const D& x)
{
    x.f;
    chain(x, 0., 0., 0.);
};

template <TwiceDifferentiable D>
D sin(const D& x)
{
    return chain(x, std::sin(x.f), std::cos(x.f), -std::sin(x.f));
}
template <TwiceDifferentiable D>
D cos(const D& x)
{
    return chain(x, std::cos(x.f), -std::sin(x.f), -std::cos(x.f));
}
template <TwiceDifferentiable D>
D sinh(const D& x)
{
    return chain(x, std::sinh(x.f), std::cosh(x.f), std::sinh(x.f));
}
template <TwiceDifferentiable D>
D cosh(const D& x)
{
    return chain(x, std::cosh(x.f), std::sinh(x.f), std::cosh(x.f));
}
template <TwiceDifferentiable D>
D log(const D& x)
{
    return chain(x, std::log(x.f), 1 / x.f, -1 / (x.f * x.f));
}

template <TwiceDifferentiable D>
D exp(const D& x)
{
    const double g = std::exp(x.f);
    return chain(x, g, g, g);
}

template <TwiceDifferentiable D>
D sqrt(const D& x)
{
    const double g = std::sqrt(x.f);
    return chain(x, g, 0.5 / g, -0.25 / (x.f * g));
}

template <TwiceDifferentiable D>
D tan(const D& x)
{
    const double g = std::tan(x.f), g1 = 1 + g * g;
    return chain(x, g, g1, 2 * g * g1);
}

template <TwiceDifferentiable D>
D tanh(const D& x)
{
    // 1/cosh² instead of 1 - tanh²: the difference loses all digits for large x.
    const double g = std::tanh(x.f), g1 = 1 / (std::cosh(x.f) * std::cosh(x.f));
    return chain(x, g, g1, -2 * g * g1);
}

template <TwiceDifferentiable D>
D asin(const D& x)
{
    const double w = (1 - x.f) * (1 + x.f), g1 = 1 / std::sqrt(w);
    return chain(x, std::asin(x.f), g1, x.f * g1 / w);
}

template <TwiceDifferentiable D>
D acos(const D& x)
{
    const double w = (1 - x.f) * (1 + x.f), g1 = -1 / std::sqrt(w);
    return chain(x, std::acos(x.f), g1, x.f * g1 / w);
}

template <TwiceDifferentiable D>
D atan(const D& x)
{
    const double g1 = 1 / (1 + x.f * x.f);
    return chain(x, std::atan(x.f), g1, -2 * x.f * g1 * g1);
}

template <TwiceDifferentiable D>
D pow(const D& x, double p)
{
    // The factors p and p - 1 may be zero. The derivative is then zero, also at x = 0 where the power is
    // infinite.
    const double g1 = p == 0 ? 0 : p * std::pow(x.f, p - 1);
    const double g2 = p == 0 || p == 1 ? 0 : p * (p - 1) * std::pow(x.f, p - 2);
    return chain(x, std::pow(x.f, p), g1, g2);
}

}  // namespace hilda::io
