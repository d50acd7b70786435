// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/fitting/sampled_run.hpp"

#include "lie/check.hpp"
#include "lie/schemes.hpp"
#include "lie/trajectory.hpp"
#include "run/columns/output_columns.hpp"
#include "run/simulation.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::run {

namespace {

/// Relative difference of two instants that are the same
constexpr double same = 1e-9;

/// The columns at all nodes, row by row
class Nodes final : public lie::Observer {
public:
    /// `nodes`: their number
    Nodes(ObservedColumns& columns, size_t number, size_t nodes, const dae::Model& model, bool (*stop)())
        : columns(columns), number(number), model(model), stop(stop)
    {
        t.reserve(nodes), values.reserve(nodes * number);  // a step does not allocate memory
    }

    void accepted(const lie::State& x, long n, int /*iterations*/) override
    {
        if (stop != nullptr && stop()) throw lie::Interrupted();
        if (n < static_cast<long>(t.size())) return;  // passed before
        t.push_back(x.t);
        values.resize(values.size() + number);
        columns.values(x, values.data() + values.size() - number);
        dae::check_dropped_rows(model, x);
    }

    std::vector<double> t, values;

private:
    ObservedColumns& columns;
    const size_t number;
    const dae::Model& model;
    bool (*const stop)();
};

/// Weights of the values at the nodes first, ..., first + count - 1 in their polynomial at t
void lagrange(const std::vector<double>& node, size_t first, size_t count, double t, double* weight)
{
    for (size_t i = 0; i < count; ++i) {
        weight[i] = 1;
        for (size_t j = 0; j < count; ++j)
            if (j != i) weight[i] *= (t - node[first + j]) / (node[first + i] - node[first + j]);
    }
}

/// First of `count` nodes about the interval that ends at node `next`
size_t first_of(size_t next, size_t count, size_t nodes)
{
    const size_t half = count / 2;
    return std::min(next > half ? next - half : 0, nodes - count);
}

}  // namespace

double interval_of(const std::vector<double>& t)
{
    std::vector<double> d;
    for (size_t k = 0; k < t.size(); ++k) d.push_back(k == 0 ? t[0] : t[k] - t[k - 1]);
    if (d.front() == 0) d.erase(d.begin());
    const double least = *std::min_element(d.begin(), d.end());
    const double most = 100. * static_cast<double>(t.size()) + 1000;  // nodes
    const bool are_multiples =
        t.back() / least <= most && std::all_of(t.begin(), t.end(), [&](double at) {
            return std::abs(at / least - std::round(at / least)) <= same * std::max(1., at / least);
        });
    if (are_multiples) return least;
    std::nth_element(d.begin(), d.begin() + static_cast<std::ptrdiff_t>(d.size() / 2), d.end());
    return std::max(0.25 * d[d.size() / 2], t.back() / most);
}

Samples sample(dae::Description& model, const std::vector<std::string>& columns, const std::vector<double>& t,
               const SampledRunOptions& options)
{
    const lie::Scheme& scheme = *options.scheme;
    dae::start(model, {.fix_initial = options.fix_initial});
    const dae::Model& system = *model.model;
    // The last instant is a node: a prescribed motion may end there.
    const double wanted = scheme.adaptive ? interval_of(t) : options.step;
    const double h = t.back() / std::ceil(t.back() / wanted * (1 - same));
    lie::TimeGrid grid = lie::TimeGrid::over(t.back(), h);
    grid.interval = std::max(1L, grid.steps);
    Simulation simulation(
        {.model = system, .start = model.x, .scheme = scheme, .grid = grid, .settings = options.settings});
    ObservedColumns observed(system, model.outputs, "fit", columns);
    Nodes nodes(observed, columns.size(), static_cast<size_t>(grid.steps) + 1, system, options.settings.stop);
    simulation.observe(nodes);
    simulation.run().throw_failure();

    Samples samples{.values = Eigen::MatrixXd(static_cast<Eigen::Index>(t.size()),
                                              static_cast<Eigen::Index>(columns.size())),
                    .interpolation = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(columns.size())),
                    .warnings = {}};
    const size_t count = nodes.t.size(), high = std::min<size_t>(8, count), low = std::min<size_t>(6, count);
    for (size_t k = 0; k < t.size(); ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        const auto next = static_cast<size_t>(
            std::lower_bound(nodes.t.begin(), nodes.t.end(), t[k] - same * h) - nodes.t.begin());
        const size_t at = std::min(next, count - 1);
        double weight[8], coarse[8];
        const bool is_node = std::abs(nodes.t[at] - t[k]) <= same * h;
        const size_t first = is_node ? at : first_of(next, high, count),
                     coarse_first = first_of(next, low, count);
        if (!is_node) {
            lagrange(nodes.t, first, high, t[k], weight);
            lagrange(nodes.t, coarse_first, low, t[k], coarse);
        }
        for (size_t c = 0; c < columns.size(); ++c) {
            const auto value = [&](size_t n) { return nodes.values[n * columns.size() + c]; };
            const auto column = static_cast<Eigen::Index>(c);
            if (is_node) {
                samples.values(row, column) = value(at);
                continue;
            }
            double sum = 0, other = 0;
            for (size_t n = 0; n < high; ++n) sum += weight[n] * value(first + n);
            for (size_t n = 0; n < low; ++n) other += coarse[n] * value(coarse_first + n);
            samples.values(row, column) = sum;
            double& error = samples.interpolation[column];
            error = std::max(error, std::abs(sum - other));
        }
    }
    for (const Finding& found : simulation.findings_of_solution()) samples.warnings.push_back(found.text);
    return samples;
}

}  // namespace hilda::run
