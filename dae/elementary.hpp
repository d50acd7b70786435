// SPDX-License-Identifier: GPL-3.0-or-later
/// The elementary functions of numbers that carry two derivatives, whatever these are by.

#pragma once

#include <cmath>

namespace hilda::dae {

/// A value f with derivatives to which chain(x, g, g', g'') applies the chain rule of second order for g(x)
template <class D>
concept Chained = requires(const D& x)
{
    x.f;
    chain(x, 0., 0., 0.);
};

template <Chained D>
D sin(const D& x)
{
    return chain(x, std::sin(x.f), std::cos(x.f), -std::sin(x.f));
}
template <Chained D>
D cos(const D& x)
{
    return chain(x, std::cos(x.f), -std::sin(x.f), -std::cos(x.f));
}
template <Chained D>
D sinh(const D& x)
{
    return chain(x, std::sinh(x.f), std::cosh(x.f), std::sinh(x.f));
}
template <Chained D>
D cosh(const D& x)
{
    return chain(x, std::cosh(x.f), std::sinh(x.f), std::cosh(x.f));
}
template <Chained D>
D log(const D& x)
{
    return chain(x, std::log(x.f), 1 / x.f, -1 / (x.f * x.f));
}

template <Chained D>
D exp(const D& x)
{
    const double g = std::exp(x.f);
    return chain(x, g, g, g);
}

template <Chained D>
D sqrt(const D& x)
{
    const double g = std::sqrt(x.f);
    return chain(x, g, 0.5 / g, -0.25 / (x.f * g));
}

template <Chained D>
D tan(const D& x)
{
    const double g = std::tan(x.f), g1 = 1 + g * g;
    return chain(x, g, g1, 2 * g * g1);
}

template <Chained D>
D tanh(const D& x)
{
    // 1/cosh² and not 1 - tanh², which loses all digits for large x
    const double g = std::tanh(x.f), g1 = 1 / (std::cosh(x.f) * std::cosh(x.f));
    return chain(x, g, g1, -2 * g * g1);
}

template <Chained D>
D asin(const D& x)
{
    const double w = (1 - x.f) * (1 + x.f), g1 = 1 / std::sqrt(w);
    return chain(x, std::asin(x.f), g1, x.f * g1 / w);
}

template <Chained D>
D acos(const D& x)
{
    const double w = (1 - x.f) * (1 + x.f), g1 = -1 / std::sqrt(w);
    return chain(x, std::acos(x.f), g1, x.f * g1 / w);
}

template <Chained D>
D atan(const D& x)
{
    const double g1 = 1 / (1 + x.f * x.f);
    return chain(x, std::atan(x.f), g1, -2 * x.f * g1 * g1);
}

template <Chained D>
D pow(const D& x, double p)
{
    // where p or p - 1 is 0, so is the derivative, and 0 times infinity shall not make it otherwise
    const double g1 = p == 0 ? 0 : p * std::pow(x.f, p - 1);
    const double g2 = p == 0 || p == 1 ? 0 : p * (p - 1) * std::pow(x.f, p - 2);
    return chain(x, std::pow(x.f, p), g1, g2);
}

}  // namespace hilda::dae
