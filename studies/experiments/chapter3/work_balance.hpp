// SPDX-License-Identifier: GPL-3.0-or-later
/// Work of the loads and drivers that are not part of the energy E = T + V of a model, along a run.
///
/// The balance of energy is E - E(0) = W. With the power P_f = F · ṙ + n̄ · ω̄ of force f, summed over the
/// bodies, and its potential V_f:
///
///     W_loads   = Σ ∫ P_f dt + V_f - V_f(0)     over the forces that are not conservative
///     W_drivers = ∫ -λ · ν dt                   with Φ_r ṙ + Π̄ ω̄ = ν (Eq. 2.8) of the driven constraints
///
/// For pairs of regularised rows (implicit friction) ν is the velocity Φ_r ṙ + Π̄ ω̄ itself. A force is
/// conservative if its loads depend neither on velocities nor explicitly on time, and P_f = -dV_f/dt. The
/// integrals use the powers at the nodes, see NodeIntegral.
///
/// Where a load jumps, as at the beginning of a contact, the error is of the order of the jump of the power
/// times h. The energy lost in impacts of unilateral contacts is not a part of W.

#pragma once

#include "dae/model.hpp"
#include "run/watch/energy_balance.hpp"

#include <string>
#include <vector>

namespace hilda::studies {

/// Follows a run, node by node.
class WorkBalance {
public:
    /// The model must outlive this object.
    explicit WorkBalance(const dae::Model& model);

    /// Includes the next node of the run.
    void add(const lie::State& x);

    double loads() const;                                   ///< W_loads [J]
    double drivers() const { return driver_work.value(); }  ///< W_drivers [J]
    double work() const { return loads() + drivers(); }     ///< W [J]
    /// Labels of the forces that are not conservative, such as "force 'damper'", and "driver 'NAME'" for each
    /// driven constraint that has moved. Empty for a conservative model
    std::vector<std::string> sources() const;

private:
    struct ForceWork {
        bool conservative = true;
        double potential_start = 0, potential = 0;  ///< V_f at the first and at the last node [J]
        run::NodeIntegral power;
    };
    bool is_conservative(const dae::Force& force, double power_of_force, const lie::State& x);
    double power_of_drivers(const lie::State& x);

    const dae::Model& model;
    std::vector<ForceWork> force;
    std::vector<bool> driven;  ///< for each constraint of the model
    run::NodeIntegral driver_work;
    double t = 0;
    bool first = true;

    // workspace
    lie::Loads own, changed;
    lie::State other;
    lie::Rows rows;
    Eigen::VectorXd nu;
    std::vector<lie::BoundedPair> pairs;
};

}  // namespace hilda::studies
