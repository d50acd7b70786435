// SPDX-License-Identifier: GPL-3.0-or-later
/// Estimated discretisation error of a run.
///
/// The model is integrated with h/2 beside the run with h, and with h/4 if that is cheap. With the declared
/// order p of a quantity, Richardson's estimate of the error of the run with h is
///
///     e = |x_h - x_{h/2}| 2^p / (2^p - 1)
///
/// for the largest difference over the output rows and bodies. The observed order log2(|x_h - x_{h/2}| /
/// |x_{h/2} - x_{h/4}|), from the largest differences, shows whether the estimate holds: not after an impact,
/// in chaotic motion, or with a step that is too large.

#pragma once

#include "dae/model.hpp"
#include "io/json.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/trajectory.hpp"

#include <array>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace hilda::run {

struct ErrorEstimate {
    struct Quantity {
        std::string name, unit;
        int order = 1;     ///< declared
        double error = 0;  ///< estimate, the largest over rows and bodies
        double t = 0;      ///< where it occurs [s]
        std::string body = {};
        double observed_order = std::numeric_limits<double>::quiet_NaN();  ///< NaN: not measured
        double resolution =
            0;  ///< errors below the Newton tolerance, or its effect on this quantity, are not measured

        bool is_at_resolution() const { return error <= resolution; }
    };
    /// r [m], A (angle of rotation) [rad], v [m/s], omega [rad/s], resultant constraint force F [N] and
    /// torque T [N m] on a body
    std::array<Quantity, 6> quantities;
    double until = 0;                 ///< time of the last compared row [s]
    std::vector<std::string> doubts;  ///< why the estimate may be wrong; empty if nothing indicates that

    io::Json json() const;
    /// "r 1.2e-05 m, A < 1.0e-10 rad, ..."
    std::string text() const;
};

/// Integrates with h/2 and h/4 beside a run, and compares at its output rows.
class RefinedRuns final : public lie::Observer {
public:
    /// model, scheme and grid must outlive this object. x: the initial state.
    RefinedRuns(const dae::Model& model, const lie::State& x, const lie::Scheme& scheme,
                const lie::Settings& settings, const lie::TimeGrid& grid);
    ~RefinedRuns() override;

    /// Compares a node if it is an output row. A failure of a finer run, also one that its watch finds,
    /// ends the comparison and becomes a doubt.
    void accepted(const lie::State& node, long n, int iterations) override;
    /// The estimate at the end. contact_events: number of impacts, lift-offs and the like in the run
    ErrorEstimate estimate(size_t contact_events) const;

private:
    class Finer;
    static constexpr size_t quantities = 6;
    /// Largest difference over rows and bodies
    struct Largest {
        double value = 0, t = 0;
        int body = 0;
    };

    void compare(const lie::State& a, const lie::State& b, std::array<Largest, quantities>& to);

    const dae::Model& model;
    const lie::Scheme& scheme;
    const lie::TimeGrid& grid;
    const double tolerance;
    std::unique_ptr<Finer> half, quarter;           ///< quarter: nullptr if it is not cheap
    std::array<Largest, quantities> first, second;  ///< of h and h/2; of h/2 and h/4
    double until = 0;
    std::string failure;
    lie::Rows C;
    std::vector<dae::Reaction> loads_a, loads_b;
};

}  // namespace hilda::run
