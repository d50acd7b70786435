// SPDX-License-Identifier: GPL-3.0-or-later
/// Derivatives by central differences of fourth order, for what a formula is checked against.

#pragma once

namespace hilda::tests {

/// f'(0), of a scalar, a vector or a matrix; error h⁴ f⁽⁵⁾/30 + 2ε|f|/h, about 1e-12 for functions near one.
template <class F>
auto derivative(const F& f, double h = 2e-3)
{
    using Value = decltype(f(h));
    const Value a = f(-2 * h), b = f(-h), c = f(h), d = f(2 * h);
    return Value(((a - d) + 8 * (c - b)) / (12 * h));
}

/// f''(0); error h⁴ f⁽⁶⁾/90 + 6ε|f|/h², about 1e-10 for functions near one.
template <class F>
auto second_derivative(const F& f, double h = 4e-3)
{
    using Value = decltype(f(h));
    const Value a = f(-2 * h), b = f(-h), m = f(0), c = f(h), d = f(2 * h);
    return Value((16 * (b + c) - (a + d) - 30 * m) / (12 * h * h));
}

}  // namespace hilda::tests
