// SPDX-License-Identifier: GPL-3.0-or-later
/// A user-defined surface and a user-defined friction law in one file. Both register themselves and have
/// their own keys in the model file.

#include "contact/friction/friction.hpp"
#include "contact/implicit_surface.hpp"
#include "contact/surface_types.hpp"

namespace hilda::contact {
namespace {

/// Reads an egg-shaped surface: x² + y² + z² (1 + point z/R) = R² with the keys "radius" R [m] and "point" in
/// [-0.3, 0.3].
std::shared_ptr<const Surface> read_egg(dae::ObjectReader& o)
{
    const double R = o.positive("radius"), point = o.number("point", 0.1);
    if (!(std::abs(point) <= 0.3))
        o.fail("point", "point must be from -0.3 to 0.3, got " + dae::shortest(point));
    const auto G = [R, point](auto x, auto y, auto z) {
        return (x * x + y * y + z * z * (1.0 + point / R * z)) * (0.5 / R) - 0.5 * R;
    };
    return std::make_shared<ImplicitSurface<decltype(G)>>(G, R);
}

const bool egg = io::Registry<SurfaceType>::add({.name = "demo-egg", .read = read_egg});

/// Viscous friction F = c ṡ, limited to μ_s N. It has no history.
class DemoOil final : public FrictionModel {
public:
    DemoOil(double c, double mu_s) : c(c), mu_s(mu_s) {}

    void advance(const ContactState&, Deflections&) const override {}
    Wrench load(const ContactState& now, const Rates& rates, const Deflections&) const override
    {
        Wrench out;
        out.F = c * rates.s;
        if (const double bound = mu_s * now.N, F = out.F.norm(); F > bound) out.F *= bound / F;
        return out;
    }
    Springs springs(const ContactState&) const override { return {.D_slide = c}; }

private:
    const double c, mu_s;
};

const bool oil =
    io::Registry<FrictionLaw>::add({.name = "demo-oil",
                                    .what = "viscous, limited to the Coulomb bound",
                                    .read = [](dae::ObjectReader& o, FrictionParameters p,
                                               const NormalLaw&) -> std::shared_ptr<const FrictionModel> {
                                        return std::make_shared<DemoOil>(o.positive("viscosity"), p.mu_s);
                                    }});

}  // namespace
}  // namespace hilda::contact
