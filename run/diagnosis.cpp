// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/diagnosis.hpp"

#include "dae/constraints/dp1.hpp"
#include "dae/model.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/trajectory.hpp"
#include "reference/solvers/rank_monitor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace hilda::run {

namespace {

/// The first force or constraint without a finite value in the state x; empty if all values are finite
std::string not_finite(const dae::Model& model, const lie::State& x)
{
    std::string found;
    lie::Loads loads(model.bodies());
    const auto look = [&](const dae::Force& force, int) {
        if (!found.empty()) return;
        try {
            force.add(x, loads);
        } catch (const lie::NumericalFailure&) {
            found = force.label();
            return;
        }
        const auto is_finite = [&](int b) { return loads.F[b].allFinite() && loads.n_bar[b].allFinite(); };
        const std::array<int, 2> of = force.bodies();
        if (of != std::array{dae::ground, dae::ground}) {
            for (const int b : of)
                if (b != dae::ground && !is_finite(b) && found.empty())
                    found = fmt::format("{} on body '{}'", force.label(), model.body_name(b));
            return;
        }
        for (int b = 0; b < model.bodies() && found.empty(); ++b)
            if (!is_finite(b)) found = fmt::format("{} on body '{}'", force.label(), model.body_name(b));
    };
    try {
        model.for_forces(x, look);
    } catch (const lie::NumericalFailure& failure) {  // of the search for near pairs
        if (found.empty()) return failure.what();
    }
    if (!found.empty()) return found;
    for (const dae::Model::Row& row : model.all_rows())
        if (!std::isfinite(model.scaled_residual(row, x))) return model.name_of(row);
    return {};
}

/// The largest load of a force in the state x, for a step that overflows although all loads are finite
std::string largest_load(const dae::Model& model, const lie::State& x)
{
    std::string name;
    double largest = 0;
    lie::Loads loads(model.bodies());
    model.for_forces(x, [&](const dae::Force& force, int) {
        const auto look = [&](int b) {
            for (const auto& [load, unit] : {std::pair{&loads.F[b], "N"}, {&loads.n_bar[b], "N m"}})
                if (const double size = load->stableNorm(); size > largest) {
                    largest = size;
                    name = fmt::format("largest load: {} on body '{}', {:.3g} {}", force.label(),
                                       model.body_name(b), size, unit);
                }
            loads.F[b].setZero(), loads.n_bar[b].setZero();
        };
        force.add(x, loads);
        const std::array<int, 2> of = force.bodies();
        if (of == std::array{dae::ground, dae::ground})
            for (int b = 0; b < model.bodies(); ++b) look(b);
        for (const int b : of)
            if (b != dae::ground) look(b);
    });
    return name;
}

/// Whether Newton's method converged slowly or not at all; empty if it is not known
std::string kind_of_failure(const lie::NoConvergence& newton)
{
    if (!(newton.rate > 0)) return {};
    return fmt::format(", on average {:.2g} times the one before: {}", newton.rate,
                       newton.rate < 0.9 ? "slow convergence" : "no convergence");
}

/// Estimate of the reciprocal condition number of the saddle matrix at x; NaN if the matrix cannot be
/// evaluated
double reciprocal_condition(const dae::Model& model, const lie::State& x)
{
    try {
        lie::Saddle K(model);
        K.assemble(x);
        return K.reciprocal_condition();
    } catch (const lie::SingularMatrix& singular) {
        return singular.reciprocal_condition;
    } catch (const lie::NumericalFailure&) {
        return std::nan("");
    }
}

/// A DP1 driver whose vectors become parallel, or whose value leaves its range, between the times t and t +
/// h; empty if there is none. Drivers with a complement pass such a point.
std::string singular_driver(const dae::Model& model, double t, double h)
{
    constexpr double nearly_parallel = 1 - 1e-4;  // of |f|/(|a_i| |a_j|)
    for (const int k : model.active_rows()) {
        const dae::Model::Row& row = model.all_rows()[k];
        const auto* driver = dynamic_cast<const dae::DP1*>(row.block.get());
        if (driver == nullptr || row.complement) continue;
        double largest = 0, at = t;
        for (const double instant : {t, t + h / 2, t + h})
            if (const double value = driver->alignment(instant); value > largest)
                largest = value, at = instant;
        if (!(largest > nearly_parallel)) continue;
        const std::string where =
            fmt::format("{}: |f| is {:.9g} of |a_i||a_j| at t = {:.9g} s", model.name_of(row), largest, at);
        return where +
               (largest > 1
                    ? ", and must not exceed it"
                    : ": the two vectors become parallel, where a DP1 driver loses its rank; prescribe "
                      "the angle with a hinge-driver, or write f as cos(g(t)) or sin(g(t))");
    }
    return {};
}

/// Whether a failure may be that of a singular configuration: an iteration or a factorisation that fails
/// after rows were removed as redundant at the start, or for rows that are dependent at the node
bool may_be_singular(const dae::Model& model, const lie::NumericalFailure& failure, double rcond)
{
    if (model.keep_redundant || (failure.status != "newton_diverged" && failure.status != "singular_matrix"))
        return false;
    return !model.dropped_rows().empty() || rcond < 1e-12;
}

}  // namespace

std::string step_text(double h)
{
    char digits[32];
    if (h >= 0.01) return {digits, std::to_chars(digits, digits + sizeof digits, h).ptr};
    std::string text(digits,
                     std::to_chars(digits, digits + sizeof digits, h, std::chars_format::scientific).ptr);
    for (size_t e = text.find('e') + 2; text[e] == '0' && e + 1 < text.size();) text.erase(e, 1);
    return text;
}

Diagnosis diagnose(const lie::NumericalFailure& failure, const dae::Model& model, const lie::State& node,
                   long number, double h, const lie::Scheme& scheme)
{
    std::string how = failure.what();
    if (const auto* newton = dynamic_cast<const lie::NoConvergence*>(&failure))
        how = fmt::format("correction {:.1e} after {} iterations{}", newton->correction, newton->iterations,
                          kind_of_failure(*newton));
    const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(h))) + 1, 1, 15);
    Diagnosis d;
    const bool at_node = dynamic_cast<const lie::NodeFailure*>(&failure) != nullptr;
    d.what = fmt::format("t={:.{}f} step {} ({}, h={}): {}", node.t + (at_node ? 0 : h), decimals,
                         number + (at_node ? 0 : 1), scheme.name, step_text(h), how);
    if (at_node || failure.status.starts_with("contact_"))
        return d;  // the message of the failure is complete

    lie::State next = node;
    next.t += h;
    for (const lie::State* x : {&node, static_cast<const lie::State*>(&next)})
        if (const std::string culprit = not_finite(model, *x); !culprit.empty()) {
            d.detail = "not finite: " + culprit;
            return d;
        }
    if (d.detail = singular_driver(model, node.t, h); !d.detail.empty()) return d;
    if (failure.status == "nonfinite") d.detail = largest_load(model, node);
    if (model.rows() == 0 && model.all_rows().empty()) return d;
    const auto* newton = dynamic_cast<const lie::NoConvergence*>(&failure);
    const dae::Model::Residual worst = model.largest_residual(node);
    const double rcond = reciprocal_condition(model, node);
    const std::string row = newton != nullptr ? newton->largest : model.name_of(worst);
    if (!row.empty()) {  // there are rows in the equations of the node
        if (!d.detail.empty()) d.detail += "; ";
        d.detail += fmt::format("largest: {}; residual {:.1e}; reciprocal condition {:.0e}{}", row,
                                newton != nullptr ? newton->residual : worst.value, rcond,
                                rcond < 1e-12 ? ": redundant or singular constraints?" : "");
        if (may_be_singular(model, failure, rcond))
            d.detail +=
                "; a mechanism passes singular configurations with \"redundant\": \"keep\" in its file";
    }
    if (scheme.adaptive) return d;
    for (const auto& force : model.forces())
        if (std::isfinite(force->spring_limits.at_step))
            if (const double limit = force->stable_step_in(scheme, node, {}); h > limit)
                d.detail =
                    fmt::format("the step is above {:.3g} s, the stability limit of {} in an explicit step",
                                limit, force->label());
    return d;
}

std::string rank_warning(const lie::Integrator& integrator)
{
    const auto* monitor = dynamic_cast<const reference::RankMonitor*>(&integrator);
    if (monitor == nullptr) return {};
    const auto smallest = monitor->smallest_condition();
    if (smallest.ratio > reference::RankMonitor::nearly_dependent) return {};
    return fmt::format(
        "the constraints nearly lose rank at t = {:.4g} s: the reciprocal condition of the equations falls "
        "to {:.0e} of that at the start; the motion after it may be on another branch",
        smallest.t, smallest.ratio);
}

}  // namespace hilda::run
