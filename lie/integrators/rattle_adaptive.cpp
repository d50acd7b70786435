// SPDX-License-Identifier: GPL-3.0-or-later
/// rA-rattle-adaptive: RATTLE on the Lie group with reversible variable steps.
///
///     t_{n+1} = t_n + ε/ρ_{n+½},   ρ_{n+½} = ρ_{n-½} + ε G(x_n),   ρ_½ = 1 + ½ε G(x_0)
///     G = d/dt log Q,   Q = (F_0² + F²)^(3/8),   F² = Σ |F_i|²/m_i + n̄_iᵀ J̄_i⁻¹ n̄_i
///
/// Hairer, Söderlind (2005), SIAM J. Sci. Comput. 26, 1838-1851. ρ, the density of the steps, follows
/// Q/Q(x_0). A step from t_{n+1} with the opposite velocities returns to t_n with the same ρ, so that the
/// variable steps do not cause the energy of a reversible system to drift. Steps from an error estimate, or
/// from Q(x_n) alone, are not symmetric, and the energy drifts.
///
/// With loads that grow like d^-2 near a centre of attraction the steps are proportional to the time d^3/2 in
/// which a body passes it. F_0² is the mean of F² at x_0 and at two places before and after it on its path:
/// where the loads become small the steps grow by a limited factor. Where all loads are constant, so is the
/// step. G is a central difference over ±0.01 of the present step along the velocities and accelerations; it
/// is odd in the velocities, as the symmetry requires.
///
/// ε is the step at the start for which the local error, found from two steps of half its length, is the
/// tolerance. The error of the motion is of order 2 in ε, and proportional to rtol^(2/3).
///
/// A node inside an internal step is on the cubic Hermite polynomials of r and of θ = log(A_nᵀ A) between the
/// ends of the step, projected onto the constraints. It has no effect on the internal steps.

#include "lie/check.hpp"
#include "lie/schemes.hpp"
#include "lie/steps/cubic_path.hpp"
#include "lie/steps/rattle_step.hpp"
#include "lie/steps/state_numbers.hpp"
#include "lie/steps/step_control.hpp"
#include "lie/steps/switch_search.hpp"
#include "lie/system.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <sstream>

namespace hilda::lie {
namespace {

constexpr double distance = 1e-2;  // of the central difference, in parts of the step
constexpr double exponent = 3. / 8;
// Between ρ at a node, the mean of the steps before and after it, and Q/Q(x_0), in both directions. A smooth
// motion has 1 + O(ε²).
constexpr double largest_lag = 2;

class RattleAdaptive final : public RattleStep {
public:
    RattleAdaptive(const System& model, const Settings& settings)
        : RattleStep(model, settings, "rA-rattle-adaptive"), allowed(settings, name),
          longest_step(settings.longest_step()), switches(model), change(12 * bodies), tolerance(12 * bodies)
    {
        K.set_refinements(2);
    }

    bool chooses_internal_steps() const override { return true; }

    int step(State& x, double h) override
    {
        refuse_history(x, name,
                       "adaptive steps do not support loads with a history, such as friction; use a "
                       "fixed step");
        if (!(h > 0)) reject("integrator " + name, "the distance of two nodes must be positive", h);
        for (State* s : {&x_n, &begin, &end, &node}) copy(x, *s);
        const auto numbers = [this](const auto& block) { transfer(block); };
        int k = 0;
        if (x.history.size() == 0)
            k += start();
        else
            read_history(x, name, numbers);
        const double t = x.t + h;
        Progress progress(end.t, h);
        while (end.t < t) {
            if (settings.stop != nullptr && settings.stop()) throw Interrupted();
            k += internal_step();
            if (progress.has_stalled(end.t))
                fail(
                    "step_too_small",
                    "1000 steps cover less than 1e-06 of the distance of two nodes; the loads are too large");
        }
        if (t == end.t) {
            copy(end, x);
        } else {
            interpolate(node, t);
            model.accepted(begin, node);
            copy(node, x);
        }
        write_history(x, numbers);
        return k;
    }

private:
    template <class Block>
    void transfer(const Block& block)
    {
        for (double* number : {&begin.t, &end.t, &epsilon, &density, &F_0_squared, &start_squared})
            block(number, 1);
        lie::transfer(begin, block);
        lie::transfer(end, block);
    }

    /// A step from x, which becomes the result
    int take_step(State& x, double h, double t_end)
    {
        copy(x, x_n);
        for (int i = 0; i < bodies; ++i)
            if (const double turn = h * x_n.body[i].omega_bar.norm(); !(turn <= largest_internal_turn))
                fail("step_too_large", model.body_name(i) + " turns by " + number(turn) +
                                           " rad in a step of " + number(h) +
                                           " s, and the limit is 2; use a smaller rtol");
        Attempt attempt(x, x_n);
        return done(attempt, advance(x, h, t_end));
    }

    /// The node at t between `begin` and `end`
    void interpolate(State& x, double t)
    {
        copy(begin, x), copy(begin, x_n);
        const double h = end.t - begin.t;
        K.set_shift(shift(h));
        set_between(begin, end, (t - begin.t) / h, x);
        x.t = t;
        assemble_once(x);
        finish(x, name);
    }

    int internal_step()
    {
        copy(end, begin);
        const double present = squared_loads(begin);
        if (F_0_squared == 0 && present > 0)
            fail("step_too_large",
                 "loads act on a motion that was free at its start; the steps cannot follow them");
        // Q/Q(x_0)
        const double ratio = F_0_squared > 0 ? std::pow(present / start_squared, exponent) : 1;
        const double G = F_0_squared > 0 ? rate(begin, distance * epsilon / ratio) : 0;
        const double at_node = density == 0 ? 1 : density + 0.5 * epsilon * G;
        if (const double lag = at_node / ratio; !(lag < largest_lag && lag > 1 / largest_lag))
            fail("step_too_large",
                 "the loads change faster than the steps can follow: the density of the steps is " +
                     number(lag) +
                     " times that of the loads; use a smaller rtol, or an integrator with an "
                     "error estimate (rA-dp-5, rA-radau-5) for contacts");
        density = density == 0 ? 1 + 0.5 * epsilon * G : density + epsilon * G;
        const double h = epsilon / density;
        if (!(h > 0 && begin.t + h > begin.t))
            fail("step_too_small", "a step of " + number(h) + " s has no length");
        if (!(h <= longest_step))
            fail("step_too_large", "the loads ask for a step of " + number(h) + " s, and --max-step is " +
                                       number(longest_step) + " s; use a smaller rtol");
        if (const double until = model.smooth_until(begin.t, begin.t + h).end; until < begin.t + h)
            fail("step_too_large",
                 "a load or a prescribed motion has a jump, a kink or a short pulse at t = " + number(until) +
                     " s, and reversible steps cannot end there; use rA-dp-5, rA-dop853 or rA-radau-5");
        const int k = take_step(end, h, begin.t + h);
        if (switches.is_needed() && !switches.differ(begin, end) && switches.first(begin, end).found())
            fail("step_too_large",
                 "a body passes a threshold of a force, such as a stop, and returns within "
                 "one step; use a smaller rtol, or rA-dp-5, rA-dop853 or rA-radau-5");
        model.accepted(begin, end);
        return k;
    }

    /// F_0² + F² in the state x
    double squared_loads(const State& x)
    {
        model.loads(x, loads);
        double sum = F_0_squared;
        for (int i = 0; i < bodies; ++i)
            sum += loads.F[i].squaredNorm() / mass.m[i] +
                   loads.n_bar[i].dot(J_bar_inverse[static_cast<std::size_t>(i)] * loads.n_bar[i]);
        return sum;
    }

    /// G [1/s], from a difference over ±d
    double rate(const State& x, double d)
    {
        const double later = moved(x, d), earlier = moved(x, -d);
        return exponent * std::log(later / earlier) / (2 * d);
    }
    /// F_0² + F² where x is after the time d with its accelerations
    double moved(const State& x, double d)
    {
        copy(x, node);
        for (Motion& body : node.body) {
            body.r += d * body.rdot;
            body.A = body.A * exp(d * body.omega_bar);
            body.rdot += d * body.rddot, body.omega_bar += d * body.omegadot_bar;
        }
        node.t += d;
        return squared_loads(node);
    }

    /// Sets ε and F_0.
    int start()
    {
        double longest = largest_start();
        const double smallest = 1e-12 * longest;
        density = 0, epsilon = 0.01 * longest;
        set_tolerances(end, end, allowed.rtol, allowed.atol, tolerance);
        F_0_squared = 0;
        const double around = 0.1 * longest;
        F_0_squared = (squared_loads(end) + moved(end, around) + moved(end, -around)) / 3;
        start_squared = squared_loads(end);
        constexpr int most = 60;
        int k = 0;
        for (int n = 0; n < most; ++n) {
            double factor = 0.25;  // after a step that fails
            std::exception_ptr failed;
            try {
                copy(end, begin), copy(end, node);
                k += take_step(begin, epsilon, end.t + epsilon);
                k += take_step(node, epsilon / 2, end.t + epsilon / 2);
                k += take_step(node, epsilon / 2, end.t + epsilon);
                const double error = difference(begin, node) * 4 / 3;
                factor = std::clamp(std::cbrt(1 / std::max(error, 1e-30)), 0.1, 10.);
            } catch (const NumericalFailure&) {
                failed = std::current_exception();
                longest = factor * epsilon;
            }
            const bool accepted = std::abs(factor - 1) < 0.05 || (factor > 1 && epsilon == longest);
            if (accepted) break;
            epsilon = std::min(factor * epsilon, longest);
            if (epsilon > smallest && n + 1 < most) continue;
            if (failed) std::rethrow_exception(failed);
            fail("step_too_small", "the local error of no step is below the tolerance (rtol " +
                                       number(allowed.rtol) + ", atol " + number(allowed.atol) + ")");
        }
        // one of eight values for each factor of two, so that rounding errors rarely have an influence
        epsilon = std::exp2(std::round(8 * std::log2(epsilon)) / 8);
        return k;
    }
    /// A body turns by about a quarter of the limit at most, with the present acceleration. At most 1 s.
    double largest_start() const
    {
        double h = std::min(1., longest_step);
        for (const Motion& body : end.body)
            h = std::min({h, 0.25 * largest_internal_turn / body.omega_bar.norm(),
                          std::sqrt(0.5 * largest_internal_turn / body.omegadot_bar.norm())});
        return h;
    }
    /// Root mean square of the difference of two states over the tolerances
    double difference(const State& a, const State& b)
    {
        for (int i = 0; i < bodies; ++i) {
            const Motion &p = a.body[i], &q = b.body[i];
            change.segment<12>(12 * i) << p.r - q.r, log(q.A.transpose() * p.A), p.rdot - q.rdot,
                p.omega_bar - q.omega_bar;
        }
        return rms_over(tolerance, change);
    }

    static std::string number(double x)
    {
        std::ostringstream text;
        text.precision(3);
        text << x;
        return text.str();
    }
    [[noreturn]] void fail(const char* status, const std::string& why) const
    {
        std::ostringstream what;
        what.precision(3);
        what << name << " at t = " << end.t << " s: " << why;
        throw NumericalFailure(status, what.str());
    }

    const Tolerances allowed;
    const double longest_step;  ///< [s]
    SwitchSearch switches;
    State begin, end;                           ///< of the last internal step
    double epsilon = 0;                         ///< [s]
    double density = 0;                         ///< ρ of that step; 0 before the first one
    double F_0_squared = 0, start_squared = 0;  ///< 0: there are no loads, and the steps are ε
    State node;                                 ///< workspace
    Eigen::VectorXd change, tolerance;
};

const bool registered_rattle_adaptive = register_scheme<RattleAdaptive>(
    {.name = "rA-rattle-adaptive",
     .description = "RATTLE with reversible variable steps; the first one "
                    "from rtol and atol, the others from the loads",
     .order = 2,
     .order_lambda = 2,
     .formulation = "rA",
     .unknowns = "r, h omega, h^2 lambda / 2",
     .uses = {"--tolerance", "--max-iterations", "--linear-solver", "--rtol", "--atol", "--max-step"},
     .source = "Hairer, Söderlind (2005), with RATTLie",
     .adaptive = true,
     .supports = {Feature::redundant}});

}  // namespace
}  // namespace hilda::lie
