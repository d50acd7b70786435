// SPDX-License-Identifier: GPL-3.0-or-later
/// The balance of energy of a run.
///
///     E = T + V + U,     E(t) - E(0) = W - D
///
/// T is the kinetic energy, V the potential energy of the loads, and U that of springs whose deflections are
/// internal states, such as those of friction. W is the work of drivers and of forces that are not passive:
///
///     W = ∫ (Σ P_f - λ · ν) dt + Σ (V_f - V_f(0))          over the forces f that are not passive
///
/// State::applied_loads are not part of W: a run with them is not passive, and E - W has no finding.
///
/// D, the energy dissipated, never decreases in the exact solution: E - W never rises. The rise above its
/// lowest value so far is therefore an error of the integration, or of the model. So is its fall if nothing
/// in the model dissipates energy.
///
/// The error that a scheme of second order may have without an instability is estimated by the kinetic energy
/// of the velocity change of one step, with the acceleration v̇ of the node:
///
///     B = h²/2 v̇ᵀ M v̇
///
/// For the harmonic oscillator with frequency ω this is (ω h)²/2 times the largest kinetic energy. The energy
/// of leapfrog oscillates by at most half of it.

#pragma once

#include "dae/model.hpp"
#include "run/watch/node_integral.hpp"

#include <vector>

namespace hilda::run {

/// Power of loads, Σ F · ṙ + n̄ · ω̄ over the bodies [W]
double power(const lie::Loads& loads, const lie::State& x);

/// What the balance needs of the past of a run; part of checkpoints
struct EnergyRecord {
    double kinetic_most = 0;      ///< largest T [J]
    double size = 0;              ///< largest |V| + U + T, for rounding errors [J]
    double start = 0, last = 0;   ///< E at the first and the last node [J]
    double lowest = 0;            ///< smallest E - W [J]
    double rise = 0, rise_t = 0;  ///< largest rise of E - W above its lowest value [J], and its time [s]
    double highest = 0;           ///< largest E - W [J]
    double loss = 0, loss_t = 0;  ///< largest fall of E - W below its highest value [J], and its time [s]
    double step_error = 0;        ///< largest B [J]
    double potential_start = 0, potential = 0;  ///< Σ V_f of forces that are not passive [J]
    double t = 0;                               ///< of the last node [s]
    NodeIntegral loads, drivers;
    long evaluations = 0;
    long with_applied_loads = 0;  ///< 1: a node has had State::applied_loads

    double work_of_loads() const { return loads.value() + potential - potential_start; }  ///< [J]
    double work_of_drivers() const { return drivers.value(); }                            ///< [J]
    double work() const { return work_of_loads() + work_of_drivers(); }                   ///< W [J]
    double dissipated() const { return start + work() - last; }                           ///< D [J]
};

/// Follows a run, node by node. No function allocates memory after the constructor.
class EnergyBalance {
public:
    /// The model must outlive this object. x is the start, h the step [s].
    EnergyBalance(const dae::Model& model, const lie::State& x, double h);

    /// Includes a node in the integrals of the work: evaluates ν, and the loads that are not passive.
    void add_work(const lie::State& x);
    /// Evaluates the energy of node n, after add_work(). A rise counts from the 16th node on: before, the
    /// largest kinetic energy of a start from rest is that of a few steps.
    void evaluate(const lie::State& x, long n);

    /// All forces are passive, there were no applied loads, and no driver has moved or moves within about 2 s
    /// of the start: W = 0
    bool is_passive() const
    {
        return not_passive.empty() && record.with_applied_loads == 0 && !has_drivers();
    }
    /// It is passive, and nothing in it dissipates energy: no damper, friction, impact or unknown force. D
    /// = 0
    bool is_conservative() const { return is_passive() && !dissipates; }
    /// Rounding errors and errors of the constraints in E [J]
    double floor() const;
    /// Largest rise of E - W that is not above `part` times the largest kinetic energy plus rounding errors
    /// [J]
    double limit(double part) const { return part * record.kinetic_most + floor(); }

    EnergyRecord record;

private:
    double power_of_loads(const lie::State& x);
    void add_power_of_drivers(const lie::State& x, double dt);
    bool has_drivers() const { return moves_early || !record.drivers.is_empty(); }
    double internal_energy(const lie::State& x);

    const dae::Model& model;
    const double h;
    std::vector<const dae::Force*> not_passive, with_internal_energy;
    bool dissipates = false;
    bool moves_early = false;  ///< ν ≠ 0 within about 2 s of the start
    double weight = 0;         ///< Σ m max(1 m/s², |g|) [N]
    lie::Loads loads;
    Eigen::VectorXd nu;
    std::vector<lie::BoundedPair> pairs;
};

}  // namespace hilda::run
