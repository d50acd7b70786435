// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bindings/constraint.hpp"

#include "lie/check.hpp"
#include "lie/so3.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace hilda::python {

namespace {

constexpr double displacement =
    1.2e-5;                          // [m, rad], of poses; the result is extrapolated from it and its half
constexpr double first_step = 2e-3;  // [s, m or rad], the largest of differences along a motion

using RowValues = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, dae::Constraint::max_position_rows, 1>;

/// The first or second derivative of f at 0, by differences of fourth order. The step begins with h and is
/// halved while that reduces the difference of two results, which is the estimate of the error: the motion
/// may be curved within a much smaller length than h.
///
/// Throws lie::NumericalFailure "differences" if the estimate exceeds `most` relative to the derivative.
template <class Function>
RowValues derivative(const Function& f, int order, double h, const std::string& what)
{
    constexpr int halvings = 14;
    constexpr double enough = 1e-11, most = 1e-5, least = 1e-7;
    const RowValues zero = order == 2 ? RowValues(f(0)) : RowValues();
    RowValues far_plus = f(2 * h), far_minus = f(-2 * h), best;
    double error = std::numeric_limits<double>::infinity(), size = 0;
    RowValues before;
    for (int k = 0; k < halvings; ++k, h *= 0.5) {
        const RowValues plus = f(h), minus = f(-h);
        RowValues now =
            order == 1 ? RowValues((8 * (plus - minus) - (far_plus - far_minus)) / (12 * h))
                       : RowValues((16 * (plus + minus) - (far_plus + far_minus) - 30 * zero) / (12 * h * h));
        far_plus = plus, far_minus = minus;
        if (k > 0) {
            const double change = (now - before).template lpNorm<Eigen::Infinity>();
            if (change >= error && error <= most * size + least) break;  // rounding errors
            if (change < error) {
                error = change, best = now;
                size = now.template lpNorm<Eigen::Infinity>();
            }
            if (error <= enough * size) break;
        }
        before = std::move(now);
    }
    if (!(error <= most * size + least))
        throw lie::NumericalFailure(
            "differences",
            fmt::format("{} by differences has an error of {:.1e}; give the function", what, error));
    return best;
}

/// The motion after a time s with constant velocities
lie::Motion after(const lie::Motion& from, double s)
{
    lie::Motion to = from;
    to.r += s * from.rdot;
    to.A = from.A * lie::exp(s * from.omega_bar);
    return to;
}

double rate(const lie::Motion& of) { return std::max(of.rdot.norm(), of.omega_bar.norm()); }

}  // namespace

PythonConstraint::PythonConstraint(int i, int j, int rows, Functions of)
    : Constraint(i, j),
      ModelFunctions({std::move(of.phi), std::move(of.variation), std::move(of.nu), std::move(of.gamma)}),
      rows(rows)
{
    for (int k = 0; k < 4; ++k) is_none[k] = functions[static_cast<size_t>(k)].is_none();
}

void PythonConstraint::call(Which which, const char* what, const Arguments& x, double* out) const
{
    call_python([&] { return fmt::format("{} of {} at t = {} s", what, label(), x.t); },
                [&] {
                    lie::State two;
                    two.t = x.t;
                    two.body = {x.bi, x.bj};
                    const StatePool::Lent lent(pool, two);
                    const py::object result = functions[which](lent.object());
                    if (which != variation_) return read_array(result, what, rows, 0, out);
                    if (!py::isinstance<py::tuple>(result) || py::len(result) != 2)
                        throw py::type_error("variation must return a tuple (C_i, C_j)");
                    const auto both = py::reinterpret_borrow<py::tuple>(result);
                    read_array(both[0], "C_i", rows, 6, out);
                    read_array(both[1], "C_j", rows, 6, out + 6 * rows);
                });
}

void PythonConstraint::phi(const Arguments& x, double* out) const { call(phi_, "phi", x, out); }

void PythonConstraint::variation(const Arguments& x, Derivatives& out) const
{
    if (has(variation_)) {
        double both[2 * 6 * max_position_rows];
        call(variation_, "variation", x, both);
        using Given = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>>;
        out.C_i = Given(both, rows, 6);
        out.C_j = Given(both + 6 * rows, rows, 6);
        return;
    }
    differences(x, out);
}

/// The derivatives of Φ by the poses
void PythonConstraint::differences(const Arguments& x, Derivatives& out) const
{
    for (int c = 0; c < 12; ++c) {
        const auto displaced = [&](double by) {
            lie::Motion bi = x.bi, bj = x.bj;
            lie::Motion& body = c < 6 ? bi : bj;
            if (c % 6 < 3)
                body.r[c % 3] += by;
            else
                body.A = body.A * lie::exp(by * lie::Vec3::Unit(c % 3));
            return phi_at({bi, bj, x.t}, 0);
        };
        const auto difference = [&](double d) { return RowValues((displaced(d) - displaced(-d)) / (2 * d)); };
        const RowValues fine = difference(0.5 * displacement), coarse = difference(displacement);
        (c < 6 ? out.C_i : out.C_j).col(c % 6) = (4 * fine - coarse) / 3;
    }
}

void PythonConstraint::nu(const Arguments& x, double* out) const
{
    if (has(nu_)) return call(nu_, "nu", x, out);
    Eigen::Map<Eigen::VectorXd>(out, rows) = nu_by_differences(x);
}

PythonConstraint::PositionRows PythonConstraint::nu_by_differences(const Arguments& x) const
{
    return -derivative(
        [&](double s) {
            return phi_at({x.bi, x.bj, x.t + s}, 0);
        },
        1, first_step, "nu of " + label());
}

/// Φ after a time s with constant velocities
PythonConstraint::PositionRows PythonConstraint::phi_at(const Arguments& x, double s) const
{
    PositionRows all(rows);
    if (s == 0) return phi(x, all.data()), all;
    const lie::Motion bi = after(x.bi, s), bj = after(x.bj, s);
    phi({bi, bj, x.t + s}, all.data());
    return all;
}

/// dΦ/ds = C v - ν after a time s with constant velocities
PythonConstraint::PositionRows PythonConstraint::rate_at(const Arguments& x, double s) const
{
    const lie::Motion bi = after(x.bi, s), bj = after(x.bj, s);
    const Arguments at{bi, bj, x.t + s};
    Derivatives d;
    d.set_zero(*this);
    variation(at, d);
    PositionRows of_time(rows);
    nu(at, of_time.data());
    Eigen::Matrix<double, 6, 1> v_i, v_j;
    v_i << bi.rdot, bi.omega_bar;
    v_j << bj.rdot, bj.omega_bar;
    return d.C_i * v_i + d.C_j * v_j - of_time;
}

void PythonConstraint::gamma(const Arguments& x, double* out) const
{
    if (has(gamma_)) return call(gamma_, "gamma", x, out);
    Eigen::Map<Eigen::VectorXd>(out, rows) = gamma_by_differences(x);
}

PythonConstraint::PositionRows PythonConstraint::gamma_by_differences(const Arguments& x) const
{
    const double h = first_step / std::max({1., rate(x.bi), rate(x.bj)});
    return has(variation_) ? -derivative([&](double s) { return rate_at(x, s); }, 1, h, "gamma of " + label())
                           : -derivative([&](double s) { return phi_at(x, s); }, 2, h, "gamma of " + label());
}

std::vector<std::string> PythonConstraint::check(const Arguments& start) const
{
    // Any velocities: gamma is zero at rest
    lie::Motion bi = start.bi, bj = start.bj;
    for (auto& [body, number] : {std::pair{&bi, i}, {&bj, j}})
        if (number != dae::ground) {
            body->rdot += lie::Vec3(0.31, -0.23, 0.47);
            body->omega_bar += lie::Vec3(-0.29, 0.53, 0.17);
        }
    const Arguments x{bi, bj, start.t};
    std::vector<std::string> found;
    const auto compare = [&](const char* what, const auto& given, const auto& difference) {
        constexpr double most = 1e-4;
        Eigen::Index row = 0, column = 0;
        const double largest = (given - difference).cwiseAbs().maxCoeff(&row, &column);
        if (largest > most * std::max(1., difference.cwiseAbs().maxCoeff()))
            found.push_back(fmt::format("{}: {} of row {} is {:.6g}, by differences {:.6g}{}", label(), what,
                                        row + 1, given(row, column), difference(row, column),
                                        given.cols() > 1 ? fmt::format(" (column {})", column + 1) : ""));
    };
    try {
        PositionRows value(rows);
        if (has(variation_)) {
            Derivatives given, difference;
            given.set_zero(*this), difference.set_zero(*this);
            variation(x, given), differences(x, difference);
            compare("C_i", given.C_i, difference.C_i);
            if (j != dae::ground) compare("C_j", given.C_j, difference.C_j);
        }
        if (has(nu_)) nu(x, value.data()), compare("nu", value, nu_by_differences(x));
        if (has(gamma_)) gamma(x, value.data()), compare("gamma", value, gamma_by_differences(x));
    } catch (const lie::NumericalFailure&) {  // there is nothing to compare with
    }
    return found;
}

}  // namespace hilda::python
