// SPDX-License-Identifier: GPL-3.0-or-later
/// Sliding as in Sec. 4.3.1; rolling by a torque of constant size against the rolling velocity.
///
///     T_i = -μ_r R N ω_t / |ω_t|,   T_j = -T_i                                         Fang (2022), Eq. 2.48
///
/// ω_t is the part of ω_i - ω_j in the tangent plane, 1/R = κ_i + κ_j. It has no history, so a body at rest trembles:
/// where the speed should be zero, rounding gives the torque its direction.

#include "contact/friction/laws/spring.hpp"
#include "dae/object_reader.hpp"

namespace hilda::contact {
namespace {

class ConstantTorque final : public Sliding {
public:
    explicit ConstantTorque(const FrictionParameters& p) : Sliding(p) {}

    void advance(const ContactState& now, Deflections& h) const override { slide(now, h); }

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

std::shared_ptr<const FrictionModel> read(dae::ObjectReader& o, FrictionParameters p, const NormalLaw&)
{
    p.mu_r = o.not_negative("mu_r", 0);
    return std::make_shared<ConstantTorque>(p);
}

const bool registered =
    register_friction_law<ConstantTorque>({.name = "constant-torque",
                                           .what = "rolling torque of constant size (Fang 2022, Eq. 2.48)",
                                           .read = read});

}  // namespace
}  // namespace hilda::contact
