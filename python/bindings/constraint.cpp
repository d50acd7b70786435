// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bindings/constraint.hpp"

#include "dae/start/differences.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hilda::python {

namespace {

using dae::after;
using dae::derivative;
using dae::RowValues;

constexpr double displacement =
    1.2e-5;                          // [m, rad], of poses; the result is extrapolated from it and its half
constexpr double first_step = 2e-3;  // [s, m or rad], the largest of differences along a motion

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

}  // namespace hilda::python
