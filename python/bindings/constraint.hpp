// SPDX-License-Identifier: GPL-3.0-or-later
/// Constraints that are functions in Python.

#pragma once

#include "dae/constraint.hpp"
#include "python/bindings/model_function.hpp"
#include "python/bindings/state.hpp"

namespace hilda::python {

/// Position rows Φ(r, A, t) = 0 of two bodies, computed by Python functions of a state with the two bodies.
///
/// phi returns Φ, shape (rows,). The other functions may be None:
///
///     variation   (C_i, C_j), shapes (rows, 6): ∂Φ/∂(r, θ) of body i and of body j, with δA = A δθ~
///     nu          -∂Φ/∂t, shape (rows,)
///     gamma       γ = C v̇ of Φ̈ = 0, shape (rows,)
///
/// They are then differences of fourth order: those of poses with steps of about 1e-5, which resolves lengths
/// of a millimetre and more with an error of 1e-9; ν in time; and γ = -d²Φ/ds² along the motion with the
/// present velocities, or with `variation` the first derivative of C v - ν. The steps of the last two are
/// reduced until the error is least. lie::NumericalFailure "differences" if its estimate is above 1e-5 of the
/// result.
class PythonConstraint final : public dae::Constraint, public ModelFunctions {
public:
    struct Functions {
        py::object phi, variation, nu, gamma;
    };
    PythonConstraint(int i, int j, int rows, Functions functions);

    Size size() const override { return {.position_rows = rows}; }
    void phi(const Arguments& x, double* out) const override;
    void variation(const Arguments& x, Derivatives& out) const override;
    void nu(const Arguments& x, double* out) const override;
    void gamma(const Arguments& x, double* out) const override;

private:
    enum Which { phi_, variation_, nu_, gamma_ };
    using PositionRows = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_position_rows, 1>;
    struct Place;

    bool has(Which which) const { return !is_none[which]; }
    void call(Which which, const char* what, const Arguments& x, double* out) const;
    PositionRows phi_at(const Arguments& x, double s) const;
    PositionRows rate_at(const Arguments& x, double s) const;
    void differences(const Arguments& x, Derivatives& out) const;
    PositionRows nu_by_differences(const Arguments& x) const;
    PositionRows gamma_by_differences(const Arguments& x) const;

    const int rows;
    bool is_none[4];
    mutable StatePool pool;
};

}  // namespace hilda::python
