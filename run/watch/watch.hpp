// SPDX-License-Identifier: GPL-3.0-or-later
/// Checks of every node of a run: size of the step, stability, overlap, condition and energy.

#pragma once

#include "io/archive.hpp"
#include "io/json.hpp"
#include "lie/trajectory.hpp"
#include "run/watch/energy_balance.hpp"

#include <string>
#include <vector>

namespace hilda::contact {
class CompliantForce;
}

namespace hilda::lie {
struct Scheme;
}

namespace hilda::run {

/// The largest value of a quantity over a run, with its time and place
struct Extreme {
    double value = 0, t = 0;
    long place = -1;  ///< number of the body or force; -1: none

    void include(double v, double at, size_t where)
    {
        if (v > value) *this = {v, at, static_cast<long>(where)};
    }
};

/// Largest overlap of a pair of a group of contacts
struct DeepestOverlap {
    long number = -1;    ///< of the pair, see dae::NearForces
    double overlap = 0;  ///< [m]
};

/// What the checks need of the past of a run; part of checkpoints
struct WatchRecord {
    Extreme turn;               ///< |ω| h [rad] of a body
    Extreme motion;             ///< |ṙ| h of a body with rigid contacts, relative to the smallest width
    Extreme overlap;            ///< overlap relative to a radius, see CompliantContact::relative_overlap()
    Extreme unstable;           ///< step above the stability limit: value 1, first time, force
    long ignore_stability = 0;  ///< 1: an unstable step does not end the run
    double condition = 1;       ///< smallest reciprocal condition of a matrix of the scheme
    double condition_t = 0;     ///< its time [s]
    EnergyRecord energy;
    std::vector<double> deepest = {};               ///< largest overlap of each compliant contact [m]
    std::vector<DeepestOverlap> near_deepest = {};  ///< of the near pairs, by their places in the state
};
/// Writes or reads the record.
void transfer(io::Archive& a, WatchRecord& record);

/// What a check found: a short name as for a status, and one line of text
struct Finding {
    std::string name, text;
};

/// Observes a run.
///
/// - Every node: rotation of each body in a step, condition of the matrix, overlap of compliant contacts, and
///   for a contact with a larger overlap than before its stability limit
/// - Every 16th node: the stability limit of all forces that may have one
/// - Every 16th node and every output row: the balance of energy. Its findings are for passive models only.
///
/// accepted() does not allocate memory unless it throws.
class Watch final : public lie::Observer {
public:
    struct Limits {
        double turn = 0.3;     ///< warning [rad]; lie::March refuses π
        double motion = 1;     ///< warning: a body can pass through another one
        double overlap = 0.1;  ///< warning, relative to a radius; the run ends at `overlap_end`
        double overlap_end = 0.5;
        double condition = 1e-12;  ///< warning; the schemes refuse 1e-14
        /// Rise of the energy relative to the largest kinetic energy: warning. The run ends if the rise
        /// exceeds this plus the error estimate of the step (EnergyBalance), of which at most `step_error`
        /// counts.
        double energy = 0.01, step_error = 0.25;
        /// Loss of energy of a model without dissipation, relative to the largest kinetic energy: warning.
        /// The error estimate of the step is added as above.
        double loss = 0.1;
    };
    /// Consequences of a finding
    enum class Action {
        record,  ///< none: a study compares also runs with large steps
        stop,  ///< accepted() throws NumericalFailure for an unstable step, an overlap above the limit, and energy
        strict  ///< it throws for every finding
    };

    /// x: the start of the run. ignore_stability: an unstable step is a finding, but does not end the run.
    Watch(const dae::Model& model, const lie::State& x, const lie::Integrator& integrator,
          const lie::Scheme& scheme, const lie::TimeGrid& grid, Action action, bool ignore_stability = false);

    /// lie::NumericalFailure with the status "unstable_step", "overlap_too_large" or "energy_created"; with
    /// Action::strict also "large_turn", "large_motion", "friction_relaxed", "restitution_reduced",
    /// "rigid_overlap", "large_overlap", "ill_conditioned", "energy_rises" or "energy_lost"
    void accepted(const lie::State& x, long n, int iterations) override;

    /// Warnings, at the end of a run
    std::vector<Finding> findings() const;
    /// For summary.json
    io::Json json() const;

    WatchRecord record() const;
    void restore(const WatchRecord& saved);

private:
    [[noreturn]] void stop(const std::string& status, const std::string& text) const;
    void check_stability(int force, const lie::State& x);
    void check_stability(const dae::Force& force, int number, const lie::State& x);
    std::string label_of(const Extreme& e) const;  ///< of the force of its place
    void check_contacts(const lie::State& x, bool all);
    void check_energy() const;
    /// Whether a model without dissipation loses energy
    bool energy_lost() const;
    Finding loss_finding() const;
    /// Whether the energy of a passive model rises
    bool energy_rises() const;
    /// Whether the rise exceeds also the error estimate, in a scheme without drift
    bool energy_created() const;

    Finding turn_finding() const;
    Finding motion_finding() const;
    Finding overlap_finding() const;
    Finding condition_finding() const;
    Finding stability_finding() const;
    Finding energy_finding() const;

    const dae::Model& model;
    const lie::Integrator& integrator;
    const lie::Scheme& scheme;
    const lie::TimeGrid grid;
    const Action action;
    const Limits limits;
    std::vector<int> with_limit;  ///< forces that may have a stability limit
    std::vector<std::pair<const contact::CompliantForce*, int>> compliant;
    std::vector<int> touching;  ///< number of touching contacts of each body at this node; empty: not counted
    WatchRecord values;         ///< without the energy
    EnergyBalance energy;
};

}  // namespace hilda::run
