// SPDX-License-Identifier: GPL-3.0-or-later
/// A user-defined surface, a user-defined friction law and a user-defined normal law in one file. They
/// register themselves and have their own keys in the model file.

#include "contact/friction/friction.hpp"
#include "contact/implicit_surface.hpp"
#include "contact/normal/normal_law.hpp"
#include "contact/surface_types.hpp"

#include <cmath>

namespace hilda::contact {
namespace {

/// Reads an egg-shaped surface: x² + y² + z² (1 + point z/R) = R² with the keys "radius" R [m] and "point" in
/// [-0.3, 0.3].
std::shared_ptr<const Surface> read_egg(dae::ObjectReader& o)
{
    const double R = o.positive("radius", {"Radius R in the plane z = 0 [m].", "0.1"});
    const double point = o.number("point", {"Taper [-].", "0.2", R"("minimum": -0.3, "maximum": 0.3)"}, 0.1);
    if (!(std::abs(point) <= 0.3))
        o.fail("point", "point must be from -0.3 to 0.3, got " + dae::shortest(point));
    const auto G = [R, point](auto x, auto y, auto z) {
        return (x * x + y * y + z * z * (1.0 + point / R * z)) * (0.5 / R) - 0.5 * R;
    };
    return std::make_shared<ImplicitSurface<decltype(G)>>(G, R);
}

const bool egg = io::Registry<SurfaceType>::add(
    {.name = "demo-egg",
     .schema = {.description = "Egg-shaped surface with its long axis along z of the surface frame.",
                .examples = {R"("radius": 0.1)"}},
     .read = read_egg});

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

const bool oil = io::Registry<FrictionLaw>::add(
    {.name = "demo-oil",
     .what = "viscous, limited to the Coulomb bound",
     .schema = {.description = "Viscous friction, limited to mu_s N.",
                .examples = {R"("mu_s": 0.3, "K_E": 1e4, "viscosity": 3)"}},
     .read = [](dae::ObjectReader& o, FrictionParameters p,
                const NormalLaw&) -> std::shared_ptr<const FrictionModel> {
         return std::make_shared<DemoOil>(o.positive("viscosity", {"Coefficient c [N s/m].", "3"}), p.mu_s);
     }});

/// A normal force N = k δ^p of the overlap δ
class DemoPower final : public NormalLaw {
public:
    DemoPower(double k, double p) : k(k), p(p) {}

    double force(const NormalInput& in) const override { return k * std::pow(in.overlap, p); }
    double stiffness(const NormalInput& in) const override { return p * k * std::pow(in.overlap, p - 1); }
    double energy(const NormalInput& in) const override { return k / (p + 1) * std::pow(in.overlap, p + 1); }

private:
    const double k, p;
};

const bool power = io::Registry<NormalLawType>::add(
    {.name = "demo-power",
     .schema = {.description = "Power law N = k delta^p of the overlap delta.",
                .examples = {R"("k": 1e6, "p": 1.5)"}},
     .read = [](dae::ObjectReader& o) -> std::shared_ptr<const NormalLaw> {
         const double k = o.positive("k", {"Coefficient k [N/m^p].", "1e6"});
         const double p = o.number("p", {"Exponent p [-].", "1.5", R"("minimum": 1)"});
         if (!(p >= 1)) o.fail("p", "p must be at least 1, got " + dae::shortest(p));
         return std::make_shared<DemoPower>(k, p);
     }});

}  // namespace
}  // namespace hilda::contact
