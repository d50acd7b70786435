// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-rattle-4, rA-rattle-6, rA-rattle-8: symmetric compositions of RATTLE steps.
///
///     Ψ(h) = Φ(γ_s h) ∘ … ∘ Φ(γ_1 h),     Σ γ_i = 1,  γ_i = γ_{s+1-i}      Hairer, Lubich, Wanner (2006), Sec. V.3.2
///
/// Φ is a step of rA-rattle. It is symmetric, so that a symmetric composition raises the order from 2 to 4
/// (Suzuki 1990, s = 5), 6 (Kahan, Li 1997, s = 9) and 8 (Kahan, Li 1997, s = 17). The composition is
/// symmetric, symplectic for loads with a potential, and conserves momentum. Some of the steps are negative:
/// loads with a history, such as friction, and contacts cannot be evaluated backwards and are refused.
///
/// r, A, ṙ, ω̄ and λ are of the order of the composition.

#include "lie/check.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/steps/rattle_step.hpp"
#include "lie/system.hpp"

#include <cmath>
#include <utility>
#include <vector>

namespace hilda::lie {
namespace {

class Composition : public RattleStep {
public:
    int step(State& x, double h) override
    {
        refuse_history(x, name,
                       "some of its internal steps are negative, which loads with a history (friction, "
                       "plasticity) do not have; rA-rattle takes such models");
        start = x;
        Attempt attempt(x, start);
        int iterations = 0;
        double sum = 0;
        for (std::size_t k = 0; k < gamma.size(); ++k) {
            sum += gamma[k];
            const double end = k + 1 < gamma.size() ? start.t + sum * h : start.t + h;
            x_n = x;
            iterations += advance(x, gamma[k] * h, end);
        }
        return done(attempt, iterations);
    }

protected:
    /// `first`: γ_1 to γ_{(s-1)/2}; the middle one completes the sum 1
    Composition(const System& model, const Settings& settings, std::string name, std::vector<double> first)
        : RattleStep(model, tightened(settings), std::move(name)), gamma(std::move(first))
    {
        const std::size_t half = gamma.size();
        double middle = 1;
        for (const double g : gamma) middle -= 2 * g;
        gamma.push_back(middle);
        for (std::size_t k = half; k-- > 0;) gamma.push_back(gamma[k]);
    }

private:
    /// The tolerance is that of a step of order 2. The errors of Newton's method of all internal steps have
    /// to be small compared with the error of the composition.
    static Settings tightened(Settings settings)
    {
        settings.tolerance *= 1e-3;
        return settings;
    }

    std::vector<double> gamma;
    State start;
};

/// Suzuki (1990), Phys. Lett. A 146, 319-323
class Rattle4 final : public Composition {
public:
    Rattle4(const System& model, const Settings& settings)
        : Composition(model, settings, "rA-rattle-4", {of_suzuki, of_suzuki})
    {}

private:
    static inline const double of_suzuki = 1 / (4 - std::cbrt(4.));
};

/// Kahan, Li (1997), Math. Comp. 66, 1089-1099: s = 9
class Rattle6 final : public Composition {
public:
    Rattle6(const System& model, const Settings& settings)
        : Composition(model, settings, "rA-rattle-6",
                      {0.39216144400731413928, 0.33259913678935943860, -0.70624617255763935981,
                       0.08221359629355080023})
    {}
};

/// Kahan, Li (1997): s = 17
class Rattle8 final : public Composition {
public:
    Rattle8(const System& model, const Settings& settings)
        : Composition(model, settings, "rA-rattle-8",
                      {0.13020248308889008088, 0.56116298177510838456, -0.38947496264484728641,
                       0.15884190655515560090, -0.39590389413323757734, 0.18453964097831570709,
                       0.25837438768632204729, 0.29501172360931029887})
    {}
};

Scheme composition(const std::string& name, int order, const std::string& source)
{
    return {.name = name,
            .description = "symmetric composition of rA-rattle, of order " + std::to_string(order),
            .order = order,
            .order_lambda = order,
            .formulation = "rA",
            .unknowns = "r, h omega, h^2 lambda / 2",
            .uses = newton_options,
            .source = source,
            .supports = {Feature::redundant}};
}

const bool registered_rattle_compositions =
    register_scheme<Rattle4>(composition("rA-rattle-4", 4, "Suzuki (1990)")) &&
    register_scheme<Rattle6>(composition("rA-rattle-6", 6, "Kahan, Li (1997)")) &&
    register_scheme<Rattle8>(composition("rA-rattle-8", 8, "Kahan, Li (1997)"));

}  // namespace
}  // namespace hilda::lie
