// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/friction/friction.hpp"

#include "lie/check.hpp"

#include <algorithm>

namespace hilda::contact {

namespace {

// K_i + K_j is singular if its determinant is below this fraction of its squared norm (e.g. a foot on a
// plane).
constexpr double singular = 1e-9;

}  // namespace

double reduced(double a, double b)
{
    if (!std::isfinite(a)) return b;
    if (!std::isfinite(b)) return a;
    return a * b / (a + b);
}

Wrench Wrench::operator*(double factor) const
{
    if (factor == 1) return *this;
    return {.F = F * factor,
            .T_i = T_i * factor,
            .T_j = T_j * factor,
            .F_E = F_E * factor,
            .T_roll_E = T_roll_E * factor,
            .T_roll_E_j = T_roll_E_j * factor,
            .T_spin_E = T_spin_E * factor,
            .T_spin = T_spin * factor};
}

Springs Springs::operator*(double factor) const
{
    return {.K_slide = K_slide * factor,
            .D_slide = D_slide * factor,
            .K_roll = K_roll * factor,
            .D_roll = D_roll * factor,
            .K_spin = K_spin * factor,
            .D_spin = D_spin * factor};
}

Rates mean_rates(const SlidingDisplacement& slip, double h)
{
    const double per_step = 1 / h;
    return {.s = per_step * slip.ds,
            .p_i = per_step * slip.q_i,
            .p_j = per_step * slip.q_j,
            .psi = per_step * slip.psi};
}

Rates rates(const ContactPoint& contact_point, const SlidingDisplacement& slip, const Motion& bi,
            const Motion& bj)
{
    const Vec3& n = slip.n;
    const Vec3 omega_i = bi.A * bi.omega_bar, omega_j = bj.A * bj.omega_bar, omega = omega_i - omega_j;
    const auto project = [&](const Vec3& v) -> Vec3 { return v - n * n.dot(v); };
    const Vec3 v = project(bj.rdot + omega_j.cross(contact_point.C_j - bj.r) - bi.rdot -
                           omega_i.cross(contact_point.C_i - bi.r));
    Rates r{.s = v + contact_point.gap * omega_j.cross(n),
            .p_i = Vec3::Zero(),
            .p_j = Vec3::Zero(),
            .psi = omega.dot(n)};

    // (K_i + K_j) ṗ = q; for a body with an edge, ṗ has the direction of the edge
    const Mat3 K = contact_point.K_i + contact_point.K_j;
    const bool edge_j = contact_point.edge_j.squaredNorm() > 0;
    const Vec3 edge = contact_point.edge_i + contact_point.edge_j;  // at most one is not zero
    const Vec3 u = slip.u, w = n.cross(u), Ku = K * u, Kw = K * w;
    const double a = u.dot(Ku), b = u.dot(Kw), d = w.dot(Kw), det = a * d - b * b;
    if (!(det > singular * (a * a + 2 * b * b + d * d))) {
        // Two flat parts: the normal belongs to a face of one of them, which is not known here.
        if (K.isZero(0)) r.s = v + 0.5 * contact_point.gap * (omega_i + omega_j).cross(n);
        return r;
    }
    const auto solve = [&](const Vec3& q) -> Vec3 {
        if (edge.squaredNorm() > 0) return edge * (edge.dot(q) / edge.dot(K * edge));
        const double x = u.dot(q), y = w.dot(q);
        return ((d * x - b * y) * u + (a * y - b * x) * w) / det;
    };
    for (int pass = 0; pass < 2; ++pass) {  // two passes for the term gap ṅ: the error is of order (gap κ)²
        if (edge_j) {
            r.p_j = solve(omega.cross(n) - contact_point.K_i * r.s);
            r.p_i = r.p_j + r.s;
        } else {
            r.p_i = solve(omega.cross(n) + contact_point.K_j * r.s);
            r.p_j = r.p_i - r.s;
        }
        if (pass == 0) r.s = v + contact_point.gap * (omega_j.cross(n) + contact_point.K_j * r.p_j);
    }
    return r;
}

std::shared_ptr<const FrictionModel> frictionless()
{
    struct Frictionless final : FrictionModel {
        void advance(const ContactState&, Deflections&) const override {}
        Wrench load(const ContactState&, const Rates&, const Deflections&) const override { return {}; }
        Springs springs(const ContactState&) const override { return {}; }
    };
    static const auto none = std::make_shared<const Frictionless>();
    return none;
}

FrictionParameters FrictionParameters::as_in_dissertation() const
{
    FrictionParameters p = *this;
    p.tracking = {.beta = 1, .carrier = Carrier::i};
    p.capped = p.relative_rolling = p.reduced_mass = p.static_start = false;
    return p;
}

void FrictionParameters::validate() const
{
    const auto check = [](const char* what, double value, bool valid) {
        if (!valid || !std::isfinite(value)) lie::reject("friction", what, value);
    };
    check("mu_k must not be negative", mu_k, mu_k >= 0);
    check("mu_s must not be below mu_k", mu_s, mu_s >= mu_k);
    check("K_E must be positive", K_E, K_E > 0);
    check("zeta must not be negative", zeta, zeta >= 0);
    check("eta_r must not be negative", eta_r, eta_r >= 0);
    check("eta_psi must not be negative", eta_psi, eta_psi >= 0);
    check("E_star must not be negative", E_star, E_star >= 0);
    check("mu_r must not be negative", mu_r, mu_r >= 0);
    for (const auto& D : {D_slide, D_roll, D_spin})
        if (D) check("a damping coefficient must not be negative", *D, *D >= 0);
    if (eta_psi > 0 && E_star > 0)
        lie::reject("friction", "eta_psi and E_star exclude each other; E_star", E_star);
}

const FrictionLaw& friction_law(const std::string& name)
{
    using Laws = io::Registry<FrictionLaw>;
    if (const FrictionLaw* law = Laws::find(name)) return *law;
    std::string all;
    for (const std::string& law : Laws::names()) all += (all.empty() ? "" : ", ") + law;
    lie::reject("contact::friction_law", "the name must be one of the registered laws " + all,
                "'" + name + "'");
}

}  // namespace hilda::contact

template class hilda::io::Registry<hilda::contact::FrictionLaw>;
