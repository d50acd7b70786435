// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/solvers/ida_solver.hpp"

#include "dae/start.hpp"
#include "reference/solvers/consistent.hpp"

#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_klu.h>
#include <sunmatrix/sunmatrix_sparse.h>

#include <algorithm>
#include <exception>
#include <limits>
#include <new>
#include <utility>

namespace hilda::reference {

namespace {

// A run that needs more steps than this between two nodes does not get anywhere; nor does one that comes less
// far than this part of the way in so many steps.
constexpr long most_steps = 5'000'000, some_steps = 1000;
constexpr double crawl = 1e-9;

// IDA bounds the error of a step, and a run adds up thousands of them: a step gets a tenth of what is asked
// for. Below the least, rounding decides on the steps: ten times as many, and no digit won.
constexpr double part_of_step = 0.1, least = 2e-14;

// What Newton's method may leave, as a part of what a step may be off by. IDA's own 0.33 disturbs its estimates
// of the error, on which it decides: twice the steps at 1e-12, and a larger error. But never below rounding.
constexpr double newton_part = 0.01, rounding = 3e-15;

template <auto destroy>
struct Destroy {
    template <class T>
    void operator()(T* p) const
    {
        destroy(p);
    }
};

void free_context(SUNContext context) { SUNContext_Free(&context); }
void free_ida(void* memory) { IDAFree(&memory); }

template <class Handle, auto destroy>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Destroy<destroy>>;

template <class Handle>
Handle some(Handle handle)
{
    if (handle == nullptr) throw std::bad_alloc();
    return handle;
}

Eigen::Map<Eigen::VectorXd> map(N_Vector v) { return {N_VGetArrayPointer(v), N_VGetLength(v)}; }

std::string number(double value)
{
    std::ostringstream text;
    text.precision(9);
    text << value;
    return text.str();
}

SUNContext new_context()
{
    SUNContext context = nullptr;
    if (SUNContext_Create(nullptr, &context) != 0) throw std::bad_alloc();
    return context;
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

/// All that belongs to SUNDIALS. Members are freed from the last to the first.
class IdaSolver::Ida {
public:
    Ida(const lie::System& system, const lie::State& start, const lie::Settings& settings, RpForm form)
        : equations(system, start, form), system(system), K(system), stop(settings.stop),
          rtol(std::max(least, part_of_step * settings.rtol)),
          atol(settings.atol > 0 ? std::max(least, part_of_step * settings.atol) : rtol),
          context(new_context()), y(new_vector()), ydot(new_vector()), tolerance(new_vector()),
          at_node(new_vector()),
          matrix(
              some(SUNSparseMatrix(equations.size(), equations.size(), entries(), CSC_MAT, context.get()))),
          linear(some(SUNLinSol_KLU(y.get(), matrix.get(), context.get()))),
          memory(some(IDACreate(context.get())))
    {}

    int advance(lie::State& x, double t_end)
    {
        if (!(t_end > x.t) || !std::isfinite(t_end))
            lie::reject("reference::IdaSolver", "the end must be finite and after t = " + number(x.t) + " s",
                        t_end);
        if (!x.internal_state.empty())
            lie::reject("reference::IdaSolver",
                        "what remembers real numbers from step to step jumps there, and needs a scheme of "
                        "fixed steps; numbers remembered",
                        x.internal_state.size());
        const long before = statistics().iterations;
        const bool goes_on = valid && is_left(x);
        valid = false;  // until it is reached
        nonfinite.clear();
        if (!goes_on) start(x, t_end);
        double mark = t;
        for (long n = 1; t < t_end; ++n) {
            if (stop != nullptr && stop()) throw lie::Interrupted();
            if (to_restart) start(inner, t_end);
            inner_step(t_end);
            if (n % some_steps != 0) continue;
            if (n >= most_steps || t - mark < crawl * (t_end - x.t)) give_up(n);
            mark = t;
            nonfinite.clear();
        }

        left = x;
        if (t == t_end) {
            equations.read(t_end, map(y.get()), left);
        } else {
            check(IDAGetDky(memory.get(), t_end, 0, at_node.get()), "IDAGetDky");
            equations.read(t_end, map(at_node.get()), left);
        }
        left.discrete_state = inner.discrete_state;
        left.discrete_state = updated_internal_state(left).discrete_state;
        dae::solve_accelerations(system, K, left);
        valid = true;
        x = left;
        return static_cast<int>(statistics().iterations - before);
    }

    lie::Statistics statistics() const
    {
        lie::Statistics s = finished;
        if (!initialised) return s;
        long steps = 0, iterations = 0, setups = 0;
        IDAGetNumSteps(memory.get(), &steps);
        IDAGetNumNonlinSolvIters(memory.get(), &iterations);
        IDAGetNumLinSolvSetups(memory.get(), &setups);
        s.steps += steps;
        s.iterations += iterations;
        s.factorizations += setups;
        return s;
    }

    RpEquations equations;
    const lie::System& system;

private:
    using Vector = Owned<N_Vector, N_VDestroy>;

    Vector new_vector() const { return Vector(some(N_VNew_Serial(equations.size(), context.get()))); }
    sunindextype entries() const { return static_cast<sunindextype>(equations.pattern().value.size()); }

    /// Whether x is the state that the last call left. Its multipliers may have been changed for another branch
    /// of a driver, and its time been rounded.
    bool is_left(const lie::State& x) const
    {
        if (std::abs(x.t - left.t) > 1e-13 * std::max(1.0, std::abs(x.t)) ||
            x.discrete_state != left.discrete_state || x.body.size() != left.body.size())
            return false;
        for (size_t b = 0; b < x.body.size(); ++b) {
            const lie::Motion &a = x.body[b], &c = left.body[b];
            if (a.r != c.r || a.A != c.A || a.rdot != c.rdot || a.omega_bar != c.omega_bar) return false;
        }
        return true;
    }

    /// The state as it is once the system has been told of it, on its constraints. Without memory: as it is.
    const lie::State& updated_internal_state(const lie::State& x)
    {
        told = x;
        if (x.discrete_state.empty()) return told;
        project(system, K, told);
        if (told.lambda.size() != system.rows()) told.lambda.setZero(system.rows());
        const lie::State before = told;
        system.accepted(before, told);
        return told;
    }

    void start(const lie::State& x, double t_end)
    {
        lie::State from = x;
        project(system, K, from);
        dae::solve_accelerations(system, K, from);
        equations.write(from, map(y.get()), map(ydot.get()));
        inner = from;
        t = from.t;
        to_restart = false;
        finished = statistics();
        if (initialised) {
            check(IDAReInit(memory.get(), t, y.get(), ydot.get()), "IDAReInit");
        } else {
            set_up(from);
        }
        check(IDASetInitStep(memory.get(), first_step(t_end - t)), "IDASetInitStep");
    }

    void set_up(const lie::State& from)
    {
        // Multipliers are in the Newton test, but not in the error test, which would stall on them at index 2.
        double weight = 0;
        lie::Loads load(system.bodies());
        system.loads(from, load);
        for (int b = 0; b < system.bodies(); ++b)
            weight = std::max({weight, load.F[b].norm(), load.n_bar[b].norm(),
                               system.mass().m[b] * std::max(1.0, from.body[b].rddot.norm())});
        check(IDASetErrHandlerFn(memory.get(), complain, this), "IDASetErrHandlerFn");
        check(IDAInit(memory.get(), residual, t, y.get(), ydot.get()), "IDAInit");
        initialised = true;
        check(IDASetUserData(memory.get(), this), "IDASetUserData");
        Vector id = new_vector();
        auto differential = map(id.get()), tolerances = map(tolerance.get());
        for (int k = 0; k < equations.size(); ++k) {
            const RpEquations::Kind kind = equations.kind(k);
            const bool moves = kind == RpEquations::Kind::position || kind == RpEquations::Kind::velocity;
            differential[k] = moves ? 1 : 0;
            tolerances[k] = moves ? atol : kind == RpEquations::Kind::lambda ? 1e-4 * weight : 1;
        }
        check(IDASVtolerances(memory.get(), rtol, tolerance.get()), "IDASVtolerances");
        check(IDASetId(memory.get(), id.get()), "IDASetId");
        check(IDASetSuppressAlg(memory.get(), SUNTRUE), "IDASetSuppressAlg");
        check(IDASetNonlinConvCoef(memory.get(), std::max(newton_part, rounding / rtol)),
              "IDASetNonlinConvCoef");
        check(IDASetLinearSolver(memory.get(), linear.get(), matrix.get()), "IDASetLinearSolver");
        check(IDASetJacFn(memory.get(), jacobian), "IDASetJacFn");
        // The pattern is symmetric, and a single block. COLAMD, which SUNDIALS would take, fills twice as much.
        constexpr int amd = 0;
        SUNLinSol_KLUGetCommon(linear.get())->btf = 0;
        if (SUNLinSol_KLUSetOrdering(linear.get(), amd) != 0) throw std::bad_alloc();
    }

    /// With which the first step, an implicit Euler step, is off by about the tolerance. IDA's own choice moves
    /// by half the tolerance, which at 1e-12 is a step of 1e-14 s: its multipliers drown in rounding.
    double first_step(double h) const
    {
        const auto at_start = map(y.get()), rate = map(ydot.get());
        double sum = 0;
        for (int k = 0; k < equations.size(); ++k)
            if (equations.kind(k) == RpEquations::Kind::velocity) {
                const double e = rate[k] / (rtol * std::abs(at_start[k - 7]) + atol);
                sum += e * e;
            }
        const double norm = std::sqrt(sum / equations.size());
        return std::min({0.5 / std::sqrt(std::max(norm, 1e-300)), 1e-3, h});
    }

    void inner_step(double t_end)
    {
        const int code = IDASolve(memory.get(), t_end, &t, y.get(), ydot.get(), IDA_ONE_STEP);
        if (failure) std::rethrow_exception(std::exchange(failure, nullptr));
        if (code < 0 && !nonfinite.empty()) throw lie::NonFinite(nonfinite);
        check(code, "IDASolve");
        if (inner.discrete_state.empty()) return;
        equations.read(t, map(y.get()), inner);
        const lie::State& now = updated_internal_state(inner);
        if (now.discrete_state == inner.discrete_state) return;
        inner = now;
        to_restart = !equations.set_discrete_state(inner.discrete_state, t, map(y.get()), map(ydot.get()));
    }

    [[noreturn]] void give_up(long steps) const
    {
        if (!nonfinite.empty()) throw lie::NonFinite(nonfinite);
        throw lie::NumericalFailure("ida_failed",
                                    "IDA does not get on: after " + std::to_string(steps) +
                                        " steps from one node to the next it is at t = " + number(t) +
                                        " s, with a step of " + number(last_step()) + " s");
    }

    double last_step() const
    {
        double h = 0;
        IDAGetCurrentStep(memory.get(), &h);
        return h;
    }

    void check(int code, const char* function)
    {
        if (code >= 0) {
            complaint.clear();
            return;
        }
        const std::unique_ptr<char, Destroy<std::free>> name(IDAGetReturnFlagName(code));
        std::string text = std::string("IDA gave up at t = ") + number(t) + " s with step " +
                           number(last_step()) + " s: " + name.get() + " in " + function;
        if (!complaint.empty()) text += ": " + std::exchange(complaint, {});
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
            return 1;  // a shorter step may do
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

    static void complain(int code, const char*, const char*, char* message, void* self) noexcept
    {
        if (code >= 0) return;  // a warning
        try {
            std::string& text = static_cast<Ida*>(self)->complaint;
            text = message;
            std::replace(text.begin(), text.end(), '\n', ' ');
        } catch (...) {
        }
    }

    lie::Saddle K;
    bool (*const stop)();
    const double rtol, atol;

    Owned<SUNContext, free_context> context;
    Vector y, ydot, tolerance, at_node;
    Owned<SUNMatrix, SUNMatDestroy> matrix;
    Owned<SUNLinearSolver, SUNLinSolFree> linear;
    std::unique_ptr<void, Destroy<free_ida>> memory;

    double t = 0;  // how far IDA has come
    bool initialised = false;
    lie::State left;          // what the last call returned
    bool valid = false;       // whether there is one
    lie::State inner;         // where IDA stands; kept up to date only where there is memory
    bool to_restart = false;  // from `inner`, once the nodes before it are served
    lie::State told;
    lie::Statistics finished;  // of the runs before the last start
    std::exception_ptr failure;
    std::string nonfinite;  // where the residual was, among the last some_steps steps
    std::string complaint;  // IDA's
};

IdaSolver::IdaSolver(const lie::System& system, const lie::Settings& settings, RpForm form)
    : of(system), settings(checked(settings)), form(form)
{}

IdaSolver::~IdaSolver() = default;

int IdaSolver::advance(lie::State& x, double t_end)
{
    if (!ida) ida = std::make_unique<Ida>(of, x, settings, form);
    return ida->advance(x, t_end);
}

lie::Statistics IdaSolver::statistics() const { return ida ? ida->statistics() : lie::Statistics{}; }

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
                        "instants must ascend and not be before the start; after " + std::to_string(x.t),
                        instant);
        if (instant > x.t) solver.advance(x, instant);
        run.row.push_back(x);
    }
    return run;
}

}  // namespace hilda::reference
