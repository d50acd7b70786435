// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/core/rigid_body.hpp"

#include "io/error.hpp"

#include <cmath>
#include <cstdio>

namespace hilda::granular {

namespace {

/// Σ over the free axes of a_k e_k
Vec3 free_part(const Boundary& b, const Vec3& a)
{
    return {b.free[3] ? a.x : 0, b.free[4] ? a.y : 0, b.free[5] ? a.z : 0};
}

/// A matrix by its rows
struct Matrix {
    Vec3 x, y, z;

    Vec3 operator*(const Vec3& a) const { return {x.dot(a), y.dot(a), z.dot(a)}; }
    /// Solution of (*this) a = c by Cramer's rule, with one refinement
    Vec3 solve(const Vec3& c) const
    {
        const Vec3 yz = y.cross(z), zx = z.cross(x), xy = x.cross(y);
        const double det = x.dot(yz);
        const auto once = [&](const Vec3& rhs) { return (1 / det) * (rhs.x * yz + rhs.y * zx + rhs.z * xy); };
        const Vec3 a = once(c);
        return a + once(c - *this * a);
    }
};

/// J(p) a
Vec3 inertia_times(const Boundary& b, const Vec3& a)
{
    return rotated(b.p, b.inertia * rotated_back(b.p, a));
}

/// J(p), with the rows of a unit matrix for the axes that are not free
Matrix free_inertia(const Boundary& b)
{
    return {b.free[3] ? inertia_times(b, {1, 0, 0}) : Vec3{1, 0, 0},
            b.free[4] ? inertia_times(b, {0, 1, 0}) : Vec3{0, 1, 0},
            b.free[5] ? inertia_times(b, {0, 0, 1}) : Vec3{0, 0, 1}};
}

/// ω with L along the free axes and the prescribed components along the others
Vec3 omega_of(const Boundary& b, const Vec3& L, const Vec3& prescribed)
{
    return free_inertia(b).solve(free_part(b, L) + (prescribed - free_part(b, prescribed)));
}

/// J_r(θ)⁻¹ a = a + 1/2 θ × a + c θ × (θ × a),  c = (1 - θ/2 cot(θ/2))/θ²
Vec3 inverse_right_jacobian(const Vec3& theta, const Vec3& a)
{
    const double x2 = 0.25 * theta.dot(theta);  // (θ/2)²
    double c = 0;
    if (x2 < 0.01) {  // series of (1 - x cot x)/(4 x²), with an error below 1e-16
        c = (1. / 12) *
            (1 + x2 * (1. / 15 +
                       x2 * (2. / 315 + x2 * (1. / 1575 + x2 * (2. / 31185 + x2 * 1382. / 212837625)))));
    } else {
        const double x = std::sqrt(x2);
        c = (1 - x / std::tan(x)) / (4 * x2);
    }
    const Vec3 t = theta.cross(a);
    return a + 0.5 * t + c * theta.cross(t);
}

}  // namespace

Vec3 angular_momentum(const Boundary& b) { return inertia_times(b, b.omega); }

double kinetic_energy(const Boundary& b)
{
    return 0.5 * b.mass * b.v.dot(b.v) + 0.5 * b.omega.dot(angular_momentum(b));
}

bool is_inertia(const Inertia& J)
{
    // The second moments ∫ x xᵀ dm = tr(J)/2 1 - J of a mass distribution are positive semidefinite. The
    // principal minors of both matrices decide.
    const auto minors = [](const Inertia& M, double least) {
        const double d = M.xx * (M.yy * M.zz - M.yz * M.yz) - M.xy * (M.xy * M.zz - M.yz * M.zx) +
                         M.zx * (M.xy * M.yz - M.yy * M.zx);
        return M.xx > least && M.yy > least && M.zz > least && M.xx * M.yy - M.xy * M.xy > least &&
               M.yy * M.zz - M.yz * M.yz > least && M.zz * M.xx - M.zx * M.zx > least && d > least;
    };
    const double trace = J.xx + J.yy + J.zz;
    if (!(trace > 0) || !std::isfinite(trace)) return false;
    const double s = 1 / trace;
    const Inertia scaled(std::array{s * J.xx, s * J.yy, s * J.zz, s * J.xy, s * J.yz, s * J.zx});
    const Inertia second(
        std::array{0.5 - scaled.xx, 0.5 - scaled.yy, 0.5 - scaled.zz, -scaled.xy, -scaled.yz, -scaled.zx});
    return minors(scaled, 0) && minors(second, -1e-9);  // a flat body has second moments of zero
}

void accelerate(Boundary& b, const Vec3& F, const Vec3& T, const Vec3& g, double h)
{
    const Vec3 a = (1 / b.mass) * F + g;
    b.v += h * Vec3{b.free[0] ? a.x : 0, b.free[1] ? a.y : 0, b.free[2] ? a.z : 0};
    if (b.rotates_freely()) b.omega += free_inertia(b).solve(h * free_part(b, T));
}

void prescribe_omega(Boundary& b, const Vec3& omega)
{
    b.omega = b.rotates_freely() ? omega_of(b, angular_momentum(b), omega) : omega;
}

Vec3 mean_omega(const Boundary& b, double h)
{
    if (!b.rotates_freely()) return b.omega;
    const Matrix J = free_inertia(b);
    const Vec3 target = h * angular_momentum(b);
    Vec3 theta = h * b.omega;
    constexpr int max_iterations = 100;
    double change = 0;
    for (int k = 0; k < max_iterations; ++k) {
        const Vec3 theta_bar = rotated_back(b.p, theta),
                   p = rotated(b.p, inverse_right_jacobian(theta_bar, b.inertia * theta_bar));
        const Vec3 d = J.solve(free_part(b, target - p));
        theta += d;
        change = d.norm();
        if (!(change > 4e-16 * theta.norm())) break;
    }
    if (!(change <= 1e-13 * theta.norm()) || !(theta.norm() < 2)) {
        char text[120];
        std::snprintf(text, sizeof text,
                      "turns by %.3g rad in one step, more than the integration allows; reduce h",
                      h * b.omega.norm());
        throw io::NumericalFailure("rotation_too_large", text);
    }
    return (1 / h) * theta;
}

void rotate(Boundary& b, const Vec3& mean_omega, double h)
{
    const bool free = b.rotates_freely();
    const Vec3 L = free ? angular_momentum(b) : Vec3{0, 0, 0};
    if (mean_omega != Vec3{0, 0, 0}) b.p = turned(b.p, h * mean_omega);
    if (free) b.omega = omega_of(b, L, b.omega);
}

}  // namespace hilda::granular
