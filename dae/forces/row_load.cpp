// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/forces/row_load.hpp"

namespace hilda::dae {

void RowLoad::add_to(double f, double by_q, double by_qdot, const Vec12& v, Force::LoadDerivatives& out) const
{
    const Vec12 gradient = by_q * g + by_qdot * (W.transpose() * v);
    out.leftCols<12>() -= w * gradient.transpose() + f * W;
    out.rightCols<12>() -= by_qdot * w * w.transpose();
}

Vec12 velocities(const Motion& bi, const Motion& bj)
{
    Vec12 v;
    v << bi.rdot, bi.omega_bar, bj.rdot, bj.omega_bar;
    return v;
}

RowLoad distance_row(const Motion& bi, const Vec3& s_bar_i, const Motion& bj, const Vec3& s_bar_j)
{
    const Mat3 skew_i = lie::tilde(s_bar_i), skew_j = lie::tilde(s_bar_j);
    const Vec3 d = bj.r + bj.A * s_bar_j - bi.r - bi.A * s_bar_i;
    const double l = d.norm();
    const Vec3 e = d / l, e_i = bi.A.transpose() * e, e_j = bj.A.transpose() * e;
    RowLoad row;
    row.w << -e, -s_bar_i.cross(e_i), e, s_bar_j.cross(e_j);
    row.g = row.w;
    // δe = (I - e eᵀ)/l δd
    Eigen::Matrix<double, 3, 12> of_e;
    of_e << -Mat3::Identity(), bi.A * skew_i, Mat3::Identity(), -bj.A * skew_j;
    of_e = ((Mat3::Identity() - e * e.transpose()) / l * of_e).eval();
    row.W.topRows<3>() = -of_e;
    row.W.middleRows<3>(3) = -skew_i * (bi.A.transpose() * of_e);
    row.W.middleRows<3>(6) = of_e;
    row.W.bottomRows<3>() = skew_j * (bj.A.transpose() * of_e);
    // δ(Aᵀ e) = (Aᵀ e)~ δθ̄ + Aᵀ δe
    row.W.block<3, 3>(3, 3) -= skew_i * lie::tilde(e_i);
    row.W.block<3, 3>(9, 9) += skew_j * lie::tilde(e_j);
    return row;
}

}  // namespace hilda::dae
