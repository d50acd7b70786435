// SPDX-License-Identifier: GPL-3.0-or-later
/// The methods of Newmark and of Hilber, Hughes and Taylor (HHT) on Euler parameters, fully implicit.
///                                                                                  Fang (2022), Sec. 2.1.7
///
///     q̇_{n+1} = q̇_n + h (1 - γ) a_n + h γ a_{n+1}
///     q_{n+1} = q_n + h q̇_n + h² (1/2 - β) a_n + h² β a_{n+1}
///     a_{n+1} = (1 - α) q̈_{n+1} + α q̈_n                                    Arnold, Brüls (2007), α_m = 0
///
/// with the equations of motion, the constraints and the normalisation of p at t_{n+1} (2.30) and the exact
/// Newton matrix 2.32. See formulations/rp_step_equations.hpp. Newmark (1959) has α = 0. The spectral radius
/// ρ at infinite frequency (Settings::rho_infinity) determines the parameters:
///
///     rp-newmark    γ = (3 - ρ)/(2 + 2ρ),              β = (γ + 1/2)²/4,    0 ≤ ρ < 1
///     rp-hht        α = (1 - ρ)/(1 + ρ),  γ = 1/2 + α, β = (1 + α)²/4,      1/2 ≤ ρ < 1
///
/// ρ = 1 is the trapezoidal rule for both. It is refused: an error of λ alternates in its sign and remains.
///
/// rp-newmark has order 1, also for λ; its error is proportional to γ - 1/2. rp-hht has order 2. The first
/// step of rp-hht is that of rp-bdf2, which assumes an acceleration that is linear in time, and
/// a_1 = q̈_1 - α (q̈_1 - q̈_0) is then accurate to O(h²). The velocities of this step do not have the
/// residual c h² of the later ones, so that λ_2, λ_3, … have an error of O(h), which decreases with the
/// powers of ρ. After a change of h the scheme starts again.

#include "lie/check.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "reference/formulations/rp_implicit.hpp"

namespace hilda::reference {
namespace {

struct Parameters {
    double alpha, beta, gamma;
};

/// Settings::rho_infinity, from `least` to less than 1. Throws InvalidInput.
double radius(const lie::Settings& settings, const char* scheme, double least, const char* range)
{
    const double rho = settings.rho_infinity;
    if (!(rho >= least && rho < 1)) lie::reject(scheme, range, rho);
    return rho;
}

Parameters of_newmark(const lie::Settings& settings)
{
    const double rho = radius(settings, "rp-newmark", 0, "rho_infinity must be from 0 to less than 1"),
                 gamma = (3 - rho) / (2 + 2 * rho);
    return {.alpha = 0, .beta = 0.25 * (gamma + 0.5) * (gamma + 0.5), .gamma = gamma};
}

Parameters of_hht(const lie::Settings& settings)
{
    const double rho = radius(settings, "rp-hht", 0.5, "rho_infinity must be from 0.5 to less than 1"),
                 alpha = (1 - rho) / (1 + rho);
    return {.alpha = alpha, .beta = 0.25 * (1 + alpha) * (1 + alpha), .gamma = 0.5 + alpha};
}

/// The steps of both schemes
class RpNewmarkFamily : public RpImplicit {
protected:
    RpNewmarkFamily(const lie::System& model, const lie::Settings& settings, const char* name,
                    const Parameters& of)
        : RpImplicit(model, settings, name), of(of), a_n(Eigen::VectorXd::Zero(q_n.size()))
    {}

private:
    int more() const override { return 1 + static_cast<int>(q_n.size()); }  // h, a_n

    void set_formula(double h, bool at_start) override
    {
        const auto [alpha, beta, gamma] = of;
        const bool starts = at_start || step_differs(h), is_second_order = alpha > 0;
        if (starts && is_second_order) return set_linear_acceleration(h);
        if (starts)
            a_n = qddot_n;
        else
            a_n = x_n.history.tail(q_n.size());
        formula.qdot = qdot_n + h * (1 - gamma) * a_n + h * gamma * alpha * qddot_n;
        formula.q = q_n + h * qdot_n + h * h * (0.5 - beta) * a_n + h * h * beta * alpha * qddot_n;
        formula.g_v = h * gamma * (1 - alpha), formula.g_q = h * h * beta * (1 - alpha);
    }

    void save_more(double h, Eigen::Ref<Eigen::VectorXd> out) const override
    {
        out << h, (1 - of.alpha) * z.head(q_n.size()) + of.alpha * qddot_n;
    }

    const Parameters of;
    Eigen::VectorXd a_n;
};

class RpNewmark final : public RpNewmarkFamily {
public:
    RpNewmark(const lie::System& model, const lie::Settings& settings)
        : RpNewmarkFamily(model, settings, "rp-newmark", of_newmark(settings))
    {}
};

class RpHht final : public RpNewmarkFamily {
public:
    RpHht(const lie::System& model, const lie::Settings& settings)
        : RpNewmarkFamily(model, settings, "rp-hht", of_hht(settings))
    {}
};

const bool newmark = lie::register_scheme<RpNewmark>(
    {.name = "rp-newmark",
     .description = "Newmark with numerical damping on Euler parameters, index 3",
     .order = 1,
     .order_lambda = 1,
     .formulation = "rp",
     .unknowns = "r'', p'', lambda, lambda_P",
     .uses = {"--tolerance", "--max-iterations", "--rho-infinity"},
     .source = "Newmark (1959); Fang (2022), Sec. 2.1.7",
     .loads = lie::LoadEvaluation::implicit,
     .supports = {lie::Feature::history}});
const bool hht = lie::register_scheme<RpHht>(
    {.name = "rp-hht",
     .description = "HHT (Hilber, Hughes, Taylor) on Euler parameters, index 3",
     .order = 2,
     .order_lambda = 2,
     .formulation = "rp",
     .unknowns = "r'', p'', lambda, lambda_P",
     .uses = {"--tolerance", "--max-iterations", "--rho-infinity"},
     .source = "Hilber, Hughes, Taylor (1977); Arnold, Bruls (2007); Fang (2022), Sec. 2.1.7",
     .loads = lie::LoadEvaluation::implicit,
     .supports = {lie::Feature::history}});

}  // namespace
}  // namespace hilda::reference
