// SPDX-License-Identifier: GPL-3.0-or-later
/// Friction law "constant-torque": sliding friction of Sec. 4.3.1 and a rolling torque of constant magnitude
/// against the rolling velocity.
///
///     T_i = -μ_r R N ω_t / |ω_t|,   T_j = -T_i                                         Fang (2022), Eq. 2.48
///
/// ω_t is the tangential part of ω_i - ω_j, and 1/R = κ_i + κ_j the sum of the mean curvatures. The rolling
/// torque has no history. A body at rest is therefore not held exactly: at zero velocity the direction of the
/// torque is that of the rounding errors.

#include "contact/friction/laws/spring.hpp"
#include "dae/object_reader.hpp"

namespace hilda::contact {
namespace {

class ConstantTorque final : public SlidingFriction {
public:
    explicit ConstantTorque(const FrictionParameters& p) : SlidingFriction(p) {}

    void advance(const ContactState& now, Deflections& h) const override { advance_sliding(now, h); }

    Wrench load(const ContactState& now, const Rates& rates, const Deflections& h) const override
    {
        Wrench out;
        add_sliding(now, rates, h, out);
        const Vec3 q =
            now.contact_point.K_i * rates.p_i + now.contact_point.K_j * rates.p_j;  // (ω_i - ω_j) × n
        const double speed = q.norm(),
                     kappa = 0.5 * (now.contact_point.K_i.trace() + now.contact_point.K_j.trace());
        if (!(speed > 0) || !(kappa > 0)) return out;
        out.T_roll_E = p.mu_r * now.N / (kappa * speed) * q.cross(now.slip.n);
        out.T_roll_E_j = -out.T_roll_E;
        out.T_i = out.T_roll_E;
        out.T_j = -out.T_roll_E;
        return out;
    }

    bool needs_curvature() const override { return p.mu_r > 0; }

    Springs springs(const ContactState& now) const override
    {
        return {.K_slide = p.K_E, .D_slide = D_slide(now)};
    }
};

std::shared_ptr<const FrictionModel> read_constant_torque(dae::ObjectReader& o, FrictionParameters p,
                                                          const NormalLaw&)
{
    p.mu_r = o.not_negative("mu_r",
                            {"Coefficient of rolling resistance mu_r [-]. The magnitude of the torque is "
                             "mu_r R N, with the effective radius R.",
                             "0.01"},
                            0);
    return std::make_shared<ConstantTorque>(p);
}

const bool registered_constant_torque = io::Registry<FrictionLaw>::add(
    {.name = "constant-torque",
     .what = "rolling torque of constant size (Fang 2022, Eq. 2.48)",
     .schema = {.description = "Sliding friction as in slide-roll-spin. Rolling friction is a torque of "
                               "constant magnitude that opposes the rolling velocity (Fang 2022, Eq. 2.48). "
                               "It has no static regime: a body at rest shows small oscillations.",
                .examples = {R"("mu_s": 0.4, "K_E": 10000, "mu_r": 0.01)"}},
     .make = make_law<ConstantTorque>,
     .read = read_constant_torque});

}  // namespace
}  // namespace hilda::contact
