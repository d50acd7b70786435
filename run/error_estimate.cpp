// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/error_estimate.hpp"

#include "run/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hilda::run {

namespace {

/// Largest product of steps and bodies for which the run with h/4 is made; some seconds
constexpr double cheap = 2e6;

/// Largest difference between the declared and the observed order of a reliable estimate
constexpr double allowed = 0.5;

/// Angle of the rotation between two orientations [rad]: |A - B|_F = 2 sqrt(2) sin(angle/2)
double angle(const lie::Mat3& A, const lie::Mat3& B)
{
    return 2 * std::asin(std::min(1.0, (A - B).norm() / std::sqrt(8.0)));
}

}  // namespace

/// A run with a fraction of the step, advanced to the nodes of the run that it is compared with
class RefinedRuns::Finer final : public lie::Observer {
public:
    Finer(const dae::Model& model, const lie::State& x, const lie::Scheme& scheme,
          const lie::Settings& settings, const lie::TimeGrid& grid, int parts)
        : simulation(
              {.model = model,
               .start = x,
               .scheme = scheme,
               .grid = {.h = grid.h / parts, .steps = grid.steps * parts, .interval = grid.interval * parts},
               .settings = settings,
               .accept_unstable = true}),  // the run with h was checked
          parts(parts)
    {
        simulation.observe_checked(*this);
    }

    /// The complete state at node n of the run with h
    const lie::State& at(long n)
    {
        target = n * parts;
        while (complete < target && simulation.step()) {
        }
        if (complete < target) simulation.run().throw_failure();
        return node;
    }

    void accepted(const lie::State& x, long n, int) override
    {
        complete = n;
        if (n == target) node = x;
    }

private:
    Simulation simulation;
    const long parts;
    long target = 0, complete = -1;
    lie::State node;
};

RefinedRuns::RefinedRuns(const dae::Model& model, const lie::State& x, const lie::Scheme& scheme,
                         const lie::Settings& settings, const lie::TimeGrid& grid)
    : model(model), scheme(scheme), grid(grid), tolerance(settings.tolerance),
      half(std::make_unique<Finer>(model, x, scheme, settings, grid, 2)), C(model.pattern())
{
    if (4 * static_cast<double>(grid.steps) * model.bodies() <= cheap)
        quarter = std::make_unique<Finer>(model, x, scheme, settings, grid, 4);
}

RefinedRuns::~RefinedRuns() = default;

void RefinedRuns::accepted(const lie::State& x, long n, int)
{
    if (!grid.is_row(n) || !failure.empty()) return;
    const char* part = "h/2";
    try {
        const lie::State& finer = half->at(n);
        compare(x, finer, first);
        part = "h/4";
        if (quarter) compare(finer, quarter->at(n), second);
        until = x.t;
    } catch (const lie::NumericalFailure& error) {
        failure = fmt::format("the run with {} ended after t = {:g} s: {}", part, until, error.what());
    }
}

void RefinedRuns::compare(const lie::State& a, const lie::State& b, std::array<Largest, quantities>& to)
{
    dae::reactions(model, a, C, loads_a);
    dae::reactions(model, b, C, loads_b);
    for (int k = 0; k < model.bodies(); ++k) {
        const lie::Motion &of_a = a.body[k], &of_b = b.body[k];
        const auto i = static_cast<size_t>(k);
        const double difference[] = {(of_a.r - of_b.r).norm(),
                                     angle(of_a.A, of_b.A),
                                     (of_a.rdot - of_b.rdot).norm(),
                                     (of_a.omega_bar - of_b.omega_bar).norm(),
                                     (loads_a[i].F - loads_b[i].F).norm(),
                                     (loads_a[i].T - loads_b[i].T).norm()};
        for (size_t q = 0; q < quantities; ++q)
            if (!(difference[q] <= to[q].value)) to[q] = {difference[q], a.t, k};
    }
}

ErrorEstimate RefinedRuns::estimate(size_t contact_events) const
{
    static const char* const names[][2] = {{"r", "m"},         {"A", "rad"}, {"v", "m/s"},
                                           {"omega", "rad/s"}, {"F", "N"},   {"T", "N m"}};
    ErrorEstimate e;
    e.until = until;
    if (!failure.empty()) e.doubts.push_back(failure);
    if (contact_events > 0)
        e.doubts.push_back(
            fmt::format("{} contact event{}: the order of the scheme does not hold across them",
                        contact_events, contact_events == 1 ? "" : "s"));
    if (!quarter) e.doubts.emplace_back("the order is not measured: the run with h/4 would take too long");
    if (!(until > 0)) e.doubts.emplace_back("no node after the start was compared");
    // The Newton tolerance bounds positions; it is tolerance/h in velocities and tolerance/h² in loads.
    const double levels[] = {1, 1, 1 / grid.h, 1 / grid.h, 1 / (grid.h * grid.h), 1 / (grid.h * grid.h)};
    for (size_t q = 0; q < quantities; ++q) {
        const Largest& d = first[q];
        const int p = q < 4 ? scheme.order : scheme.order_lambda;
        const double factor = std::exp2(p) / (std::exp2(p) - 1);
        ErrorEstimate::Quantity& to = e.quantities[q];
        to = {.name = names[q][0], .unit = names[q][1], .order = p, .error = factor * d.value, .t = d.t};
        if (d.value > 0) to.body = model.all_bodies()[static_cast<size_t>(d.body)].name;
        to.resolution = tolerance * levels[q];
        if (!quarter || to.is_at_resolution() || !(second[q].value > 0)) continue;
        to.observed_order = std::log2(d.value / second[q].value);
        if (std::abs(to.observed_order - p) <= allowed) continue;
        e.doubts.push_back(fmt::format("{}: the observed order is {:.2f}, the order of {} is {}{}", to.name,
                                       to.observed_order, scheme.name, p,
                                       to.observed_order > p ? "; the error is probably smaller" : ""));
    }
    return e;
}

io::Json ErrorEstimate::json() const
{
    io::Json out = {{"until", until}, {"reliable", doubts.empty()}, {"doubts", doubts}};
    for (const Quantity& q : quantities)
        out[q.name] = {{"error", q.error},
                       {"unit", q.unit},
                       {"order", q.order},
                       {"observed_order", q.observed_order},
                       {"resolution", q.resolution},
                       {"t", q.t},
                       {"body", q.body}};
    return out;
}

std::string ErrorEstimate::text() const
{
    std::string line;
    for (const Quantity& q : quantities)
        line += fmt::format("{}{} {}{:.1e} {}", line.empty() ? "" : ", ", q.name,
                            q.is_at_resolution() ? "< " : "", std::max(q.error, q.resolution), q.unit);
    return line;
}

}  // namespace hilda::run
