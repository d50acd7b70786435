// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/solvers/least_squares.hpp"

#include "lie/check.hpp"
#include "reference/solvers/gsl_errors.hpp"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_multifit_nlinear.h>

#include <cmath>
#include <exception>
#include <memory>
#include <string>

namespace hilda::reference {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double least_gradient = 1e-20;  ///< of the residuals in units of their norm at the start

/// Whether a bound is near enough for the transformation. One that is farther away would take the digits of
/// the unknown; values beyond it are refused.
bool is_near(double bound, const BoundedUnknown& of) { return std::abs(bound - of.start) < 1e6 * of.scale; }
bool has_low(const BoundedUnknown& of) { return is_near(of.low, of); }
bool has_high(const BoundedUnknown& of) { return is_near(of.high, of); }

/// The unknown and its derivative by the free variable x; x = 0 at the start without bounds
double bounded(const BoundedUnknown& of, double x, double& slope)
{
    if (has_low(of) && has_high(of)) {
        const double range = of.high - of.low, sine = std::sin(x);
        slope = range * std::sin(2 * x);
        return of.low + range * sine * sine;
    }
    if (has_low(of) || has_high(of)) {
        const double root = std::hypot(x, 1), sign = has_low(of) ? 1 : -1;
        slope = sign * of.scale * x / root;
        return (has_low(of) ? of.low : of.high) + sign * of.scale * (x / (root + 1) * x);
    }
    slope = of.scale;
    return of.start + of.scale * x;
}

double free_start(const BoundedUnknown& of)
{
    if (has_low(of) && has_high(of)) return std::asin(std::sqrt((of.start - of.low) / (of.high - of.low)));
    if (has_low(of) || has_high(of)) {
        const double distance = std::abs(of.start - (has_low(of) ? of.low : of.high)) / of.scale;
        return std::sqrt(distance * (distance + 2));
    }
    return 0;
}

/// What the functions of GSL call. An exception is stored and rethrown after the call.
class Calls {
public:
    explicit Calls(const LeastSquaresProblem& problem) : problem(problem), slope(unknowns()), p(unknowns()) {}

    Eigen::Index unknowns() const { return static_cast<Eigen::Index>(problem.unknowns.size()); }

    void set(const gsl_vector* x)
    {
        for (Eigen::Index k = 0; k < unknowns(); ++k)
            p[k] = bounded(problem.unknowns[static_cast<size_t>(k)],
                           gsl_vector_get(x, static_cast<size_t>(k)), slope[k]);
    }

    bool is_allowed() const
    {
        for (Eigen::Index k = 0; k < unknowns(); ++k) {
            const BoundedUnknown& of = problem.unknowns[static_cast<size_t>(k)];
            if (!(of.low <= p[k] && p[k] <= of.high)) return false;
        }
        return true;
    }

    static int residuals(const gsl_vector* x, void* self, gsl_vector* f)
    {
        auto& calls = *static_cast<Calls*>(self);
        return calls.guard([&] {
            calls.set(x);
            VectorXd& r = calls.last;
            r.resize(static_cast<Eigen::Index>(f->size));
            if (calls.is_allowed() && calls.problem.residuals(calls.p, r) && r.allFinite()) {
                calls.largest = std::max(calls.largest, r.norm());
                calls.last_p = calls.p;
            } else {  // the step is refused: this sum of squares is far above any other
                r.setConstant(1e3 * calls.largest);
                ++calls.refused;
                calls.last_p.resize(0);
            }
            for (Eigen::Index k = 0; k < r.size(); ++k)
                gsl_vector_set(f, static_cast<size_t>(k), r[k] / calls.unit);
        });
    }

    static int derivatives(const gsl_vector* x, void* self, gsl_matrix* of)
    {
        auto& calls = *static_cast<Calls*>(self);
        return calls.guard([&] {
            calls.set(x);
            VectorXd& r = calls.last;  // GSL asks for derivatives where it has asked for the residuals
            if (calls.last_p.size() != calls.p.size() || calls.last_p != calls.p) {
                if (!calls.problem.residuals(calls.p, r))
                    throw lie::NumericalFailure("fit_failed", "the residuals cannot be computed");
                calls.last_p = calls.p;
            }
            MatrixXd J(r.size(), calls.unknowns());
            calls.problem.derivatives(calls.p, r, J);
            for (Eigen::Index i = 0; i < J.rows(); ++i)
                for (Eigen::Index k = 0; k < J.cols(); ++k)
                    gsl_matrix_set(of, static_cast<size_t>(i), static_cast<size_t>(k),
                                   J(i, k) * calls.slope[k] / calls.unit);
        });
    }

    const LeastSquaresProblem& problem;
    VectorXd slope, p;
    VectorXd last_p, last;  ///< the last unknowns and their residuals
    double largest = 0;
    /// GSL gets the residuals divided by their norm at the start: its tests are not free of their scale.
    double unit = 1;
    int refused = 0;  ///< number of trial steps without residuals
    std::exception_ptr error;

private:
    template <class Function>
    int guard(const Function& function)
    {
        try {
            function();
            return GSL_SUCCESS;
        } catch (...) {  // GSL is C
            error = std::current_exception();
            return GSL_EFAILED;
        }
    }
};

double sum_of_squares(const gsl_vector* f)
{
    double sum = 0;
    for (size_t k = 0; k < f->size; ++k) sum += gsl_vector_get(f, k) * gsl_vector_get(f, k);
    return sum;
}

void check(const LeastSquaresProblem& problem)
{
    for (size_t k = 0; k < problem.unknowns.size(); ++k) {
        const BoundedUnknown& of = problem.unknowns[k];
        const std::string what = "unknown " + std::to_string(k + 1);
        if (!(of.scale > 0) || !std::isfinite(of.scale))
            lie::reject(what, "the scale must be positive and finite", of.scale);
        if (!(of.low < of.start && of.start < of.high) || !std::isfinite(of.start))
            lie::reject(what, "the start must be finite and between the bounds", of.start);
    }
}

}  // namespace

LeastSquaresSolution minimise(const LeastSquaresProblem& problem)
{
    disable_gsl_error_handler();
    check(problem);
    Calls calls(problem);
    VectorXd start(calls.unknowns()), r;
    for (Eigen::Index k = 0; k < start.size(); ++k) start[k] = problem.unknowns[static_cast<size_t>(k)].start;
    if (!problem.residuals(start, r) || !r.allFinite())
        throw lie::NumericalFailure("fit_start",
                                    "the residuals cannot be computed at the start of the unknowns");
    if (r.size() < start.size())
        lie::reject("least squares", "there must be as many residuals as unknowns or more", r.size());
    if (r.norm() > 0) calls.unit = r.norm();
    calls.largest = calls.unit;

    const auto n = static_cast<size_t>(r.size()), unknowns = static_cast<size_t>(start.size());
    gsl_multifit_nlinear_parameters parameters = gsl_multifit_nlinear_default_parameters();
    parameters.trs = gsl_multifit_nlinear_trs_lm;
    parameters.solver = gsl_multifit_nlinear_solver_svd;
    const std::unique_ptr<gsl_multifit_nlinear_workspace, void (*)(gsl_multifit_nlinear_workspace*)> work(
        gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &parameters, n, unknowns),
        gsl_multifit_nlinear_free);
    const std::unique_ptr<gsl_vector, void (*)(gsl_vector*)> x(gsl_vector_alloc(unknowns), gsl_vector_free);
    if (!work || !x) throw std::bad_alloc();
    for (size_t k = 0; k < unknowns; ++k) gsl_vector_set(x.get(), k, free_start(problem.unknowns[k]));

    gsl_multifit_nlinear_fdf functions = {.f = &Calls::residuals,
                                          .df = &Calls::derivatives,
                                          .fvv = nullptr,
                                          .n = n,
                                          .p = unknowns,
                                          .params = &calls,
                                          .nevalf = 0,
                                          .nevaldf = 0,
                                          .nevalfvv = 0};
    const auto rethrow = [&] {
        if (calls.error) std::rethrow_exception(calls.error);
    };
    LeastSquaresSolution solution;
    int status = gsl_multifit_nlinear_init(x.get(), &functions, work.get());
    rethrow();
    int info = 0;
    double before = r.squaredNorm();  // the sum of squares at the last start of the trust region
    while (status == GSL_SUCCESS && info == 0 && solution.iterations < problem.max_iterations) {
        calls.refused = 0;
        status = gsl_multifit_nlinear_iterate(work.get());
        rethrow();
        ++solution.iterations;
        const double sum =
            calls.unit * calls.unit * sum_of_squares(gsl_multifit_nlinear_residual(work.get()));
        problem.progress(solution.iterations, sum);
        gsl_multifit_nlinear_test(problem.tolerance, least_gradient, 0, &info, work.get());
        // Refused trial steps leave a small trust region, in which each step is small. It starts again, as
        // long as that reduces the sum of squares.
        if (calls.refused == 0 || info == 2 || (info == 0 && status == GSL_SUCCESS)) continue;
        if (!(sum < before * (1 - 1e-6))) {
            solution.reason = "the model fails beside the last values";
            break;
        }
        before = sum;
        info = 0;
        gsl_vector_memcpy(x.get(), gsl_multifit_nlinear_position(work.get()));
        status = gsl_multifit_nlinear_init(x.get(), &functions, work.get());
        rethrow();
    }
    if (*solution.reason == '\0') {
        // GSL_ENOPROG: no trial step reduces the sum of squares. That is its minimum within rounding.
        solution.has_converged = info != 0 || status == GSL_ENOPROG;
        solution.reason = info == 1               ? "small step"
                          : info != 0             ? "small gradient"
                          : status == GSL_ENOPROG ? "no further decrease"
                          : status == GSL_SUCCESS ? "largest number of iterations"
                                                  : gsl_strerror(status);
    }
    calls.set(gsl_multifit_nlinear_position(work.get()));
    solution.p = calls.p;
    solution.residuals.resize(r.size());
    const gsl_vector* const f = gsl_multifit_nlinear_residual(work.get());
    for (size_t k = 0; k < n; ++k)
        solution.residuals[static_cast<Eigen::Index>(k)] = calls.unit * gsl_vector_get(f, k);
    return solution;
}

double confidence_factor(double level, double nu)
{
    const double p = 0.5 * (1 + level);
    return nu > 0 ? gsl_cdf_tdist_Pinv(p, nu) : gsl_cdf_ugaussian_Pinv(p);
}

}  // namespace hilda::reference
