// SPDX-License-Identifier: GPL-3.0-or-later
/// Friction law "epsd": sliding friction of Sec. 4.3.1 and an elastic-plastic spring-damper for the rolling
/// rotation.
///
///     M^k += k_r ω_t h, |M^k| ≤ μ_r R N;   M^d = C_r ω_t, zero at the bound        Fang (2022), Sec. 2.2.1.4
///     |M^k + M^d| ≤ μ_r R N, except in the dissertation preset
///     k_r = K_E R²,   C_r = ζ 2 √(I_r k_r),   I_r = I + m R²                   Ai et al. (2011), model C
///
/// ω_t is the tangential part of ω_i - ω_j, and 1/R = κ_i + κ_j the sum of the mean curvatures. The spring is
/// stored in the contact frame like those of slide-roll-spin; published codes store it as a vector in the
/// global frame.

#include "contact/friction/laws/spring.hpp"
#include "dae/object_reader.hpp"

namespace hilda::contact {
namespace {

class Epsd final : public SlidingFriction {
public:
    explicit Epsd(const FrictionParameters& p) : SlidingFriction(p) {}

    void advance(const ContactState& now, Deflections& h) const override
    {
        advance_sliding(now, h);
        const SlidingDisplacement& s = now.slip;
        const RollingSpring spring = rolling(now);
        h.Theta_i += components(now.contact_point.K_i * s.q_i + now.contact_point.K_j * s.q_j, s.n, s.u);
        return_to_bound(h.Theta_i, h.roll_i, spring.cap, spring.cap);
    }

    Wrench load(const ContactState& now, const Rates& rates, const Deflections& h) const override
    {
        Wrench out;
        add_sliding(now, rates, h, out);
        const SlidingDisplacement& s = now.slip;
        const RollingSpring spring = rolling(now);
        const Vec3 elastic = spring.K * tangent(h.Theta_i, s.n, s.u);
        Vec3 damping = Vec3::Zero();
        if (h.roll_i.damped)
            damping = spring.D * (now.contact_point.K_i * rates.p_i + now.contact_point.K_j * rates.p_j);
        const Vec3 tau = sum_within_bound(elastic, damping, spring.K * spring.cap, p.capped);
        out.T_roll_E = elastic.cross(s.n);
        out.T_roll_E_j = -out.T_roll_E;
        out.T_i = tau.cross(s.n);
        out.T_j = -out.T_i;
        return out;
    }

    bool needs_curvature() const override { return p.mu_r > 0; }

    Springs springs(const ContactState& now) const override
    {
        const RollingSpring spring = rolling(now);
        return {.K_slide = p.K_E, .D_slide = D_slide(now), .K_roll = spring.K, .D_roll = spring.D};
    }

private:
    void add_static_rotation(const ContactState& now, StaticSprings& all) const override
    {
        const RollingSpring spring = rolling(now);
        const double bound = spring.K * spring.cap;
        if (p.mu_r > 0) all.roll = {.K = spring.K, .bound_s = bound, .bound_k = bound};
    }

    struct RollingSpring {
        double K = 0, D = 0, cap = 0;
    };

    RollingSpring rolling(const ContactState& now) const
    {
        const double kappa = 0.5 * (now.contact_point.K_i.trace() + now.contact_point.K_j.trace());
        if (!(kappa > 0)) return {};
        const double R = 1 / kappa, K = p.K_E * R * R;
        return {.K = K,
                .D = p.D_roll.value_or(2 * p.zeta * std::sqrt((now.I_roll + now.m * R * R) * K)),
                .cap = p.mu_r * R * now.N / K};
    }
};

std::shared_ptr<const FrictionModel> read_epsd(dae::ObjectReader& o, FrictionParameters p, const NormalLaw&)
{
    p.mu_r = o.not_negative("mu_r",
                            {"Coefficient of rolling resistance mu_r [-]. The torque is at most mu_r R N, "
                             "with the effective radius R.",
                             "0.01"},
                            0);
    return std::make_shared<Epsd>(p);
}

const bool registered_epsd = io::Registry<FrictionLaw>::add(
    {.name = "epsd",
     .what = "elastic-plastic rolling spring and dashpot (Fang 2022, Sec. 2.2.1.4)",
     .schema =
         {.description =
              "Sliding friction as in slide-roll-spin. Rolling friction is an elastic-plastic spring and "
              "damper on the relative rolling rotation (Fang 2022, Sec. 2.2.1.4; Ai et al. 2011, model C).",
          .examples = {R"("mu_s": 0.4, "K_E": 10000, "mu_r": 0.01)"}},
     .make = make_law<Epsd>,
     .read = read_epsd});

}  // namespace
}  // namespace hilda::contact
