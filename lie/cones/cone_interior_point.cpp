// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/cones/cone_interior_point.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace hilda::lie {

namespace {

constexpr double tiny = 1e-300;

/// √(a_n² - |a_t|²), without cancellation near the boundary
double cone_norm(const Vec3& a)
{
    const double t = std::hypot(a[1], a[2]);
    return std::sqrt(std::max((a[0] - t) * (a[0] + t), tiny));
}

/// a ∘ b
Vec3 product(const Vec3& a, const Vec3& b)
{
    return {a.dot(b), a[0] * b[1] + b[0] * a[1], a[0] * b[2] + b[0] * a[2]};
}

/// x with l ∘ x = r
Vec3 quotient(const Vec3& l, const Vec3& r)
{
    Mat3 L;
    L << l[0], l[1], l[2], l[1], l[0], 0, l[2], 0, l[0];
    return L.inverse() * r;
}

/// Largest t with a + t d in the second-order cone
double step_to_boundary(const Vec3& a, const Vec3& d)
{
    const double norm = cone_norm(a);
    const Vec3 unit = a / norm;
    const double r_0 = (unit[0] * d[0] - unit[1] * d[1] - unit[2] * d[2]) / norm;
    const double factor = (r_0 + d[0] / norm) / (unit[0] + 1);
    const double q = std::hypot(d[1] / norm - factor * unit[1], d[2] / norm - factor * unit[2]) - r_0;
    return q > 0 ? 1 / q : 1e30;
}

/// Moves a into the cone, from which rounding may have moved it
void clamp_into_cone(Vec3& a)
{
    const double least = std::hypot(a[1], a[2]) * (1 + 1e-14) + tiny;
    if (!(a[0] > least)) a[0] = least * (1 + 1e-13);
}

}  // namespace

int ConeInteriorPoint::solve(const ConeProblem& problem, BodyMatrix& matrix, Iterate& x, double tolerance,
                             int most)
{
    start(problem, matrix, x);
    int k = 0;
    for (;; ++k) {
        set_residual(problem, x);
        if (x.residual <= tolerance || k == most || !std::isfinite(x.residual)) break;
        double mean = 0, predicted = 0;
        for (const Point& at : point) mean += at.s.dot(at.z);
        scale();
        matrix.factor(problem, weights);
        for (Point& at : point) at.r = -product(at.l, at.l);
        set_step(problem, matrix, x, 1);
        const double affine = longest_step(1);
        for (const Point& at : point) predicted += (at.s + affine * at.ds).dot(at.z + affine * at.dz);
        const double centring = std::min(1., std::pow(std::max(0., predicted / mean), 3));
        mean /= static_cast<double>(point.size());
        for (Point& at : point) {
            at.r -= product(at.W_inverse * at.ds, at.W * at.dz);
            at.r[0] += centring * mean;
        }
        set_step(problem, matrix, x, 1 - centring);
        constexpr double to_boundary = 0.99;
        const double fraction = to_boundary * longest_step(1 / to_boundary);
        if (!(fraction > 1e-12) || !std::isfinite(fraction)) break;
        x.y += fraction * step;
        for (Point& at : point) {
            at.s += fraction * at.ds;
            at.z += fraction * at.dz;
            clamp_into_cone(at.s);
            clamp_into_cone(at.z);
        }
    }
    return k + 1;
}

/// Velocities without contacts, and points on the axes of the cones
void ConeInteriorPoint::start(const ConeProblem& problem, BodyMatrix& matrix, Iterate& x)
{
    const size_t contacts = x.p.size();
    point.resize(contacts);
    weights.assign(contacts, Mat3::Zero());
    std::fill(x.p.begin(), x.p.end(), Vec3::Zero());
    b.resize(problem.unknowns());
    problem.set_right_side(x.p, b);
    matrix.factor(problem, weights);
    matrix.solve(b, x.y);
    double speed = 1e-8;
    for (int c = 0; c < problem.contacts(); ++c) {
        Vec3 u = problem.u(c, x.y);
        u[0] += x.offset[c];
        speed = std::max(speed, u.cwiseAbs().maxCoeff());
    }
    for (int c = 0; c < problem.contacts(); ++c) {
        Point& at = point[c];
        at.mu = std::max(problem.mu[c], 1e-9);
        at.s = speed * Vec3::UnitX();
        at.z = speed / problem.g[c] * Vec3::UnitX();
    }
}

/// e: residual of the momenta and of the joint rows; impulses and residual of x
void ConeInteriorPoint::set_residual(const ConeProblem& problem, Iterate& x)
{
    const Rows& C = *problem.C_b;
    for (int c = 0; c < problem.contacts(); ++c) x.p[c] = point[c].scaled(point[c].z);
    e.resize(x.y.size());
    problem.set_right_side(x.p, e);
    for (int i = 0; i < problem.bodies(); ++i)
        e.segment<6>(6 * i) -= problem.times_mass(i, x.y.segment<6>(6 * i));
    C.add_transpose(-1, x.y.tail(C.rows()), e);
    for (int k = 0; k < C.rows(); ++k) e[problem.q.size() + k] -= C.dot(k, x.y);

    x.residual = 0;
    for (int c = 0; c < problem.contacts(); ++c) x.p[c] = project_on_cone(x.p[c], problem.mu[c]);
    x.residual = problem.convex_residual(x);
    step.resize(x.y.size());
    for (int i = 0; i < problem.bodies(); ++i)
        step.segment<6>(6 * i) = problem.by_mass(i, e.segment<6>(6 * i));
    for (int c = 0; c < problem.contacts(); ++c)
        x.residual = std::max(x.residual, problem.u(c, step).cwiseAbs().maxCoeff());
}

void ConeInteriorPoint::scale()
{
    const Vec3 mirror(1, -1, -1);
    for (size_t c = 0; c < point.size(); ++c) {
        Point& at = point[c];
        const double of_s = cone_norm(at.s), of_z = cone_norm(at.z);
        const Vec3 s = at.s / of_s, z = at.z / of_z;
        const Vec3 w = (s + mirror.cwiseProduct(z)) / std::sqrt(2 * (1 + s.dot(z)));
        const double eta = std::sqrt(of_s / of_z);
        const Eigen::Vector2d t = w.tail<2>();
        Mat3 V;
        V(0, 0) = w[0];
        V.block<1, 2>(0, 1) = t.transpose();
        V.block<2, 1>(1, 0) = t;
        V.block<2, 2>(1, 1) = Eigen::Matrix2d::Identity() + t * t.transpose() / (1 + w[0]);
        at.W = eta * V;
        at.W_inverse = mirror.asDiagonal() * V * mirror.asDiagonal() / eta;
        at.l = at.W * at.z;
        const Vec3 S(1, at.mu, at.mu);
        weights[c] = S.asDiagonal() * at.W_inverse * at.W_inverse * S.asDiagonal();
    }
}

void ConeInteriorPoint::set_step(const ConeProblem& problem, BodyMatrix& matrix, const Iterate& x,
                                 double share)
{
    // s_linear = S (u + offset n) - s: the part of ds that does not depend on the step of the velocities
    const auto linear = [&](int c) {
        Vec3 u = problem.u(c, x.y);
        u[0] += x.offset[c];
        return Vec3(share * (point[c].scaled(u) - point[c].s));
    };
    b = share * e;
    for (int c = 0; c < problem.contacts(); ++c) {
        const Point& at = point[c];
        const Vec3 h = at.W_inverse * (quotient(at.l, at.r) - at.W_inverse * linear(c));
        problem.add_impulse(c, at.scaled(h), b);
    }
    matrix.solve(b, step);
    for (int c = 0; c < problem.contacts(); ++c) {
        Point& at = point[c];
        at.ds = at.scaled(problem.u(c, step)) + linear(c);
        at.dz = at.W_inverse * (quotient(at.l, at.r) - at.W_inverse * at.ds);
    }
}

double ConeInteriorPoint::longest_step(double most) const
{
    for (const Point& at : point)
        most = std::min({most, step_to_boundary(at.s, at.ds), step_to_boundary(at.z, at.dz)});
    return most;
}

}  // namespace hilda::lie
