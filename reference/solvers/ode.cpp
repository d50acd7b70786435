// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/solvers/ode.hpp"

#include "lie/check.hpp"
#include "lie/system.hpp"
#include "reference/solvers/gsl_errors.hpp"

#include <gsl/gsl_odeiv2.h>

#include <algorithm>
#include <exception>
#include <new>
#include <utility>

namespace hilda::reference {

namespace {

std::string at(double t)
{
    std::ostringstream text;
    text.precision(9);
    text << "at t = " << t << " s";
    return text.str();
}

}  // namespace

struct Ode::Gsl {
    template <auto free>
    struct Free {
        template <class T>
        void operator()(T* p) const
        {
            free(p);
        }
    };

    RightHandSide f;
    std::exception_ptr failure;  // exception of f; it must not propagate through the C code of GSL
    long evaluations = 0;
    double h = 0;  // suggested size of the next step [s]

    std::unique_ptr<gsl_odeiv2_step, Free<gsl_odeiv2_step_free>> step;
    std::unique_ptr<gsl_odeiv2_control, Free<gsl_odeiv2_control_free>> control;
    std::unique_ptr<gsl_odeiv2_evolve, Free<gsl_odeiv2_evolve_free>> evolve;
    gsl_odeiv2_system system{};

    Gsl(size_t n, RightHandSide right_side, const OdeTolerance& tolerance)
        : f(std::move(right_side)), step(gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, n)),
          control(gsl_odeiv2_control_y_new(tolerance.absolute, tolerance.relative)),
          evolve(gsl_odeiv2_evolve_alloc(n)), system{call, nullptr, n, this}
    {
        if (!step || !control || !evolve) throw std::bad_alloc();
    }

    static int call(double t, const double* y, double* ydot, void* self) noexcept
    {
        Gsl& gsl = *static_cast<Gsl*>(self);
        try {
            ++gsl.evaluations;
            const auto n = static_cast<Eigen::Index>(gsl.system.dimension);
            Eigen::Map<Eigen::VectorXd> out(ydot, n);
            gsl.f(t, Eigen::Map<const Eigen::VectorXd>(y, n), out);
            if (!out.allFinite())
                throw lie::NonFinite("reference::Ode: the right-hand side is not finite " + at(t));
            return GSL_SUCCESS;
        } catch (...) {
            gsl.failure = std::current_exception();
            return GSL_EBADFUNC;  // the only code for which GSL does not retry with a shorter step
        }
    }
};

Ode::Ode(int n, RightHandSide f, const OdeTolerance& tolerance)
{
    if (n < 1) lie::reject("reference::Ode", "the number of unknowns must be at least one", n);
    for (const double eps : {tolerance.relative, tolerance.absolute})
        if (!(eps > 0)) lie::reject("reference::Ode", "tolerances must be positive", eps);
    disable_gsl_error_handler();
    gsl = std::make_unique<Gsl>(static_cast<size_t>(n), std::move(f), tolerance);
}

Ode::~Ode() = default;

long Ode::evaluations() const { return gsl->evaluations; }

void Ode::advance(double& t, VectorRef y, double t_end, const Observer& observer)
{
    if (!(t_end >= t))
        lie::reject("reference::Ode", "the end must not precede the current state " + at(t), t_end);
    if (t_end == t) return;
    if (gsl->h == 0) gsl->h = std::min(1e-3, t_end - t);
    gsl_odeiv2_evolve_reset(gsl->evolve.get());  // y may have been changed since the last call
    while (t < t_end) {
        const int code = gsl_odeiv2_evolve_apply(gsl->evolve.get(), gsl->control.get(), gsl->step.get(),
                                                 &gsl->system, &t, t_end, &gsl->h, y.data());
        if (gsl->failure) std::rethrow_exception(std::exchange(gsl->failure, nullptr));
        if (code != GSL_SUCCESS)
            throw lie::NumericalFailure("ode_failed", "reference::Ode: GSL's rk8pd failed " + at(t) +
                                                          " with a step of " + std::to_string(gsl->h) +
                                                          " s: " + gsl_strerror(code));
        if (observer) observer(t, y);
    }
}

}  // namespace hilda::reference
