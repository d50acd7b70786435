// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/motion.hpp"

#include "granular/core/rigid_body.hpp"

#include <cmath>
#include <cstdio>

namespace hilda::granular {

namespace {

Vec3 value(const BoundaryMotion& m, const char* of, const VectorFormula& f, double t)
{
    const Vec3 at = f(t);
    // in single precision, in which the particles are computed
    const auto finite = [](double x) { return std::isfinite(static_cast<float>(x)); };
    if (finite(at.x) && finite(at.y) && finite(at.z)) return at;
    const bool beyond = granular::finite(at);
    char when[200];
    std::snprintf(when, sizeof when, " is %s at t = %.9g s, got (%.9g, %.9g, %.9g)",
                  beyond ? "beyond single precision" : "not finite", t, at.x, at.y, at.z);
    throw NotFinite("boundary '" + m.name + "': " + of + when);
}

}  // namespace

void apply_motions(World& world, const std::vector<BoundaryMotion>& motions, double h)
{
    const double t = world.t(), middle = t + h / 2;
    const double of_loads = world.scheme() == Scheme::velocity_verlet ? middle : t;
    for (const BoundaryMotion& m : motions) {
        Boundary& b = world.boundary(m.boundary);
        Vec3 v = b.v;
        if (m.r) v = (1 / h) * (value(m, "r", *m.r, t + h) - b.r);
        if (m.v) v = value(m, "v", *m.v, middle);
        const auto prescribed = [&](int axis) { return !(b.mass > 0 && b.free[axis]); };
        b.v = {prescribed(0) ? v.x : b.v.x, prescribed(1) ? v.y : b.v.y, prescribed(2) ? v.z : b.v.z};
        if (m.omega) prescribe_omega(b, value(m, "omega", *m.omega, middle));
        if (m.F) b.F = value(m, "F", *m.F, of_loads);
        if (m.T) b.T = value(m, "T", *m.T, of_loads);
    }
}

}  // namespace hilda::granular
