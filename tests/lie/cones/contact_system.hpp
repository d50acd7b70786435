// SPDX-License-Identifier: GPL-3.0-or-later
/// Bodies with vertices and spheres that touch planes and each other: a minimal lie::System with rigid
/// contacts, without models or detection.
#pragma once

#include "lie/system.hpp"

#include <cmath>
#include <functional>
#include <vector>

namespace hilda::tests {

using lie::Mat3;
using lie::Vec3;

class ContactSystem : public lie::System {
public:
    /// A vertex of body i against the plane n · (point - r_j) = d of body j, with n in the frame of
    /// j. j = -1:
    /// the ground, with its origin in the place of r_j
    struct VertexPlane {
        int i, j;
        Vec3 s_bar, n_bar;
        double d, mu, restitution;
    };
    /// Two spheres with the sum of radii R
    struct Spheres {
        int i, j;
        double R_i, R_j, mu, restitution;
    };
    /// The points s_bar_i and s_bar_j coincide in the directions `e` (global). j = -1: the ground
    struct Pin {
        int i, j;
        Vec3 s_bar_i, s_bar_j, e;
    };
    /// a · A b = 0 for a body
    struct Perpendicular {
        int i;
        Vec3 a, b_bar;
    };

    Vec3 gravity = {0, 0, -9.81};
    lie::Mass inertia;
    lie::State initial;
    std::vector<VertexPlane> vertices;
    std::vector<Spheres> spheres;
    std::vector<Pin> pins;
    std::vector<Perpendicular> perpendicular;
    double mu_k_by_mu_s = 1;
    double size = 0.1;

    int add_body(double m, const Vec3& J, const Vec3& r, const Mat3& A = Mat3::Identity())
    {
        inertia.m.push_back(m);
        inertia.J_bar.push_back(J.asDiagonal());
        initial.body.push_back({.r = r, .A = A});
        return static_cast<int>(inertia.m.size()) - 1;
    }
    int add_box(double m, const Vec3& half, const Vec3& r, const Mat3& A = Mat3::Identity())
    {
        const Vec3 s = half.cwiseAbs2();
        return add_body(m, m / 3 * Vec3(s[1] + s[2], s[0] + s[2], s[0] + s[1]), r, A);
    }
    int add_sphere(double m, double R, const Vec3& r)
    {
        return add_body(m, 0.4 * m * R * R * Vec3::Ones(), r);
    }
    /// The lower corners of a box against a plane with the normal z
    void put_on(int i, const Vec3& half, int j, double d, double mu, double restitution = 0)
    {
        for (const double a : {-1., 1.})
            for (const double b : {-1., 1.})
                vertices.push_back(
                    {i, j, Vec3(a, b, -1).cwiseProduct(half), Vec3::UnitZ(), d, mu, restitution});
    }
    /// Called after all bodies and rows have been added
    const lie::State& start()
    {
        for (const Pin& pin : pins) {
            rows_pattern.entry.push_back({.body = pin.i});
            if (pin.j >= 0) rows_pattern.entry.push_back({.body = pin.j});
            rows_pattern.start.push_back(static_cast<int>(rows_pattern.entry.size()));
        }
        for (const Perpendicular& row : perpendicular) {
            rows_pattern.entry.push_back({.body = row.i});
            rows_pattern.start.push_back(static_cast<int>(rows_pattern.entry.size()));
        }
        initial.lambda.setZero(rows_pattern.rows());
        return initial;
    }

    const lie::Mass& mass() const override { return inertia; }
    const lie::Rows& pattern() const override { return rows_pattern; }
    bool has_cones() const override { return !vertices.empty() || !spheres.empty(); }
    std::string cone_name(std::uint64_t key) const override { return "contact " + std::to_string(key); }
    void loads(const lie::State&, lie::Loads& out) const override
    {
        for (size_t b = 0; b < inertia.m.size(); ++b)
            out.F[b] = inertia.m[b] * gravity, out.n_bar[b].setZero();
    }
    double potential_energy(const lie::State& x) const override
    {
        double sum = 0;
        for (size_t b = 0; b < inertia.m.size(); ++b) sum -= inertia.m[b] * gravity.dot(x.body[b].r);
        return sum;
    }
    void phi(const lie::State& x, Eigen::Ref<Eigen::VectorXd> out) const override
    {
        int k = 0;
        for (const Pin& pin : pins)
            out[k++] = pin.e.dot(point(x, pin.i, pin.s_bar_i) - point(x, pin.j, pin.s_bar_j));
        for (const Perpendicular& row : perpendicular) out[k++] = row.a.dot(x.body[row.i].A * row.b_bar);
    }
    void variation(const lie::State& x, lie::Rows& out) const override
    {
        size_t n = 0;
        for (const Pin& pin : pins) {
            out.entry[n].r = pin.e;
            out.entry[n++].pi = pin.s_bar_i.cross(x.body[pin.i].A.transpose() * pin.e);
            if (pin.j < 0) continue;
            out.entry[n].r = -pin.e;
            out.entry[n++].pi = -pin.s_bar_j.cross(x.body[pin.j].A.transpose() * pin.e);
        }
        for (const Perpendicular& row : perpendicular)
            out.entry[n++].pi = row.b_bar.cross(x.body[row.i].A.transpose() * row.a);
    }
    void nu(const lie::State&, Eigen::Ref<Eigen::VectorXd> out) const override { out.setZero(); }
    /// Not used by the scheme under test
    void gamma(const lie::State&, Eigen::Ref<Eigen::VectorXd> out) const override { out.setZero(); }

    void cones(const lie::State& x, double h, lie::ConeRows& out) const override
    {
        out.cone.clear();
        std::uint64_t key = 0;
        for (const VertexPlane& of : vertices) {
            const Vec3 P = point(x, of.i, of.s_bar);
            const Vec3 n = of.j < 0 ? of.n_bar : Vec3(x.body[of.j].A * of.n_bar);
            const double gap = n.dot(P - (of.j < 0 ? Vec3(Vec3::Zero()) : x.body[of.j].r)) - of.d;
            add_cone(x, h, {of.i, of.j, of.mu, of.restitution, gap, key++}, n, P, out);
        }
        for (const Spheres& of : spheres) {
            const Vec3 apart = x.body[of.i].r - x.body[of.j].r, n = apart.normalized();
            const double gap = apart.norm() - of.R_i - of.R_j;
            add_cone(x, h, {of.i, of.j, of.mu, of.restitution, gap, key++}, n,
                     x.body[of.j].r + (of.R_j + 0.5 * gap) * n, out);
        }
    }

    static Vec3 point(const lie::State& x, int b, const Vec3& s_bar)
    {
        return b < 0 ? s_bar : Vec3(x.body[b].r + x.body[b].A * s_bar);
    }
    double kinetic_energy(const lie::State& x) const
    {
        double sum = 0;
        for (size_t b = 0; b < inertia.m.size(); ++b)
            sum += 0.5 * inertia.m[b] * x.body[b].rdot.squaredNorm() +
                   0.5 * x.body[b].omega_bar.dot(inertia.J_bar[b] * x.body[b].omega_bar);
        return sum;
    }

protected:
    struct Contact {
        int i, j;
        double mu, restitution, gap;
        std::uint64_t key;
    };
    void add_cone(const lie::State& x, double h, const Contact& of, const Vec3& n, const Vec3& P,
                  lie::ConeRows& out) const
    {
        lie::ConeRows::Cone cone;
        const Vec3 across = std::abs(n.z()) > 0.5 ? Vec3::UnitX() : Vec3::UnitZ();
        const Vec3 t = (across - across.dot(n) * n).normalized();
        cone.axes << n, t, n.cross(t);
        double u_n = 0;
        const auto set = [&](int b, double sign, lie::ConeRows::Mat36& C) {
            if (b < 0) return;
            const lie::Motion& body = x.body[b];
            C << sign * cone.axes.transpose(),
                -sign * (cone.axes.transpose() * lie::tilde(P - body.r) * body.A);
            u_n += C.row(0).head<3>().dot(body.rdot) + C.row(0).tail<3>().dot(body.omega_bar);
        };
        set(of.i, 1, cone.C_i);
        set(of.j, -1, cone.C_j);
        const double reach = h * (std::max(-u_n, 0.) + 0.01 + 100 * h);
        if (!(of.gap < reach) && !(of.gap < 0)) return;
        cone.key = of.key, cone.i = of.i, cone.j = of.j;
        cone.gap = of.gap;
        cone.mu_s = of.mu, cone.mu_k = of.mu * mu_k_by_mu_s;
        cone.restitution = of.restitution;
        cone.size = size;
        out.cone.push_back(cone);
    }

private:
    lie::Rows rows_pattern;
};

}  // namespace hilda::tests
