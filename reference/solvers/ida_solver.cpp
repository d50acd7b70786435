// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/solvers/ida_solver.hpp"

#include "lie/check.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/steps/accelerations.hpp"
#include "lie/steps/projection.hpp"
#include "lie/steps/step_control.hpp"
#include "lie/steps/switch_search.hpp"
#include "reference/solvers/sundials.hpp"

#include <algorithm>
#include <exception>
#include <limits>
#include <new>
#include <utility>

namespace hilda::reference {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Limits of the internal steps between two nodes. IDA has failed after max_steps, and also if check_interval
// steps cover less than the fraction min_progress of the distance between the nodes.
constexpr long max_steps = 5'000'000, check_interval = 1000;
constexpr double min_progress = 1e-9;

// IDA bounds the local error of a step, and a run accumulates thousands of steps. IDA therefore gets a tenth
// of the tolerance of the caller. Below min_tolerance rounding determines the step size: IDA takes ten times
// as many steps and the error does not decrease. IDA starts again with order 1 behind each zero of a
// switching function, and the errors of these steps have one sign: with switching functions the fraction is a
// third, which takes 1.1 to 1.2 times the steps and reduces the error by factors of 2 to 12.
constexpr double step_fraction = 0.1, step_fraction_with_switches = 0.033, min_tolerance = 2e-14;

// Newton tolerance, as a fraction of the error tolerance of a step. IDA's default of 0.33 disturbs the error
// estimates: twice as many steps at 1e-12 and a larger error. The Newton tolerance is not below the rounding
// level.
constexpr double newton_fraction = 0.01, rounding_level = 3e-15;

// Rounding of coordinates beyond far_coordinate [m] disturbs Φ, and with it the orientations. The absolute
// tolerances are at least this multiple of it.
constexpr double far_coordinate = 1e3, rounding_multiple = 10;

std::string number(double value)
{
    std::ostringstream text;
    text.precision(9);
    text << value;
    return text.str();
}

double tolerance_of_step(const lie::System& system, double tolerance)
{
    return std::max(min_tolerance,
                    (system.switches() > 0 ? step_fraction_with_switches : step_fraction) * tolerance);
}

const lie::Settings& checked(const lie::Settings& settings)
{
    if (!(settings.rtol >= 1e-14) || !std::isfinite(settings.rtol))
        lie::reject("reference::IdaSolver", "rtol must be at least 1e-14", settings.rtol);
    if (settings.atol != 0 && (!(settings.atol >= 1e-14) || !std::isfinite(settings.atol)))
        lie::reject("reference::IdaSolver", "atol must be 0 or at least 1e-14", settings.atol);
    return settings;
}

}  // namespace

/// The objects of SUNDIALS and their use. C++ destroys members in reverse order, which is the order SUNDIALS
/// needs.
class IdaSolver::Ida {
public:
    Ida(const lie::System& system, const lie::State& start, const lie::Settings& settings, RpForm form)
        : equations(system, start, form), system(system), K(system), stop(settings.stop),
          longest_step(settings.longest_step()), counts_turns(system.counts_turns()), switches(system),
          rtol(tolerance_of_step(system, settings.rtol)),
          atol(settings.atol > 0 ? tolerance_of_step(system, settings.atol) : rtol), context(new_context()),
          y(new_vector()), ydot(new_vector()), tolerance(new_vector()), at_node(new_vector()),
          matrix(allocated(
              SUNSparseMatrix(equations.size(), equations.size(), entries(), CSC_MAT, context.get()))),
          linear(allocated(SUNLinSol_KLU(y.get(), matrix.get(), context.get()))),
          ida_memory(allocated(IDACreate(context.get())))
    {}

    int advance(lie::State& x, double t_end)
    {
        if (!(t_end > x.t) || !std::isfinite(t_end))
            lie::reject("reference::IdaSolver", "the end must be finite and after t = " + number(x.t) + " s",
                        t_end);
        if (!x.internal_state.empty() && system.internal_states_are_history())
            lie::reject(
                "reference::IdaSolver",
                "a model with continuous internal states (friction histories) cannot be integrated with "
                "adaptive steps; use an integrator with a fixed step; number of internal states",
                x.internal_state.size());
        const long before = statistics().iterations;
        const bool continues = has_last && is_last(x);
        has_last = false;  // set again at the end, unless an exception is thrown
        nonfinite.clear();
        if (!continues) start(x, t_end), counted = internal;
        double t_checked = t;
        for (long n = 1; t < t_end; ++n) {
            if (stop != nullptr && stop()) throw lie::Interrupted();
            if (to_restart) start(internal, t_end);
            if (!(t < t_end)) break;  // behind a break point at t_end
            internal_step(t_end);
            if (n % check_interval != 0) continue;
            if (n >= max_steps || t - t_checked < min_progress * (t_end - x.t)) fail_without_progress(n);
            t_checked = t;
            nonfinite.clear();
        }

        last = x;
        if (t == t_end || !has_stepped) {  // without a step, t is just behind a break point at t_end
            equations.read(t_end, map(y.get()), last);
        } else {
            check(IDAGetDky(ida_memory.get(), t_end, 0, at_node.get()), "IDAGetDky");
            equations.read(t_end, map(at_node.get()), last);
        }
        last.discrete_state = internal.discrete_state, last.internal_state = internal.internal_state;
        const lie::State& now = updated_internal_state(counted, last);
        last.discrete_state = now.discrete_state, last.internal_state = now.internal_state;
        lie::solve_accelerations(system, K, last);
        has_last = true;
        x = last;
        return static_cast<int>(statistics().iterations - before);
    }

    lie::Statistics statistics() const
    {
        lie::Statistics s = earlier;
        if (!initialised) return s;
        long steps = 0, iterations = 0, setups = 0;
        IDAGetNumSteps(ida_memory.get(), &steps);
        IDAGetNumNonlinSolvIters(ida_memory.get(), &iterations);
        IDAGetNumLinSolvSetups(ida_memory.get(), &setups);
        s.steps += steps;
        s.iterations += iterations;
        s.factorizations += setups;
        return s;
    }

    RpEquations equations;
    const lie::System& system;
    RankMonitor::Smallest smallest_condition;

private:
    using Vector = Owned<N_Vector, N_VDestroy>;

    Vector new_vector() const { return Vector(allocated(N_VNew_Serial(equations.size(), context.get()))); }
    sunindextype entries() const { return static_cast<sunindextype>(equations.pattern().value.size()); }

    /// Whether x is the state that the last call returned. The multipliers may differ, because a change of
    /// the branch of a driver changes them. The time may differ by rounding.
    bool is_last(const lie::State& x) const
    {
        if (std::abs(x.t - last.t) > 1e-13 * std::max(1.0, std::abs(x.t)) ||
            x.discrete_state != last.discrete_state || x.body.size() != last.body.size())
            return false;
        for (size_t b = 0; b < x.body.size(); ++b) {
            const lie::Motion &a = x.body[b], &c = last.body[b];
            if (a.r != c.r || a.A != c.A || a.rdot != c.rdot || a.omega_bar != c.omega_bar) return false;
        }
        return true;
    }

    /// x projected onto the constraints, with the discrete and internal states updated from those of `from`,
    /// the state of their last update. A copy of x if there are none.
    const lie::State& updated_internal_state(const lie::State& from, const lie::State& x)
    {
        updated = x;
        if (x.discrete_state.empty() && x.internal_state.empty()) return updated;
        lie::project_positions(system, K, updated);
        lie::project_velocities(system, K, updated);
        if (updated.lambda.size() != system.rows()) updated.lambda.setZero(system.rows());
        system.accepted(from, updated);
        return updated;
    }

    void start(const lie::State& x, double t_end)
    {
        lie::State consistent = x;
        lie::project_positions(system, K, consistent);
        lie::project_velocities(system, K, consistent);
        refuse_infinite_load(consistent);
        lie::solve_accelerations(system, K, consistent);
        equations.write(consistent, map(y.get()), map(ydot.get()));
        internal = consistent;
        t = consistent.t;
        to_restart = false;
        earlier = statistics();
        if (initialised) {
            check(IDAReInit(ida_memory.get(), t, y.get(), ydot.get()), "IDAReInit");
        } else {
            set_up(consistent);
        }
        const double first = std::min({first_step(t_end > t ? t_end - t : infinity), longest_step,
                                       std::exchange(first_step_limit, infinity)});
        check(IDASetInitStep(ida_memory.get(), first), "IDASetInitStep");
        first_step_taken = first;
        before = consistent;
        at_break = 0;
        has_stepped = false;
    }

    void refuse_infinite_load(const lie::State& x) const
    {
        lie::Loads load(system.bodies());
        system.loads(x, load);
        for (int b = 0; b < system.bodies(); ++b)
            for (const bool turns : {false, true})
                if (!(turns ? load.n_bar[b] : load.F[b]).allFinite())
                    throw lie::NonFinite("a load is not finite at t = " + number(x.t) +
                                         " s: " + (turns ? "rotation" : "translation") + " of body '" +
                                         system.body_name(b) + "'");
    }

    void set_up(const lie::State& consistent)
    {
        // Multipliers take part in the Newton test. They are excluded from the error test, in which index-2
        // systems stall because of them. Their absolute tolerance is 1e-4 of the largest load.
        double weight = 0;
        const double L = equations.length;
        lie::Loads load(system.bodies());
        system.loads(consistent, load);
        for (int b = 0; b < system.bodies(); ++b)
            weight = std::max({weight, load.F[b].norm() / L, load.n_bar[b].norm() / (L * L),
                               system.mass().m[b] * std::max(1.0, consistent.body[b].rddot.norm() / L)});
        check(IDASetErrHandlerFn(ida_memory.get(), error_handler, this), "IDASetErrHandlerFn");
        check(IDAInit(ida_memory.get(), residual, t, y.get(), ydot.get()), "IDAInit");
        initialised = true;
        check(IDASetUserData(ida_memory.get(), this), "IDASetUserData");
        Vector id = new_vector();
        auto differential = map(id.get()), tolerances = map(tolerance.get());
        for (int k = 0; k < equations.size(); ++k) {
            const RpEquations::UnknownType type = equations.unknown_type(k);
            const bool is_differential =
                type == RpEquations::UnknownType::position || type == RpEquations::UnknownType::velocity;
            differential[k] = is_differential ? 1 : 0;
            tolerances[k] = is_differential ? std::max(atol, rounding_floor(consistent, k))
                            : type == RpEquations::UnknownType::lambda ? 1e-4 * weight
                                                                       : 1;
        }
        check(IDASVtolerances(ida_memory.get(), rtol, tolerance.get()), "IDASVtolerances");
        check(IDASetId(ida_memory.get(), id.get()), "IDASetId");
        check(IDASetSuppressAlg(ida_memory.get(), SUNTRUE), "IDASetSuppressAlg");
        check(IDASetNonlinConvCoef(ida_memory.get(), std::max(newton_fraction, rounding_level / rtol)),
              "IDASetNonlinConvCoef");
        check(IDASetLinearSolver(ida_memory.get(), linear.get(), matrix.get()), "IDASetLinearSolver");
        check(IDASetJacFn(ida_memory.get(), jacobian), "IDASetJacFn");
        if (longest_step < infinity) check(IDASetMaxStep(ida_memory.get(), longest_step), "IDASetMaxStep");
        // The pattern is symmetric and irreducible. COLAMD, the default of SUNDIALS, produces twice the
        // fill-in of AMD.
        constexpr int amd = 0;
        SUNLinSol_KLUGetCommon(linear.get())->btf = 0;
        if (SUNLinSol_KLUSetOrdering(linear.get(), amd) != 0) throw std::bad_alloc();
    }

    /// Smallest useful absolute tolerance of the position or velocity k, in the unit of y. An error e of the
    /// coordinates of a body turns it by at most e/(2ρ), with its radius of gyration ρ: the smallest change
    /// of pose in the metric of the mass.
    double rounding_floor(const lie::State& x, int k) const
    {
        double largest = 0;
        for (const lie::Motion& body : x.body) largest = std::max(largest, body.r.cwiseAbs().maxCoeff());
        const double L = equations.length;
        if (largest < far_coordinate * L) return 0;
        const double of_r = rounding_multiple * std::numeric_limits<double>::epsilon() * largest / L;
        if (k % 7 < 3) return of_r;
        const lie::Mass& mass = system.mass();
        const auto b = static_cast<size_t>(k / 14);
        return of_r * L / (2 * std::sqrt(mass.J_bar[b].diagonal().minCoeff() / mass.m[b]));
    }

    /// Size of the first step [s], for which the error of backward Euler is about the tolerance. IDA's own
    /// choice changes y by half the tolerance. At 1e-12 that is a step of 1e-14 s, whose multipliers consist
    /// of rounding errors.
    double first_step(double h) const
    {
        const auto at_start = map(y.get()), rate = map(ydot.get());
        double sum = 0;
        for (int k = 0; k < equations.size(); ++k)
            if (equations.unknown_type(k) == RpEquations::UnknownType::velocity) {
                const double e = rate[k] / (rtol * std::abs(at_start[k - 7]) + atol);
                sum += e * e;
            }
        const double norm = std::sqrt(sum / equations.size());
        return std::min({0.5 / std::sqrt(std::max(norm, 1e-300)), 1e-3, h});
    }

    /// Sets the time that the next step must not pass, if it would: the step resolves the functions of time
    /// in the system and ends before their break points, and bodies turn by a limited angle where turns are
    /// counted.
    void limit_step()
    {
        double next = first_step_taken;
        if (has_stepped) IDAGetCurrentStep(ida_memory.get(), &next);
        double fastest = 0;
        if (counts_turns)
            for (const lie::Motion& body : before.body)
                fastest = std::max(fastest, body.omega_bar.squaredNorm());
        const double limit = std::min({next, longest_step, lie::largest_counted_turn / std::sqrt(fastest)});
        const lie::System::SmoothTime smooth = system.smooth_until(t, t + limit);
        at_break = smooth.is_break ? smooth.end : 0;
        const double end = smooth.end - lie::break_distance(at_break);
        // IDA may be beyond t by rounding errors.
        is_at_break = at_break > 0 && !(end - t > lie::break_distance(t));
        if (end < t + next && !is_at_break) check(IDASetStopTime(ida_memory.get(), end), "IDASetStopTime");
    }

    /// Restarts behind a break point of time, with the state that IDA has reached before it.
    void pass_break()
    {
        equations.read(t, map(y.get()), internal);
        internal.t = at_break + lie::break_distance(at_break);
        at_break = 0;
        to_restart = true;
    }

    /// Returns to the zero of a switching function in the last step, from where IDA restarts. Whether there
    /// is one.
    bool return_to_switch()
    {
        const double from = before.t, h = t - from;
        const auto path = [&](double s, lie::State& x) {
            check(IDAGetDky(ida_memory.get(), from + s * h, 0, at_node.get()), "IDAGetDky");
            equations.read(from + s * h, map(at_node.get()), x);
        };
        constexpr double at_begin = 1e-9;
        const lie::SwitchSearch::Crossing crossing = switches.first(after, path, at_begin * last_length / h);
        if (!crossing.found()) return false;
        path(crossing.after, internal);
        t = internal.t;
        return to_restart = true;
    }

    /// Restarts from the beginning of the last step with a shorter one if bodies have turned too far for the
    /// count of their turns.
    bool repeat_shorter()
    {
        double fastest = 0;
        for (const lie::Motion& body : after.body) fastest = std::max(fastest, body.omega_bar.squaredNorm());
        const double h = t - before.t, turn = h * std::sqrt(fastest);
        if (!(turn > 2 * lie::largest_counted_turn)) return false;
        internal = before;
        t = before.t;
        first_step_limit = h * lie::largest_counted_turn / turn;
        return to_restart = true;
    }

    void internal_step(double t_end)
    {
        limit_step();
        const bool follows = counts_turns || switches.is_needed();
        if (is_at_break) return pass_break();
        const int code = IDASolve(ida_memory.get(), t_end, &t, y.get(), ydot.get(), IDA_ONE_STEP);
        if (failure) std::rethrow_exception(std::exchange(failure, nullptr));
        if (code < 0 && !nonfinite.empty()) throw lie::NonFinite(nonfinite);
        check(code, "IDASolve");
        has_stepped = true;
        if (follows) {
            equations.read(t, map(y.get()), after = before);
            if (counts_turns && repeat_shorter()) return;
            if (switches.is_needed() && return_to_switch()) return;
            last_length = t - before.t;
        }
        if (equations.form != RpForm::ggl && system.rows() > 0) watch_rank();
        update_internal_states();
        if (follows) equations.read(t, map(y.get()), before = internal);
        if (at_break > 0 && code == IDA_TSTOP_RETURN) pass_break();
    }

    void update_internal_states()
    {
        if (internal.discrete_state.empty() && internal.internal_state.empty()) return;
        equations.read(t, map(y.get()), internal);
        const lie::State& now = updated_internal_state(counted, internal);
        equations.set_internal_state(now.internal_state);
        internal.internal_state = now.internal_state;
        const bool changes = now.discrete_state != internal.discrete_state;
        if (changes) internal = now;
        counted = internal;
        if (!changes) return;
        to_restart = !equations.set_discrete_state(internal.discrete_state, t, map(y.get()), map(ydot.get()));
    }

    /// At every step while the condition is less than `far` of that at the start, otherwise at every fifth: a
    /// factorisation takes a tenth of the time of a step.
    void watch_rank()
    {
        constexpr double far = 0.3;
        constexpr int interval = 5;
        if (passed_singularity || (last_condition_ratio > far && ++unwatched < interval)) return;
        unwatched = 0;
        equations.read(t, map(y.get()), updated = internal);
        if (!watched) watched = std::make_unique<lie::Saddle>(system);
        double condition = 0;
        try {
            watched->assemble(updated);
            condition = watched->reciprocal_condition();
        } catch (const lie::SingularMatrix&) {
        }
        if (condition_at_start == 0) condition_at_start = condition;
        const double ratio = last_condition_ratio = condition / condition_at_start;
        if (ratio < smallest_condition.ratio) smallest_condition = {ratio, t};
        passed_singularity = smallest_condition.ratio < RankMonitor::nearly_dependent &&
                             ratio > 10 * RankMonitor::nearly_dependent;
    }

    [[noreturn]] void fail_without_progress(long steps) const
    {
        if (!nonfinite.empty()) throw lie::NonFinite(nonfinite);
        throw lie::NumericalFailure(
            "ida_failed", "reference::IdaSolver: IDA makes no progress: after " + std::to_string(steps) +
                              " steps between two nodes t = " + number(t) + " s, step size " +
                              number(last_step()) +
                              " s; use a larger rtol, or check the loads for discontinuities");
    }

    double last_step() const
    {
        double h = 0;
        IDAGetCurrentStep(ida_memory.get(), &h);
        return h;
    }

    void check(int code, const char* function)
    {
        if (code >= 0) {
            ida_message.clear();
            return;
        }
        const std::unique_ptr<char, Destroy<std::free>> name(IDAGetReturnFlagName(code));
        std::string text = std::string("reference::IdaSolver: IDA failed at t = ") + number(t) +
                           " s with a step of " + number(last_step()) + " s: " + name.get() + " in " +
                           function;
        if (!ida_message.empty()) text += ": " + std::exchange(ida_message, {});
        throw lie::NumericalFailure("ida_failed", text);
    }

    static int residual(double t, N_Vector y, N_Vector ydot, N_Vector F, void* self) noexcept
    {
        Ida& ida = *static_cast<Ida*>(self);
        try {
            auto out = map(F);
            ida.equations.residual(t, map(y), map(ydot), out);
            if (std::isfinite(out.sum())) return 0;
            for (int k = 0; k < ida.equations.size(); ++k)
                if (!std::isfinite(out[k])) {
                    ida.nonfinite =
                        "the residual is not finite at t = " + number(t) + " s: " + ida.equations.name(k);
                    break;
                }
            return 1;  // recoverable: IDA retries with a shorter step
        } catch (...) {
            ida.failure = std::current_exception();
            return -1;
        }
    }

    static int jacobian(double t, double c_j, N_Vector y, N_Vector ydot, N_Vector, SUNMatrix out, void* self,
                        N_Vector, N_Vector, N_Vector) noexcept
    {
        Ida& ida = *static_cast<Ida*>(self);
        try {
            const lie::Klu& J = ida.equations.jacobian(t, map(y), map(ydot), c_j);
            std::copy(J.columns().begin(), J.columns().end(), SUNSparseMatrix_IndexPointers(out));
            std::copy(J.rows().begin(), J.rows().end(), SUNSparseMatrix_IndexValues(out));
            std::copy(J.value.begin(), J.value.end(), SUNSparseMatrix_Data(out));
            return 0;
        } catch (...) {
            ida.failure = std::current_exception();
            return -1;
        }
    }

    static void error_handler(int code, const char*, const char*, char* message, void* self) noexcept
    {
        if (code >= 0) return;  // a warning
        try {
            std::string& text = static_cast<Ida*>(self)->ida_message;
            text = message;
            std::replace(text.begin(), text.end(), '\n', ' ');
        } catch (...) {
        }
    }

    lie::Saddle K;
    bool (*const stop)();
    const double longest_step;
    const bool counts_turns;
    lie::SwitchSearch switches;
    const double rtol, atol;

    Owned<SUNContext, free_context> context;
    Vector y, ydot, tolerance, at_node;
    Owned<SUNMatrix, SUNMatDestroy> matrix;
    Owned<SUNLinearSolver, SUNLinSolFree> linear;
    std::unique_ptr<void, Destroy<free_ida>> ida_memory;

    double t = 0;  // time that the internal steps have reached [s]
    bool initialised = false;
    lie::State last;        // state that the last call returned
    bool has_last = false;  // whether `last` is valid
    lie::State
        internal;  // state at the end of the last internal step; updated only if there are discrete states
    lie::State counted;        // state of the last update of discrete and internal states
    lie::State before, after;  // the ends of the last internal step, if it is followed
    double at_break = 0;       // break point of time at the end of the next step; 0: none
    double last_length = 0;    // of the last internal step [s]
    double first_step_limit = infinity, first_step_taken = 0;  // [s]
    bool is_at_break = false;                                  // t is at a break point
    bool has_stepped = false;                                  // since the last start
    bool to_restart = false;  // restart from `internal` after the nodes before it have been interpolated
    lie::State updated;
    // For watch_rank(). A matrix of its own, because the pivots of K affect the last digits of a run.
    std::unique_ptr<lie::Saddle> watched;
    double condition_at_start = 0, last_condition_ratio = 0;
    int unwatched = 0;  // steps since the last factorisation for watch_rank()
    bool passed_singularity = false;
    lie::Statistics earlier;  // counts up to the last restart
    std::exception_ptr failure;
    std::string nonfinite;    // message of the last residual that was not finite, within check_interval steps
    std::string ida_message;  // last error message of IDA
};

IdaSolver::IdaSolver(const lie::System& system, const lie::Settings& settings, RpForm form)
    : mechanism(system), settings(checked(settings)), form(form)
{}

IdaSolver::~IdaSolver() = default;

int IdaSolver::advance(lie::State& x, double t_end)
{
    if (!ida) ida = std::make_unique<Ida>(mechanism, x, settings, form);
    return ida->advance(x, t_end);
}

lie::Statistics IdaSolver::statistics() const { return ida ? ida->statistics() : lie::Statistics{}; }

RankMonitor::Smallest IdaSolver::smallest_condition() const
{
    return ida ? ida->smallest_condition : RankMonitor::Smallest{};
}

lie::Trajectory ida(const lie::System& system, const lie::State& start, const std::vector<double>& instants,
                    double rtol, double atol)
{
    lie::Settings settings;
    settings.rtol = rtol;
    settings.atol = atol;
    IdaSolver solver(system, settings);
    lie::Trajectory run;
    lie::State x = start;
    for (const double instant : instants) {
        if (!(instant >= x.t))
            lie::reject("reference::ida",
                        "the instants must ascend and must not precede the start; instant after t = " +
                            std::to_string(x.t),
                        instant);
        if (instant > x.t) solver.advance(x, instant);
        run.row.push_back(x);
    }
    return run;
}

}  // namespace hilda::reference
