// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/fitting/fit.hpp"

#include "io/error.hpp"
#include "io/json_source.hpp"
#include "io/message.hpp"
#include "io/option_values.hpp"
#include "io/progress.hpp"
#include "lie/check.hpp"
#include "lie/schemes.hpp"
#include "reference/solvers/least_squares.hpp"
#include "run/columns/output_columns.hpp"
#include "run/jobs/pool.hpp"

#include <Eigen/SVD>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace hilda::run {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
/// Ratio of singular values below which J, which has an error of about 1e-6, is taken as singular
constexpr double least_ratio = 1e-5;
/// Steps of differences relative to the scale: forward ones in the iteration, central ones at its end
constexpr double forward_step = 1e-6, central_step = 1e-4;

/// FitProblem::stop of the fit for which this thread computes a run
thread_local const std::atomic<bool>* stop_of_run = nullptr;

class Fit {
public:
    explicit Fit(const FitProblem& problem) : problem(problem), parameter(problem.parameters) {}

    FitResult result()
    {
        check();
        reference::LeastSquaresProblem least;
        for (const FitParameter& of : parameter)
            least.unknowns.push_back({.start = of.start, .low = of.low, .high = of.high, .scale = of.scale});
        least.residuals = [this](const VectorXd& p, VectorXd& r) { return residuals_or_none(p, r); };
        least.derivatives = [this](const VectorXd& p, const VectorXd& r, MatrixXd& J) {
            differences(p, r, J);
        };
        least.progress = [this](int iteration, double sum) { report(iteration, sum); };
        least.max_iterations = problem.max_iterations;
        const reference::LeastSquaresSolution solution = minimise(least);
        line.clear();

        FitResult all;
        all.iterations = solution.iterations;
        all.has_converged = solution.has_converged;
        all.reason = solution.reason;
        all.values = problem.data.number();
        all.degrees_of_freedom = all.values - static_cast<Index>(parameter.size());
        all.chi_squared = solution.residuals.squaredNorm();
        all.model = problem.read(changes(solution.p));
        all.samples = sample(all.model, problem.data.columns, problem.data.t, stoppable(problem.run));
        all.warnings = all.samples.warnings;
        all.units = units;
        estimate_errors(solution.p, solution.residuals, all);
        all.runs = runs;
        return all;
    }

private:
    /// Completes the scales.
    void check()
    {
        problem.data.check();
        if (parameter.empty()) throw io::UsageError("fit: there is no parameter to fit");
        std::vector<std::string> pointers;
        for (FitParameter& of : parameter) {
            if (!std::isfinite(of.start))
                lie::reject(of.pointer, "the start must be a finite number", of.start);
            if (of.scale == 0) of.scale = of.start == 0 ? 1 : std::abs(of.start);
            if (!(of.scale > 0) || !std::isfinite(of.scale))
                lie::reject(of.pointer, "the scale must be positive and finite", of.scale);
            if (!(of.low < of.start && of.start < of.high))
                throw lie::InvalidInput(
                    fmt::format("{}: the start must be between the bounds {} and {}, got {}", of.pointer,
                                of.low, of.high, of.start));
            if (std::find(pointers.begin(), pointers.end(), of.pointer) != pointers.end())
                throw io::UsageError("fit: " + of.pointer + " is given twice");
            pointers.push_back(of.pointer);
        }
        if (problem.data.number() < static_cast<long>(parameter.size()))
            throw lie::InvalidInput(fmt::format(
                "{}: has {} for {}", problem.data.source, io::counted(problem.data.number(), "value"),
                io::counted(static_cast<long>(parameter.size()), "parameter")));
        check_model();
    }

    /// The model with the start, and the units of its columns
    void check_model()
    {
        VectorXd start(static_cast<Index>(parameter.size()));
        for (size_t k = 0; k < parameter.size(); ++k) start[static_cast<Index>(k)] = parameter[k].start;
        const dae::Description model = problem.read(changes(start));
        const ObservedColumns observed(*model.model, model.outputs, problem.data.source,
                                       problem.data.columns);
        for (size_t c = 0; c < problem.data.columns.size(); ++c) units.push_back(observed.column(c).unit);
        weight = VectorXd::Ones(static_cast<Index>(problem.data.columns.size()));
        if (problem.sigma.empty()) {
            for (size_t c = 1; c < problem.data.columns.size(); ++c)
                if (units[c] != units[0])
                    throw io::UsageError(fmt::format(
                        "fit: the columns {} [{}] and {} [{}] have different units; --sigma states the "
                        "standard deviation of each",
                        problem.data.columns[0], units[0], problem.data.columns[c], units[c]));
            return;
        }
        if (problem.sigma.size() != problem.data.columns.size())
            throw io::UsageError(fmt::format("fit: {} standard deviations for {} columns",
                                             problem.sigma.size(), problem.data.columns.size()));
        for (size_t c = 0; c < problem.sigma.size(); ++c) {
            if (!(problem.sigma[c] > 0) || !std::isfinite(problem.sigma[c]))
                lie::reject(problem.data.columns[c], "the standard deviation must be positive and finite",
                            problem.sigma[c]);
            weight[static_cast<Index>(c)] = 1 / problem.sigma[c];
        }
    }

    std::vector<std::string> changes(const VectorXd& p) const
    {
        std::vector<std::string> all;
        for (size_t k = 0; k < parameter.size(); ++k)
            all.push_back(fmt::format("{}={:.17g}", parameter[k].pointer, p[static_cast<Index>(k)]));
        return all;
    }

    VectorXd residuals(const VectorXd& p, SampledRunOptions options)
    {
        ++runs;
        options = stoppable(options);
        const FitData& data = problem.data;
        dae::Description model = problem.read(changes(p));
        const MatrixXd values = sample(model, data.columns, data.t, options).values;
        VectorXd r(data.number());
        Index at = 0;
        for (Index c = 0; c < values.cols(); ++c)
            for (Index k = 0; k < values.rows(); ++k)
                if (!std::isnan(data.values(k, c))) r[at++] = weight[c] * (values(k, c) - data.values(k, c));
        return r;
    }

    /// The options of a run of this thread that ends when FitProblem::stop is true
    SampledRunOptions stoppable(SampledRunOptions options) const
    {
        stop_of_run = problem.stop;
        options.settings.stop = [] { return stop_of_run != nullptr && stop_of_run->load(); };
        return options;
    }

    bool residuals_or_none(const VectorXd& p, VectorXd& r)
    {
        const bool is_start = runs == 0;
        try {
            r = residuals(p, problem.run);
            return r.allFinite();
        } catch (const lie::Interrupted&) {
            throw;
        } catch (const lie::NumericalFailure& failure) {
            if (is_start) throw;
            refusal = failure.what();
        } catch (const lie::InvalidInput& invalid) {  // values that the model does not allow: a negative mass
            if (is_start) throw;
            refusal = invalid.what();
        } catch (const io::UsageError& unstable) {  // a step above the stability limit with these values
            if (is_start) throw;
            refusal = unstable.what();
        }
        return false;
    }

    /// The residuals of a run beside the present one; false if it fails
    bool can_compute(const VectorXd& p, VectorXd& r)
    {
        try {
            r = residuals(p, problem.run);
            return r.allFinite();
        } catch (const lie::Interrupted&) {
            throw;
        } catch (const lie::NumericalFailure&) {
        } catch (const lie::InvalidInput&) {
        } catch (const io::UsageError&) {
        }
        return false;
    }
    lie::NumericalFailure fails_beside(Index k) const
    {
        return {"fit_failed",
                "fit: the runs with other values of " + parameter[static_cast<size_t>(k)].pointer + " fail"};
    }

    /// Forward differences, or backward ones where the run fails
    void differences(const VectorXd& p, const VectorXd& r, MatrixXd& J)
    {
        Pool(problem.jobs, "", p.size()).run([&](long k) {
            const double d = step(p, k, forward_step);
            for (const double sign : {1., -1.}) {
                VectorXd x = p, at_x;
                x[k] += sign * d;
                if (!can_compute(x, at_x)) continue;
                J.col(k) = (at_x - r) / (x[k] - p[k]);
                return;
            }
            throw fails_beside(k);
        });
    }

    /// A step towards the farther bound, at most half of the way
    double step(const VectorXd& p, long k, double relative) const
    {
        const FitParameter& of = parameter[static_cast<size_t>(k)];
        const double up = of.high - p[k], down = p[k] - of.low;
        const double size = std::min(relative * std::max(of.scale, std::abs(p[k])), 0.5 * std::max(up, down));
        return up >= down ? size : -size;
    }

    /// Central differences; those of one side at a bound, or where the other run fails
    MatrixXd jacobian(const VectorXd& p, const VectorXd& r)
    {
        struct Side {
            VectorXd residuals;
            double at;
        };
        std::vector<Side> sides(2 * parameter.size());
        Pool(problem.jobs, "", static_cast<long>(sides.size())).run([&](long n) {
            const long k = n / 2;
            VectorXd x = p;
            x[k] += (n % 2 == 0 ? 1 : -1) * step(p, k, central_step);
            Side& side = sides[static_cast<size_t>(n)];
            side = {r, p[k]};
            const FitParameter& of = parameter[static_cast<size_t>(k)];
            if (!(of.low < x[k] && x[k] < of.high)) return;
            if (VectorXd at_x; can_compute(x, at_x)) side = {std::move(at_x), x[k]};
        });
        MatrixXd J(r.size(), p.size());
        for (Index k = 0; k < p.size(); ++k) {
            const Side &one = sides[static_cast<size_t>(2 * k)], &two = sides[static_cast<size_t>(2 * k + 1)];
            if (one.at == two.at) throw fails_beside(k);
            J.col(k) = (one.residuals - two.residuals) / (one.at - two.at);
        }
        return J;
    }

    void estimate_errors(const VectorXd& p, const VectorXd& r, FitResult& all)
    {
        VectorXd scale(p.size());
        for (Index k = 0; k < p.size(); ++k) {
            const double of_start = parameter[static_cast<size_t>(k)].scale;
            scale[k] = problem.parameters[static_cast<size_t>(k)].scale > 0
                           ? of_start
                           : std::max(1e-2 * of_start, std::abs(p[k]));
        }
        MatrixXd J;
        try {
            J = jacobian(p, r) * scale.asDiagonal();
        } catch (const lie::Interrupted&) {
            throw;
        } catch (const lie::NumericalFailure& failure) {
            all.warnings.push_back("the errors of the parameters are unknown: " +
                                   std::string(failure.what()));
            J = MatrixXd::Zero(r.size(), p.size());
            derivatives_are_known = false;
        }
        const Eigen::JacobiSVD<MatrixXd> svd(J, Eigen::ComputeThinU | Eigen::ComputeThinV);
        all.singular_values = svd.singularValues();
        all.directions = svd.matrixV();
        const double largest = all.singular_values[0];
        const long nu = all.degrees_of_freedom;
        all.sigma = nu > 0 ? std::sqrt(all.chi_squared / static_cast<double>(nu)) : nan;
        const double of_data = problem.sigma.empty() ? all.sigma : 1;
        VectorXd inverse(p.size());
        Index rank = 0;
        for (Index k = 0; k < p.size(); ++k) {
            const bool is_known = all.singular_values[k] > least_ratio * largest;
            if (is_known) ++rank;
            inverse[k] = is_known ? 1 / all.singular_values[k] : 0;
        }
        const MatrixXd spread = scale.asDiagonal() * svd.matrixV() * inverse.asDiagonal();
        all.covariance = of_data * of_data * spread * spread.transpose();
        const VectorXd bias = bias_of(p, r, spread * svd.matrixU().transpose(), all);
        const double factor =
            reference::confidence_factor(0.95, problem.sigma.empty() ? static_cast<double>(nu) : 0);
        for (Index k = 0; k < p.size(); ++k) {
            const FitParameter& of = parameter[static_cast<size_t>(k)];
            const double at_bound = 1e-6 * scale[k];
            FittedParameter one{.pointer = of.pointer, .value = p[k], .bias = bias[k]};
            one.at_bound = p[k] - of.low < at_bound || of.high - p[k] < at_bound;
            one.error = is_determined(all, rank, k) ? std::sqrt(all.covariance(k, k)) : nan;
            one.low_95 = p[k] - factor * one.error;
            one.high_95 = p[k] + factor * one.error;
            all.parameters.push_back(one);
        }
        add_warnings(all, rank);
    }

    /// Whether no undetermined direction has a part in parameter k
    static bool is_determined(const FitResult& all, Index rank, Index k)
    {
        return rank == all.directions.cols() ||
               all.directions.row(k).tail(all.directions.cols() - rank).cwiseAbs().maxCoeff() < 1e-3;
    }

    /// The estimated error of the estimate by the time steps
    VectorXd bias_of(const VectorXd& p, const VectorXd& r, const MatrixXd& pseudo_inverse, FitResult& all)
    {
        SampledRunOptions finer = problem.run;
        double missing = 1;  // the part of the error that remains in the finer run
        if (finer.scheme->adaptive) {
            const double atol = finer.settings.atol > 0 ? finer.settings.atol : finer.settings.rtol;
            finer.settings.rtol = std::max(1e-14, 1e-2 * finer.settings.rtol);
            finer.settings.atol = std::max(1e-14, 1e-2 * atol);
        } else {
            finer.step *= 0.5;
            missing = 1 / (1 - std::pow(0.5, finer.scheme->order));
        }
        try {
            return missing * pseudo_inverse * (residuals(p, finer) - r);
        } catch (const lie::Interrupted&) {
            throw;
        } catch (const std::exception& error) {
            all.warnings.push_back("the error by the time steps is unknown: the finer run fails: " +
                                   std::string(error.what()));
            return VectorXd::Constant(p.size(), nan);
        }
    }

    void add_warnings(FitResult& all, Index rank) const
    {
        const auto warn = [&](const std::string& what) { all.warnings.push_back(what); };
        if (!all.has_converged)
            warn(fmt::format("the minimum was not reached in {}: {}{}",
                             io::counted(all.iterations, "iteration"), all.reason,
                             refusal.empty() ? "" : "; the last failure: " + refusal));
        if (!derivatives_are_known) return;
        if (all.degrees_of_freedom == 0 && problem.sigma.empty())
            warn("there are as many parameters as values: the standard errors are unknown without --sigma");
        for (Index k = rank; k < all.directions.cols(); ++k) {
            std::string combination;
            for (Index i = 0; i < all.directions.rows(); ++i)
                if (std::abs(all.directions(i, k)) >= 0.05)
                    combination +=
                        fmt::format("{}{:.2f} {}", combination.empty() ? "" : ", ", all.directions(i, k),
                                    parameter[static_cast<size_t>(i)].pointer);
            warn("the data do not determine this combination of relative changes of the parameters: " +
                 combination);
        }
        for (const FittedParameter& of : all.parameters) {
            if (of.at_bound)
                warn(fmt::format("{} is at a bound: {:.6g}; its standard error has no meaning", of.pointer,
                                 of.value));
            if (std::abs(of.bias) > of.error)
                warn(fmt::format(
                    "the time steps change {} by about {:.1e}, more than its standard error "
                    "{:.1e}; use {}",
                    of.pointer, of.bias, of.error,
                    problem.run.scheme->adaptive ? "a smaller --rtol"
                                                 : "a smaller --step or an integrator with adaptive steps"));
        }
        const FitData& data = problem.data;
        for (size_t c = 0; c < data.columns.size(); ++c) {
            const double of_column = problem.sigma.empty() ? all.sigma : problem.sigma[c];
            if (const double error = all.samples.interpolation[static_cast<Index>(c)];
                error > 0.1 * of_column)
                warn(
                    fmt::format("the interpolation of {} between the nodes of a run has an error of about "
                                "{:.1e}, against a standard deviation of {:.1e}; use a smaller --step",
                                data.columns[c], error, of_column));
        }
        constexpr double excess = 3;  // of the residuals over the stated standard deviations
        if (!problem.sigma.empty() && all.sigma > excess)
            warn(fmt::format("the residuals are {:.1f} times as large as the standard deviations of the data",
                             all.sigma));
    }

    /// The remaining time is that of all iterations that are allowed.
    void report(int iteration, double sum)
    {
        line.completed(static_cast<double>(iteration) / problem.max_iterations);
        line.show(fmt::format("fit: iteration {} of at most {}, {}, chi^2 {:.6g}", iteration,
                              problem.max_iterations, io::counted(runs, "run"), sum));
    }

    const FitProblem& problem;
    std::vector<FitParameter> parameter;
    std::vector<std::string> units;     ///< of the columns
    VectorXd weight;                    ///< 1/σ of each column
    bool derivatives_are_known = true;  ///< at the minimum
    std::string refusal;                ///< why the last run without residuals has failed
    std::atomic<long> runs = 0;
    io::ProgressLine line{!problem.progress};
};

}  // namespace

double number_at(const dae::Description& model, const std::string& pointer)
{
    for (const auto& [name, value] : model.parameters)
        if (pointer == "/parameters/" + name) return value;
    const io::JsonSource source(model.text, model.name, model.text.size() + 1);
    const io::Json* at = &source.root;
    for (size_t begin = 1; begin <= pointer.size() && at != nullptr;) {
        const size_t end = std::min(pointer.find('/', begin), pointer.size());
        const std::string key = pointer.substr(begin, end - begin);
        const io::Json::Member* const member = at->member(key);
        const std::optional<size_t> index = io::number_in<size_t>(key);
        at = member != nullptr ? &member->value : index && *index < at->size() ? &at->at(*index) : nullptr;
        begin = end + 1;
    }
    if (at == nullptr || at->number() == nullptr)
        throw io::UsageError("fit: " + pointer + ": the model has no number there; state the start");
    return *at->number();
}

FitResult fit(const FitProblem& problem) { return Fit(problem).result(); }

}  // namespace hilda::run
