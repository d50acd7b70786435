// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/convergence_study.hpp"

#include <algorithm>

namespace hilda::studies {

Sweep<ErrorRun> ConvergenceStudy::runs(const StudyContext& study, const std::vector<Benchmark>& benchmarks,
                                       const Schemes& schemes, const std::vector<double>& steps,
                                       const std::function<void(ErrorRun&)>& errors) const
{
    Sweep<ErrorRun> all(benchmarks, schemes, steps);
    for (ErrorRun& run : all) {
        run.order.assign(norms.size(), std::nan(""));
        run.at_floor.assign(norms.size(), 0);
    }
    all.compute(study, errors);
    for (ErrorRun& run : all) run.error.resize(norms.size(), std::nan(""));  // of a run that has failed
    for (size_t k = 1; k < all.size(); ++k) {
        if (k % steps.size() == 0) continue;
        const ErrorRun& before = all[k - 1];
        for (size_t n = 0; n < norms.size(); ++n)
            if (before.at_floor[n] == 0 && all[k].at_floor[n] == 0)
                all[k].order[n] = order(before.h, before.error[n], all[k].h, all[k].error[n]);
    }
    return all;
}

double ConvergenceStudy::fit(const Series& series, size_t n) const
{
    std::vector<double> h, e;
    size_t asymptotic = 0;
    for (const ErrorRun* run : series) {
        if (run->failed() || run->at_floor[n] != 0) continue;
        h.push_back(run->h), e.push_back(run->error[n]);
        asymptotic += run->h <= asymptotic_step * (1 + 1e-9);
    }
    const size_t left_out = h.size() - std::min(h.size(), std::max(least_points, asymptotic));
    h.erase(h.begin(), h.begin() + static_cast<std::ptrdiff_t>(left_out));
    e.erase(e.begin(), e.begin() + static_cast<std::ptrdiff_t>(left_out));
    return fitted_order(h, e);
}

std::vector<std::string> ConvergenceStudy::keys() const
{
    std::vector<std::string> all = {"order"};
    for (const std::string& norm : norms) all.push_back("order_" + norm);
    all.insert(all.end(), norms.begin(), norms.end());
    return all;
}

Measured ConvergenceStudy::measured(const Series& series) const
{
    Measured m{.of = series.front()->scheme->name + " on " + series.front()->c->problem.name, .value = {}};
    m.value["order"] = std::nan("");
    for (size_t n = norms.size(); n-- > 0;) {
        const double order = fit(series, n);
        m.value["order_" + norms[n]] = order;
        m.value[norms[n]] = series.back()->error[n];
        if (!std::isnan(order)) m.value["order"] = order;
    }
    return m;
}

namespace {

/// A column for each norm, with the n-th value of a member of the run
template <class Values>
Columns<ErrorRun> of_norms(const std::vector<std::string>& norms, const std::string& prefix,
                           Values ErrorRun::*values)
{
    std::vector<Column<ErrorRun>> columns;
    for (size_t n = 0; n < norms.size(); ++n)
        columns.push_back({prefix + norms[n], [n, values](const ErrorRun& run) {
                               return static_cast<double>((run.*values)[n]);
                           }});
    return Columns<ErrorRun>(columns);
}

}  // namespace

Columns<ErrorRun> ConvergenceStudy::errors() const
{
    return of_norms(norms, prefix_of_errors, &ErrorRun::error);
}
Columns<ErrorRun> ConvergenceStudy::orders() const { return of_norms(norms, "order_", &ErrorRun::order); }
Columns<ErrorRun> ConvergenceStudy::floors() const { return of_norms(norms, "floor_", &ErrorRun::at_floor); }

io::Json ConvergenceStudy::json(const Series& series, const Columns<ErrorRun>& columns,
                                const std::vector<std::string>& more, const io::Json& more_of_series) const
{
    const ErrorRun& first = *series.front();
    io::Json fits = io::Json::object(), rows = io::Json::array();
    for (size_t n = 0; n < norms.size(); ++n) fits[norms[n]] = fit(series, n);
    for (const ErrorRun* run : series) {
        io::Json row = {{"h", run->h}, {"status", run->status}};
        if (!run->message.empty()) row["message"] = run->message;
        for (size_t n = 0; n < norms.size(); ++n) row[norms[n]] = run->error[n];
        rows.push_back(more.empty() ? row : columns.json(*run, more, row));
    }
    io::Json out = {{"problem", first.c->problem.name}, {"integrator", first.scheme->name}};
    out.update(more_of_series);
    out["fitted_order"] = fits;
    out["rows"] = rows;
    return out;
}

}  // namespace hilda::studies
