// SPDX-License-Identifier: GPL-3.0-or-later
/// Acceleration of Newton's method with a frozen matrix.

#pragma once

#include <Eigen/Core>

namespace hilda::lie {

/// Anderson (1965), J. ACM 12, 547-560, for the iteration z ← z + e(z):
///
///     z ← z + e - (ΔZ + ΔE) γ,     γ = argmin |e - ΔE γ|
///
/// The columns of ΔZ and ΔE are the changes of z and e in up to eight earlier corrections. For a linear e
/// this is GMRES, so that it converges where the iteration itself does not contract because the matrix
/// belongs to another state. The functions do not allocate memory.
class Anderson {
public:
    /// `unknowns`: size of z; `measured`: how many of them, from the first one on, are in the norm |.|
    Anderson(Eigen::Index unknowns, Eigen::Index measured);

    /// Sets the sizes, and forgets the earlier corrections. It allocates if there are more unknowns than ever
    /// before.
    void resize(Eigen::Index unknowns, Eigen::Index measured);
    /// Forgets the earlier corrections.
    void start() { count = next = 0, has_before = false; }
    /// Replaces the correction e of the iterate z by the accelerated one.
    void accelerate(const Eigen::Ref<const Eigen::VectorXd>& z, Eigen::Ref<Eigen::VectorXd> e);

private:
    static constexpr int most = 8;

    Eigen::Index unknowns, measured;
    Eigen::MatrixXd change_z, change_e;
    Eigen::Matrix<double, most, most> products;  ///< scalar products of the columns of ΔE
    Eigen::VectorXd z_before, e_before;
    int count = 0, next = 0;
    bool has_before = false;
};

}  // namespace hilda::lie
