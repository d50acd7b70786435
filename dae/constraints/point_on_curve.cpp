// SPDX-License-Identifier: GPL-3.0-or-later
/// A point of one body on a curve of the other.
#include "dae/constraints/point_on_curve.hpp"

#include "dae/block_terms.hpp"
#include "dae/model_types.hpp"
#include "io/arithmetic/jet.hpp"
#include "lie/check.hpp"

#include <cmath>

namespace hilda::dae {

/// The nearest point of the curve, with derivatives by s
struct PointOnCurve::Foot {
    double s = 0;
    Vec3 p, c, c_s, c_ss;    ///< P, c(s), c'(s), c''(s)
    Vec3 n[2], n_s[2];       ///< normals and their derivatives
    double denominator = 0;  ///< ds = c' · dp / denominator
    Vec3 gradient(int k) const { return n[k] + (n_s[k].dot(p - c) / denominator) * c_s; }

    /// Normals, of which the first is the projection of e
    void set_normals(const Vec3& e)
    {
        const double length = c_s.norm();
        const Vec3 T = c_s / length, T_s = (c_ss - T * T.dot(c_ss)) / length;
        const Vec3 N = e - T * T.dot(e), N_s = -T_s * T.dot(e) - T * T_s.dot(e);
        n[0] = N.normalized();
        n_s[0] = (N_s - n[0] * n[0].dot(N_s)) / N.norm();
        n[1] = T.cross(n[0]);
        n_s[1] = T_s.cross(n[0]) + T.cross(n_s[0]);
    }
};

Vec3 PointOnCurve::position(const Arguments& x) const
{
    return x.bj.A.transpose() * (x.bi.r + x.bi.A * s_bar_i - x.bj.r);
}

PointOnCurve::Foot PointOnCurve::nearest(const Vec3& p, double guess) const
{
    constexpr int max_iterations = 50;
    constexpr double tolerance = 1e-14;
    Foot f;
    f.s = guess, f.p = p;
    double last = std::numeric_limits<double>::infinity();
    for (int k = 0; k < max_iterations; ++k) {
        for (int axis = 0; axis < 3; ++axis) {
            const io::Jet jet = c[axis].jet(f.s);
            f.c[axis] = jet.f, f.c_s[axis] = jet.fdot, f.c_ss[axis] = jet.fddot;
        }
        f.denominator = f.c_s.squaredNorm() - f.c_ss.dot(p - f.c);
        if (!(f.c_s.norm() > 0) || !(f.denominator > 0)) break;
        const double correction = f.c_s.dot(p - f.c) / f.denominator;
        // Converged: the correction is at rounding level, or no longer decreases near it.
        const double size = std::abs(correction) / (1 + std::abs(f.s));
        if (size < tolerance || (size < 1e-11 && size >= last)) return f;
        last = size;
        f.s += correction;
    }
    throw lie::NumericalFailure(
        "curve_lost",
        label() + ": the curve has no unique nearest point or no tangent near s = " + std::to_string(f.s));
}

PointOnCurve::Foot PointOnCurve::foot(const Arguments& x) const
{
    Foot f = nearest(position(x), x.internal_state[0]);
    f.set_normals(Vec3::Map(x.internal_state + 1));
    return f;
}

void PointOnCurve::phi(const Arguments& x, double* out) const
{
    const Foot f = foot(x);
    for (int k = 0; k < 2; ++k) out[k] = f.n[k].dot(f.p - f.c);
}

void PointOnCurve::variation(const Arguments& x, Derivatives& out) const
{
    const Foot f = foot(x);
    for (int k = 0; k < 2; ++k) {
        const Vec3 g_bar = f.gradient(k), g = x.bj.A * g_bar;
        out.C_i.row(k) << g.transpose(), s_bar_i.cross(x.bi.A.transpose() * g).transpose();
        out.C_j.row(k) << -g.transpose(), g_bar.cross(f.p).transpose();
    }
}

void PointOnCurve::gamma(const Arguments& x, double* out) const
{
    const Foot f = foot(x);
    const BodyFixedVector s_i(x.bi, s_bar_i);
    const Vec3 &omega = x.bj.omega_bar, v = x.bj.A.transpose() * (x.bi.rdot + s_i.vdot - x.bj.rdot);
    const Vec3 pdot = v - omega.cross(f.p);
    const Vec3 pddot =
        x.bj.A.transpose() * s_i.centripetal - 2 * omega.cross(v) + omega.cross(omega.cross(f.p));
    const double sdot = f.c_s.dot(pdot) / f.denominator;
    const Vec3 off = pdot - sdot * f.c_s;  // zero if the velocities satisfy the constraint
    for (int k = 0; k < 2; ++k) out[k] = -f.gradient(k).dot(pddot) - sdot * f.n_s[k].dot(pdot + off);
}

std::string PointOnCurve::start_error(const Arguments& x) const
{
    for (const io::Expression& coordinate : c)
        if (!std::isfinite(coordinate.value(s)))
            return "the coordinates of the curve must be finite at s = " + std::to_string(s) + ", got " +
                   std::to_string(coordinate.value(s)) + " for " + coordinate.text();
    nearest(position(x), s);
    return {};
}

void PointOnCurve::update_internal_state(const Arguments& x, bool start, double* saved) const
{
    Foot f = nearest(position(x), start ? s : saved[0]);
    Vec3::Map(saved + 1) = start ? f.c_s.unitOrthogonal() : Vec3(Vec3::Map(saved + 1));
    f.set_normals(Vec3::Map(saved + 1));
    saved[0] = f.s;
    Vec3::Map(saved + 1) = f.n[0];
}

namespace {

const TypeSchema schema_point_on_curve = {
    .description =
        "Point on a curve, 2 rows: point P of body i stays on a curve that is fixed in body j and given "
        "by its coordinates as functions of a parameter s. The curve must be smooth and have a tangent "
        "everywhere.",
    .examples = {R"-("body_i": "bead", "body_j": "ground", "curve": ["cos(s)", "sin(s)", 0], "s": 0.5)-"}};

const bool registered_point_on_curve = io::Registry<ConstraintType>::add(
    {.name = "point-on-curve",
     .schema = schema_point_on_curve,
     .read = [](ObjectReader& o, int i, int j, const State&) -> ConstraintType::Constraints {
         const Vec3 s_bar_i = o.vec3(
             "s_bar_p_i",
             {"Position of point P relative to the centre of mass of body i [m], in the frame of body i.",
              "[0, 0.1, 0]"},
             Vec3::Zero());
         std::array<io::Expression, 3> curve =
             o.expressions("curve",
                           {"Coordinates of the curve relative to the centre of mass of body j [m], in the "
                            "frame of body j: three numbers or expressions in s.",
                            R"-(["cos(s)", "sin(s)", "0.1*s"])-"},
                           {"s"});
         return std::make_unique<PointOnCurve>(
             i, s_bar_i, j, std::move(curve),
             o.number("s", {"Parameter of a point of the curve near P at the start [-].", "1.5"}, 0));
     }});

}  // namespace

}  // namespace hilda::dae
