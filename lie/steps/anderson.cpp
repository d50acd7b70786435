// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/anderson.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace hilda::lie {

Anderson::Anderson(Eigen::Index unknowns, Eigen::Index measured)
    : unknowns(unknowns), measured(measured), change_z(unknowns, most), change_e(unknowns, most),
      z_before(unknowns), e_before(unknowns)
{}

void Anderson::resize(Eigen::Index size, Eigen::Index of_norm)
{
    unknowns = size, measured = of_norm;
    if (size > z_before.size()) {
        change_z.resize(size, most), change_e.resize(size, most);
        z_before.resize(size), e_before.resize(size);
    }
    start();
}

void Anderson::accelerate(const Eigen::Ref<const Eigen::VectorXd>& z, Eigen::Ref<Eigen::VectorXd> e)
{
    if (has_before) {
        change_z.col(next).head(unknowns) = z - z_before.head(unknowns);
        change_e.col(next).head(unknowns) = e - e_before.head(unknowns);
        const int stored = std::min(count + 1, most);
        for (int i = 0; i < stored; ++i)
            products(i, next) = products(next, i) =
                change_e.col(i).head(measured).dot(change_e.col(next).head(measured));
        next = (next + 1) % most;
        count = stored;
    }
    z_before.head(unknowns) = z, e_before.head(unknowns) = e, has_before = true;
    if (count == 0) return;
    using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, most, most>;
    using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, most, 1>;
    // Normal equations, with the columns scaled to the length 1.
    SmallVector length(count), right(count);
    Small product(count, count);
    for (int i = 0; i < count; ++i) {
        length[i] = std::sqrt(products(i, i));
        if (!(length[i] > 0)) return;
    }
    for (int i = 0; i < count; ++i) {
        right[i] = change_e.col(i).head(measured).dot(e.head(measured)) / length[i];
        for (int j = 0; j < count; ++j) product(i, j) = products(i, j) / (length[i] * length[j]);
    }
    const SmallVector gamma = product.colPivHouseholderQr().solve(right);
    if (!gamma.allFinite()) return;
    for (int i = 0; i < count; ++i)
        e -= gamma[i] / length[i] * (change_z.col(i) + change_e.col(i)).head(unknowns);
}

}  // namespace hilda::lie
