// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bindings/constraint.hpp"

#include "lie/so3.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hilda::python {

namespace {

constexpr double first = 6e-6;   // of a first difference of second order: h² and 1e-16/h
constexpr double second = 2e-3;  // of a second difference of fourth order: h⁴ and 1e-16/h²

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
        (c < 6 ? out.C_i : out.C_j).col(c % 6) = (displaced(first) - displaced(-first)) / (2 * first);
    }
}

void PythonConstraint::nu(const Arguments& x, double* out) const
{
    if (has(nu_)) return call(nu_, "nu", x, out);
    const double h = first * std::max(1., std::abs(x.t));
    const double before = x.t - h, later = x.t + h;
    Eigen::Map<Eigen::VectorXd>(out, rows) =
        (phi_at({x.bi, x.bj, before}, 0) - phi_at({x.bi, x.bj, later}, 0)) / (later - before);
}

/// Φ after a time s with constant velocities
PythonConstraint::Rows PythonConstraint::phi_at(const Arguments& x, double s) const
{
    Rows all(rows);
    if (s == 0) return phi(x, all.data()), all;
    const lie::Motion bi = after(x.bi, s), bj = after(x.bj, s);
    phi({bi, bj, x.t + s}, all.data());
    return all;
}

/// dΦ/ds = C v - ν after a time s with constant velocities
PythonConstraint::Rows PythonConstraint::rate_at(const Arguments& x, double s) const
{
    const lie::Motion bi = after(x.bi, s), bj = after(x.bj, s);
    const Arguments at{bi, bj, x.t + s};
    Derivatives d;
    d.set_zero(*this);
    variation(at, d);
    Rows of_time(rows);
    nu(at, of_time.data());
    Eigen::Matrix<double, 6, 1> v_i, v_j;
    v_i << bi.rdot, bi.omega_bar;
    v_j << bj.rdot, bj.omega_bar;
    return d.C_i * v_i + d.C_j * v_j - of_time;
}

void PythonConstraint::gamma(const Arguments& x, double* out) const
{
    if (has(gamma_)) return call(gamma_, "gamma", x, out);
    Eigen::Map<Eigen::VectorXd> to(out, rows);
    const double h = second / std::max({1., rate(x.bi), rate(x.bj)});
    if (has(variation_)) {
        to = -(8 * (rate_at(x, h) - rate_at(x, -h)) - (rate_at(x, 2 * h) - rate_at(x, -2 * h))) / (12 * h);
        return;
    }
    to = -(16 * (phi_at(x, h) + phi_at(x, -h)) - (phi_at(x, 2 * h) + phi_at(x, -2 * h)) - 30 * phi_at(x, 0)) /
         (12 * h * h);
}

}  // namespace hilda::python
