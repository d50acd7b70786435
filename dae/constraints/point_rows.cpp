// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/constraints/point_rows.hpp"

namespace hilda::dae {

PointRows::PointRows(const PointRow& row, int first, int entry)
    : first(first), rows(1), entry(entry), i(row.i), j(row.j), s_bar_i(row.s_bar_i),
      s_bar_j(row.s_bar_j), axis{row.axis}, c{row.c}, f{row.f}
{}

bool PointRows::add(const PointRow& row, int number)
{
    if (rows == 3 || number != first + rows || row.i != i || row.j != j || row.s_bar_i != s_bar_i ||
        row.s_bar_j != s_bar_j)
        return false;
    axis[rows] = row.axis, c[rows] = row.c, f[rows] = row.f;
    ++rows;
    return true;
}

void PointRows::phi(const State& x, double* out) const
{
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    const Vec3 d = bj.r - bi.r, s_i = bi.A * s_bar_i, s_j = bj.A * s_bar_j;
    for (int k = 0; k < rows; ++k) out[k] = c[k] * (d[axis[k]] + s_j[axis[k]] - s_i[axis[k]]) - f[k];
}

void PointRows::variation(const State& x, lie::Rows::Entry* out) const
{
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    for (int k = 0; k < rows; ++k) {
        const Vec3 e = c[k] * Vec3::Unit(axis[k]);
        if (i != ground) {
            const Vec3 in_body = c[k] * bi.A.row(axis[k]).transpose();
            out->r = -e, out->pi = in_body.cross(s_bar_i), ++out;
        }
        if (j != ground) {
            const Vec3 in_body = c[k] * bj.A.row(axis[k]).transpose();
            out->r = e, out->pi = s_bar_j.cross(in_body), ++out;
        }
    }
}

void PointRows::gamma(const State& x, double* out) const
{
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    const auto centripetal = [](const Motion& body, const Vec3& s_bar) -> Vec3 {
        return body.A * body.omega_bar.cross(body.omega_bar.cross(s_bar));
    };
    const Vec3 of_i = centripetal(bi, s_bar_i), of_j = centripetal(bj, s_bar_j);
    for (int k = 0; k < rows; ++k) out[k] = -c[k] * (of_j[axis[k]] - of_i[axis[k]]);
}

}  // namespace hilda::dae
