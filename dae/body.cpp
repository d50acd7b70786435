// SPDX-License-Identifier: GPL-3.0-or-later
/// Validation of the mass properties of a body.
#include "dae/body.hpp"

#include "lie/check.hpp"

#include <Eigen/Eigenvalues>

namespace hilda::dae {

void Body::validate() const
{
    const std::string where = "body '" + name + "'";
    if (!(m > 0) || !std::isfinite(m)) lie::reject(where, "the mass must be positive and finite [kg]", m);
    if (!J_bar.allFinite()) lie::reject(where, "the inertia must be finite [kg m^2]", J_bar);
    const double size = J_bar.cwiseAbs().maxCoeff();
    if (!((J_bar - J_bar.transpose()).cwiseAbs().maxCoeff() <= 1e-12 * size))
        lie::reject(where, "the inertia must be symmetric; largest |J_kl - J_lk| [kg m^2]",
                    (J_bar - J_bar.transpose()).cwiseAbs().maxCoeff());
    const Vec3 principal = Eigen::SelfAdjointEigenSolver<Mat3>(J_bar, Eigen::EigenvaluesOnly).eigenvalues();
    if (!(principal[0] > 0))
        lie::reject(where, "the inertia must be positive definite; principal moments [kg m^2]",
                    principal.transpose());
    // The margin of 1e-9 admits a thin rod or plate whose moments are rounded to ten digits.
    if (!(principal[2] <= (principal[0] + principal[1]) * (1 + 1e-9)))
        lie::reject(where, "no principal moment of inertia may exceed the sum of the other two [kg m^2]",
                    principal.transpose());
}

}  // namespace hilda::dae
