// SPDX-License-Identifier: GPL-3.0-or-later
/// Numerical derivatives by central differences of fourth order, for the verification of analytical
/// derivatives.

#pragma once

namespace hilda::tests {

/// f'(0) of a scalar, vector or matrix function f. The error is h⁴ f⁽⁵⁾/30 + 2ε|f|/h, about 1e-12 for
/// functions of order 1.
template <class F>
auto derivative(const F& f, double h = 2e-3)
{
    using Value = decltype(f(h));
    const Value a = f(-2 * h), b = f(-h), c = f(h), d = f(2 * h);
    return Value(((a - d) + 8 * (c - b)) / (12 * h));
}

/// f''(0). The error is h⁴ f⁽⁶⁾/90 + 6ε|f|/h², about 1e-10 for functions of order 1.
template <class F>
auto second_derivative(const F& f, double h = 4e-3)
{
    using Value = decltype(f(h));
    const Value a = f(-2 * h), b = f(-h), m = f(0), c = f(h), d = f(2 * h);
    return Value((16 * (b + c) - (a + d) - 30 * m) / (12 * h * h));
}

}  // namespace hilda::tests
