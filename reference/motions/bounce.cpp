// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/motions/bounce.hpp"

#include "lie/check.hpp"

#include <cmath>
#include <limits>

namespace hilda::reference {

namespace {

/// First t > 0 with s + ṡ t + a t²/2 = 0 and negative rate
std::optional<double> first_zero(double s, double sdot, double a)
{
    const double discriminant = sdot * sdot - 2 * a * s;
    if (!(discriminant > 0)) return {};
    // The rate at the zero is -root. Both branches avoid cancellation.
    const double root = std::sqrt(discriminant);
    const double t = sdot > 0 ? -(sdot + root) / a : 2 * s / (root - sdot);
    if (!(t > 0) || !std::isfinite(t)) return {};
    return t;
}

/// Normal motion of a bouncing ball up to the first impact: s, ṡ at t = 0, a, w, t_1 of BouncingBall
struct NormalMotion {
    double s, sdot, a, w, t_1;

    explicit NormalMotion(const BouncingBall& b)
        : s(b.n.dot(b.r) - b.R), sdot(b.n.dot(b.rdot)), a(-b.n.dot(b.gravity)),
          w(std::sqrt(sdot * sdot + 2 * a * s)), t_1(sdot > 0 ? (sdot + w) / a : 2 * s / (w - sdot))
    {
        const char* where = "reference::BouncingBall";
        if (!(std::abs(b.n.norm() - 1) < 1e-12))
            lie::reject(where, "the normal must be a unit vector", b.n.norm());
        if (!(b.e >= 0 && b.e <= 1))
            lie::reject(where, "the coefficient of restitution must be between 0 and 1", b.e);
        if (!(a > 0))
            lie::reject(where, "gravity must have a component towards the plane; n·g", b.n.dot(b.gravity));
        if (!(s > 0)) lie::reject(where, "the initial gap must be positive", s);
    }
};

}  // namespace

Vec3 Flight::at(double t) const { return r + t * rdot + 0.5 * t * t * gravity; }
Vec3 Flight::velocity(double t) const { return rdot + t * gravity; }

std::optional<double> Flight::landing_time(const Vec3& n, double d) const
{
    return first_zero(n.dot(r) - d, n.dot(rdot), n.dot(gravity));
}

double BouncingBall::impact_time(int k) const
{
    if (k < 1) lie::reject("reference::BouncingBall", "impacts are counted from 1", k);
    const NormalMotion x(*this);
    double t = x.t_1, w = x.w;
    for (int i = 1; i < k; ++i) w *= e, t += 2 * w / x.a;
    return t;
}

double BouncingBall::rest_time() const
{
    const NormalMotion x(*this);
    return e == 1 ? std::numeric_limits<double>::infinity() : x.t_1 + 2 * x.w / x.a * e / (1 - e);
}

double BouncingBall::impulse(int k) const
{
    if (k < 1) lie::reject("reference::BouncingBall", "impacts are counted from 1", k);
    return m * (1 + e) * NormalMotion(*this).w * std::pow(e, k - 1);
}

Motion BouncingBall::at(double t) const
{
    const NormalMotion x(*this);
    if (!(t >= 0)) lie::reject("reference::BouncingBall", "the time must not be negative", t);
    double s = 0, sdot = 0, sddot = 0;
    if (t < x.t_1) {
        s = x.s + t * (x.sdot - x.a * t / 2), sdot = x.sdot - x.a * t, sddot = -x.a;
    } else if (t < rest_time()) {
        double w = e * x.w, elapsed = t - x.t_1;
        while (elapsed >= 2 * w / x.a && w > 0) elapsed -= 2 * w / x.a, w *= e;
        s = elapsed * (w - x.a * elapsed / 2), sdot = w - x.a * elapsed, sddot = -x.a;
    }
    Motion body;
    const Vec3 along = gravity - n.dot(gravity) * n;
    body.r = r - n.dot(r) * n + t * (rdot - x.sdot * n) + 0.5 * t * t * along + (R + s) * n;
    body.rdot = rdot - x.sdot * n + t * along + sdot * n;
    body.rddot = along + sddot * n;
    return body;
}

std::optional<double> TwoBalls::collision_time() const
{
    for (const double positive : {one.R, one.m, two.R, two.m})
        if (!(positive > 0))
            lie::reject("reference::TwoBalls", "radii and masses must be positive", positive);
    if (!(e >= 0 && e <= 1))
        lie::reject("reference::TwoBalls", "the coefficient of restitution must be between 0 and 1", e);
    const Vec3 r = two.r - one.r, v = two.rdot - one.rdot;
    const double radii = one.R + two.R, gap = r.squaredNorm() - radii * radii;
    if (!(gap > 0))
        lie::reject("reference::TwoBalls",
                    "the balls must not be in contact at the start: the gap must be positive",
                    r.norm() - radii);
    // |r + v t|² = radii²: gap + 2 (r·v) t + v² t²
    const double discriminant = r.dot(v) * r.dot(v) - v.squaredNorm() * gap;
    if (!(r.dot(v) < 0 && discriminant > 0)) return {};
    return gap / (std::sqrt(discriminant) - r.dot(v));
}

Vec3 TwoBalls::normal() const
{
    const std::optional<double> t = collision_time();
    if (!t) throw lie::NumericalFailure("no_impact", "reference::TwoBalls: the balls do not collide");
    return (two.r - one.r + *t * (two.rdot - one.rdot)).normalized();
}

double TwoBalls::impulse() const
{
    if (!collision_time()) return 0;
    return -one.m * two.m / (one.m + two.m) * (1 + e) * normal().dot(two.rdot - one.rdot);
}

std::pair<Motion, Motion> TwoBalls::at(double t) const
{
    const std::optional<double> t_1 = collision_time();
    const bool collided = t_1 && t >= *t_1;
    const Vec3 J_n = collided ? Vec3(impulse() * normal()) : Vec3(Vec3::Zero());
    const auto motion = [&](const Ball& ball, const Vec3& p) {
        Motion body;
        body.r = ball.r + t * ball.rdot + 0.5 * t * t * gravity;
        if (collided) body.r += (t - *t_1) / ball.m * p;
        body.rdot = ball.rdot + t * gravity + p / ball.m;
        body.rddot = gravity;
        return body;
    };
    return {motion(one, -J_n), motion(two, J_n)};
}

}  // namespace hilda::reference
