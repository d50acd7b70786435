// SPDX-License-Identifier: GPL-3.0-or-later
/// Friction law "slide-roll-spin": sliding, rolling and spinning friction from the displacement of the
/// contact point (Fang 2022, Sec. 4.3).
///
///     S += q_i - q_j                 F   = K_E S + D Δs/h              on i at C, -F on j         (4.1, 4.2)
///     Θ += K_i q_i + K_j q_j         T   = (K_R Θ + D_R Δθ/h) × n      on i, -T on j
///     Ψ += ψ                         T_ψ = -(K_ψ Ψ + D_ψ ψ/h) n        on i, opposite on j             (4.8)
///
/// Δs, Δθ and ψ are the increments of a step h. The deflections are bounded, with μ = μ_s in stick and
/// μ = μ_k in slip:
///
///     |S| ≤ μ N / K_E;   |Θ| ≤ (κ/2) μ N / K_E,  K_R = 4 η_r K_E / κ²,  κ = κ_i + κ_j             (4.6, 4.7)
///     |Ψ| ≤ κ μ N / K_E, K_ψ = η_ψ K_E / κ²,     or with a Hertzian patch of radius a                  (4.9)
///     |Ψ| ≤ μ N / (K_E a), K_ψ = a² K_E / 2,     a³ = 3 N / (4 κ E*)                             (A.21-A.23)
///
/// The torque of the Hertzian patch is thus at most μ N a / 2. When the whole patch slips under Hertz's
/// pressure it is 3π/16 μ N a = 0.589 μ N a (Johnson 1985, Sec. 7.4), the bound with critical_spin.
///
///
/// Balanced preset (default): n × (K_i q_i + K_j q_j) is the rotation of i relative to j without the spin.
/// One vector Θ gives opposite torques, so that angular momentum is conserved. In rolling, κ is the tensor
/// K_i + K_j:
///
///     T = (4 η_r K_E κ⁻² Θ + D κ⁻¹ Δθ/h) × n,   |κ⁻¹ Θ| ≤ μ N / (2 K_E),   D = ζ 4 √(I η_r K_E)
///
/// This is a conservative spring for any path of Θ. On a sphere it is that of (4.6). Lever arms 1/κ are
/// limited to ContactState::max_lever. In spinning, κ is the sum of the mean curvatures.
///
/// Dissertation preset: two vectors, Θ_i += κ_i p_i and Θ_j += κ_j p_j, with the normal curvature κ_b along
/// the path of the contact point on each body (the mean curvature if there is no path), T_i = (K_R Θ_i + ...)
/// × n and T_j = -(K_R Θ_j + ...) × n. The torques are opposite only for equal bodies. The text calls the
/// tangent vector itself the torque; the torque about the axis of rolling is its cross product with n.

#include "contact/friction/laws/spring.hpp"
#include "contact/normal/normal_law.hpp"
#include "dae/object_reader.hpp"

#include <numbers>
#include <utility>

namespace hilda::contact {
namespace {

constexpr double no_direction = 1e-14;        // a shorter vector is treated as zero [m], [rad]
constexpr double curvature_rounding = 1e-12;  // relative rounding error of a curvature
constexpr double min_curvature = 1e-9;        // spinning friction is zero if κ_i + κ_j is smaller [1/m]

/// Normal curvature along t, or the mean curvature if t is zero [1/m]
double curvature(const Mat3& K, const Vec3& t)
{
    const double squared = t.squaredNorm();
    return squared > no_direction * no_direction ? t.dot(K * t) / squared : 0.5 * K.trace();
}

/// κ = K_i + K_j in (u, w) and its inverse L, the tensor of the lever arms of rolling. Principal curvatures
/// below 1/max_lever are raised to that value.
struct RollingLevers {
    explicit RollingLevers(const ContactState& now)
    {
        const Vec3 &n = now.slip.n, &u = now.slip.u, w = n.cross(u);
        const Mat3 sum = now.contact_point.K_i + now.contact_point.K_j;
        const Vec3 Ku = sum * u, Kw = sum * w;
        K << u.dot(Ku), u.dot(Kw), u.dot(Kw), w.dot(Kw);
        const double mean = 0.5 * K.trace(), apart = std::hypot(0.5 * (K(0, 0) - K(1, 1)), K(0, 1));
        least = mean - apart;
        if (const double floor = 1 / now.max_lever; least < floor) {
            // the principal directions do not change
            const double raised = std::max(mean + apart, floor);
            const Eigen::Matrix2d I = Eigen::Matrix2d::Identity();
            if (apart > curvature_rounding * std::abs(mean))
                K = floor * I + (raised - floor) / (2 * apart) * (K - least * I);
            else
                K = raised * I;
            least = floor;
        }
        L << K(1, 1), -K(0, 1), -K(0, 1), K(0, 0);
        L /= K(0, 0) * K(1, 1) - K(0, 1) * K(0, 1);
    }

    /// Longest lever arm [m]
    double longest() const { return 1 / least; }

    Eigen::Matrix2d K, L;  ///< [1/m, m]
    double least;          ///< smaller principal curvature [1/m]
};

class SlideRollSpin final : public SlidingFriction {
public:
    explicit SlideRollSpin(const FrictionParameters& p) : SlidingFriction(p) {}

    void advance(const ContactState& now, Deflections& h) const override
    {
        advance_sliding(now, h);
        if (p.eta_r > 0)
            p.relative_rolling ? advance_relative_rolling(now, h) : advance_separate_rolling(now, h);
        if (p.eta_psi > 0 || p.E_star > 0) {
            const BoundedSpring spring = spinning(now);
            h.Psi += now.slip.psi;
            return_to_bound(h.Psi, h.spin, spring.cap_s, spring.cap_k);
        }
    }

    Wrench load(const ContactState& now, const Rates& rates, const Deflections& h) const override
    {
        Wrench out;
        add_sliding(now, rates, h, out);
        if (p.eta_r > 0) add_rolling(now, rates, h, out);
        if (p.eta_psi > 0 || p.E_star > 0) {
            const BoundedSpring spring = spinning(now);
            out.T_spin_E = -spring.K * h.Psi;
            out.T_spin =
                sum_within_bound(out.T_spin_E, h.spin.damped ? -D_spin(now, spring.K) * rates.psi : 0.,
                                 spring.K * spring.cap_s, p.capped);
            out.T_i += out.T_spin * now.slip.n;
            out.T_j -= out.T_spin * now.slip.n;
        }
        return out;
    }

    Springs springs(const ContactState& now) const override
    {
        Springs all{.K_slide = p.K_E, .D_slide = D_slide(now)};
        if (p.eta_r > 0) {
            // rolling is stiffest in the direction of the smaller curvature
            const double longest = RollingLevers(now).longest();
            all.K_roll = 4 * p.eta_r * p.K_E * longest * longest, all.D_roll = D_roll(now, all.K_roll);
        }
        if (p.eta_psi > 0 || p.E_star > 0) {
            const BoundedSpring spring = spinning(now);
            all.K_spin = spring.K, all.D_spin = D_spin(now, spring.K);
        }
        return all;
    }

    bool needs_curvature() const override { return p.eta_r > 0 || p.eta_psi > 0 || p.E_star > 0; }

private:
    struct BoundedSpring {
        double K = 0, cap_s = 0, cap_k = 0;
    };

    void add_static_rotation(const ContactState& now, StaticSprings& all) const override
    {
        if (p.eta_r > 0 && p.relative_rolling) {
            // τ = K κ⁻² Θ is κ⁻¹ times the force y = K κ⁻¹ Θ.
            const double bound = 2 * p.eta_r * now.N;
            all.lever = RollingLevers(now).L;
            all.roll = {.K = 4 * p.eta_r * p.K_E, .bound_s = bound * p.mu_s, .bound_k = bound * p.mu_k};
        }
        if (p.eta_psi > 0 || p.E_star > 0) {
            const BoundedSpring spring = spinning(now);
            all.spin = {
                .K = spring.K, .bound_s = spring.K * spring.cap_s, .bound_k = spring.K * spring.cap_k};
        }
    }

    /// Rolling of the dissertation preset                                                       Eqs. 4.6, 4.7
    BoundedSpring rolling(const ContactState& now, double kappa) const
    {
        kappa = std::max(kappa, 1 / now.max_lever);
        const double K = 4 * p.eta_r * p.K_E / (kappa * kappa), lever = kappa / (2 * p.K_E);
        return {.K = K, .cap_s = lever * p.mu_s * now.N, .cap_k = lever * p.mu_k * now.N};
    }

    /// Spinning, empirical or Hertzian                                           Eq. 4.9 or Eqs. A.21 to A.23
    BoundedSpring spinning(const ContactState& now) const
    {
        const double kappa = 0.5 * (now.contact_point.K_i.trace() + now.contact_point.K_j.trace());
        if (!(kappa > min_curvature) || !(now.N > 0)) return {};
        double K = 0, per_newton = 0;  // bound of Ψ per N of μ N [1/N]
        if (p.E_star > 0) {
            const double a = std::cbrt(3 * now.N / (4 * kappa * p.E_star));
            K = 0.5 * a * a * p.K_E;
            constexpr double full_slip = 3 * std::numbers::pi / 8;  // of the bound of the text
            per_newton = (p.critical_spin ? full_slip : 1) / (p.K_E * a);
        } else {
            K = p.eta_psi * p.K_E / (kappa * kappa);
            per_newton = kappa / p.K_E;
        }
        return {.K = K, .cap_s = per_newton * p.mu_s * now.N, .cap_k = per_newton * p.mu_k * now.N};
    }

    double D_roll(const ContactState& now, double K) const
    {
        return p.D_roll.value_or(2 * p.zeta * std::sqrt(now.I_roll * K));
    }
    double D_spin(const ContactState& now, double K) const
    {
        return p.D_spin.value_or(2 * p.zeta * std::sqrt(now.I_spin * K));
    }

    void advance_relative_rolling(const ContactState& now, Deflections& h) const
    {
        const SlidingDisplacement& s = now.slip;
        h.Theta_i += components(now.contact_point.K_i * s.q_i + now.contact_point.K_j * s.q_j, s.n, s.u);
        const double per_newton = 1 / (2 * p.K_E);
        return_to_bound(h.Theta_i, (RollingLevers(now).L * h.Theta_i).norm(), h.roll_i,
                        per_newton * p.mu_s * now.N, per_newton * p.mu_k * now.N);
    }

    /// One vector per body along the path on that body. It is transported with its body and then expressed in
    /// (u, w).
    void advance_separate_rolling(const ContactState& now, Deflections& h) const
    {
        const SlidingDisplacement& s = now.slip;
        const double kappa_i = curvature(now.contact_point.K_i, s.p_i),
                     kappa_j = curvature(now.contact_point.K_j, s.p_j);
        const BoundedSpring spring = rolling(now, kappa_i + kappa_j);
        h.Theta_i = components(tangent(h.Theta_i, s.n, s.u_i) + kappa_i * s.p_i, s.n, s.u);
        h.Theta_j = components(tangent(h.Theta_j, s.n, s.u_j) + kappa_j * s.p_j, s.n, s.u);
        return_to_bound(h.Theta_i, h.roll_i, spring.cap_s, spring.cap_k);
        return_to_bound(h.Theta_j, h.roll_j, spring.cap_s, spring.cap_k);
    }

    void add_rolling(const ContactState& now, const Rates& rates, const Deflections& h, Wrench& out) const
    {
        p.relative_rolling ? add_relative_rolling(now, rates, h, out)
                           : add_separate_rolling(now, rates, h, out);
    }

    void add_relative_rolling(const ContactState& now, const Rates& rates, const Deflections& h,
                              Wrench& out) const
    {
        const SlidingDisplacement& s = now.slip;
        const RollingLevers levers(now);
        const double k = 4 * p.eta_r * p.K_E;
        const Vec2 elastic = k * (levers.L * (levers.L * h.Theta_i));
        Vec2 tau = elastic;
        if (h.roll_i.damped) {
            const Vec2 rate =
                components(now.contact_point.K_i * rates.p_i + now.contact_point.K_j * rates.p_j, s.n, s.u);
            if (p.D_roll)
                tau += *p.D_roll * rate;
            else
                tau += 2 * p.zeta * std::sqrt(now.I_roll * k) * (levers.L * rate);
        }
        const double bound = 2 * p.eta_r * p.mu_s * now.N;  // of |κ τ|
        if (const double size = (levers.K * tau).norm(); p.capped && size > bound) tau *= bound / size;
        const Vec3 T = tangent(tau, s.n, s.u).cross(s.n);
        out.T_roll_E = tangent(elastic, s.n, s.u).cross(s.n);
        out.T_roll_E_j = -out.T_roll_E;
        out.T_i += T;
        out.T_j -= T;
    }

    void add_separate_rolling(const ContactState& now, const Rates& rates, const Deflections& h,
                              Wrench& out) const
    {
        const SlidingDisplacement& s = now.slip;
        const double kappa_i = curvature(now.contact_point.K_i, s.p_i),
                     kappa_j = curvature(now.contact_point.K_j, s.p_j);
        const BoundedSpring spring = rolling(now, kappa_i + kappa_j);
        const auto torque = [&](const Vec2& Theta, const Regime& regime, const Vec3& rate,
                                Vec3& elastic) -> Vec3 {
            const Vec3 tau = spring.K * tangent(Theta, s.n, s.u);
            elastic = tau.cross(s.n);
            const Vec3 damping = regime.damped ? Vec3(D_roll(now, spring.K) * rate) : Vec3(Vec3::Zero());
            return sum_within_bound(tau, damping, spring.K * spring.cap_s, p.capped).cross(s.n);
        };
        out.T_i += torque(h.Theta_i, h.roll_i, kappa_i * rates.p_i, out.T_roll_E);
        out.T_j -= torque(h.Theta_j, h.roll_j, kappa_j * rates.p_j, out.T_roll_E_j);
        out.T_roll_E_j *= -1;
    }
};

/// For "spin": "hertz" the effective modulus is that of the normal law unless E_star is given.
std::shared_ptr<const FrictionModel> read_slide_roll_spin(dae::ObjectReader& o, FrictionParameters p,
                                                          const NormalLaw& normal)
{
    o.exclude("eta_psi", "spin");
    p.eta_r = o.not_negative(
        "eta_r",
        {"Rolling resistance coefficient eta_r [-] (Fang 2022, Eq. 4.5). Zero: no rolling resistance.",
         "0.05"},
        0);
    if (o.find("spin") != nullptr) {
        o.one_of("spin", {"hertz"},
                 {"Model of spinning resistance used instead of eta_psi. hertz: the torque of a Hertzian "
                  "contact patch of radius a (Fang 2022, Sec. A.8), at most mu N a/2.",
                  R"("hertz")"});
        p.critical_spin =
            o.flag("critical",
                   {"With \"spin\": \"hertz\" only. If true, the torque is at most 3 pi/16 mu N a, "
                    "at which the whole patch slips under the pressure of Hertz's theory.",
                    "true"},
                   false);
        const std::optional<double> modulus = normal.modulus();
        p.E_star =
            modulus && !o.has("E_star")
                ? *modulus
                : o.positive(
                      "E_star",
                      {"Effective modulus E* of the contact patch [Pa], with \"spin\": \"hertz\" only. By "
                       "default the modulus of a Hertzian normal law; required with any other normal law.",
                       "1e7"});
    } else {
        p.eta_psi = o.not_negative("eta_psi",
                                   {"Spinning resistance coefficient eta_psi [-] (Fang 2022, Eq. 4.9). Zero: "
                                    "no spinning resistance.",
                                    "0.01"},
                                   0);
    }
    return std::make_shared<SlideRollSpin>(p);
}

const bool registered_slide_roll_spin = io::Registry<FrictionLaw>::add(
    {.name = "slide-roll-spin",
     .what = "from the motion of the contact point (Fang 2022, Sec. 4.3)",
     .schema = {.description =
                    "Elastic-plastic springs and dampers for sliding, rolling and spinning, driven by "
                    "the displacement of the contact point over the two surfaces (Fang 2022, Sec. 4.3). "
                    "This is the default law. At most one of eta_psi and spin may be given.",
                .examples = {R"("mu_s": 0.5, "mu_k": 0.4, "K_E": 10000, "eta_r": 0.05)",
                             R"("mu_s": 0.5, "K_E": 10000, "spin": "hertz", "E_star": 1e7)"},
                .rest = R"("dependentRequired": {"E_star": ["spin"], "critical": ["spin"]})"},
     .make = make_law<SlideRollSpin>,
     .read = read_slide_roll_spin});

}  // namespace
}  // namespace hilda::contact
