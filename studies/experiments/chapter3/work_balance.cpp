// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/experiments/chapter3/work_balance.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::studies {

WorkBalance::WorkBalance(const dae::Model& model)
    : model(model), force(model.forces().size()),
      driven(static_cast<size_t>(model.constraints()) + model.general_constraints().size()),
      own(model.bodies()), changed(model.bodies()), rows(model.pattern()), nu(model.rows()),
      pairs(model.bounded_pairs())
{}

void WorkBalance::add(const lie::State& x)
{
    const double h = x.t - t;
    t = x.t;
    for (size_t k = 0; k < force.size(); ++k) {
        const dae::Force& f = *model.forces()[k];
        ForceWork& work = force[k];
        own.set_zero();
        f.add(x, own);
        const double power_of_force = run::power(own, x);
        work.power.add(power_of_force, h);
        work.potential = f.potential_energy(x);
        if (first) work.potential_start = work.potential;
        work.conservative = work.conservative && is_conservative(f, power_of_force, x);
    }
    driver_work.add(power_of_drivers(x), h);
    first = false;
}

double WorkBalance::loads() const
{
    double sum = 0;
    for (const ForceWork& f : force)
        if (!f.conservative) sum += f.power.value() + f.potential - f.potential_start;
    return sum;
}

std::vector<std::string> WorkBalance::sources() const
{
    std::vector<std::string> all;
    for (size_t k = 0; k < force.size(); ++k)
        if (!force[k].conservative) all.push_back(model.forces()[k]->label());
    const auto joints = static_cast<size_t>(model.constraints());
    for (size_t k = 0; k < driven.size(); ++k)
        if (driven[k])
            all.push_back(k < joints ? "driver '" + model.constraint_name(static_cast<int>(k)) + "'"
                                     : model.name_of(*model.general_constraints()[k - joints]));
    return all;
}

/// Whether the loads of the force, computed in `own`, are the same at other velocities and at another time,
/// and its power is that of its potential. A force with internal states depends on the history.
bool WorkBalance::is_conservative(const dae::Force& f, double power_of_force, const lie::State& x)
{
    if (f.internal_states() > 0) return false;
    other = x;
    other.t += 0.1234;
    for (lie::Motion& body : other.body) {
        body.rdot = 1.7 * body.rdot + lie::Vec3(0.3, -0.2, 0.5);
        body.omega_bar = -1.3 * body.omega_bar + lie::Vec3(-0.4, 0.6, 0.1);
    }
    changed.set_zero();
    f.add(other, changed);
    if (own.F != changed.F || own.n_bar != changed.n_bar) return false;

    constexpr double dt = 1e-6;  // of a central difference along the motion
    double rate = 0;
    for (const double sign : {1., -1.}) {
        for (size_t b = 0; b < x.body.size(); ++b) {
            other.body[b] = x.body[b];
            other.body[b].r += sign * dt * x.body[b].rdot;
            other.body[b].A = x.body[b].A * lie::exp(sign * dt * x.body[b].omega_bar);
        }
        rate += sign * f.potential_energy(other) / (2 * dt);
    }
    return std::abs(power_of_force + rate) <=
           1e-5 * std::abs(power_of_force) + 1e-8 * std::abs(f.potential_energy(x)) + 1e-12;
}

/// -λ · ν; marks the constraints with ν ≠ 0.
double WorkBalance::power_of_drivers(const lie::State& x)
{
    if (nu.size() == 0) return 0;
    model.nu(x, nu);
    if (!pairs.empty()) {
        model.variation(x, rows);
        for (const lie::BoundedPair& pair : pairs)
            for (const int k : {pair.first, pair.first + 1}) {
                nu[k] = 0;
                for (int e = rows.start[static_cast<size_t>(k)]; e < rows.start[static_cast<size_t>(k) + 1];
                     ++e) {
                    const lie::Rows::Entry& entry = rows.entry[static_cast<size_t>(e)];
                    const lie::Motion& body = x.body[static_cast<size_t>(entry.body)];
                    nu[k] += entry.r.dot(body.rdot) + entry.pi.dot(body.omega_bar);
                }
            }
    }
    const std::vector<int>& active = model.active_rows();
    const auto joints = static_cast<size_t>(model.constraints());
    for (size_t k = 0; k < active.size(); ++k)
        if (nu[static_cast<Eigen::Index>(k)] != 0)
            driven[static_cast<size_t>(model.all_rows()[static_cast<size_t>(active[k])].constraint)] = true;
    for (size_t c = 0; c < model.general_constraints().size(); ++c) {
        const dae::Constraint& constraint = *model.general_constraints()[c];
        const dae::Constraint::Place& at = dae::Model::place(constraint);
        for (int k = 0; k < constraint.position_rows(); ++k)
            if (nu[at.row + k] != 0) driven[joints + c] = true;
        for (int k = 0; k < constraint.velocity_rows(); ++k)
            if (nu[at.velocity_row + k] != 0) driven[joints + c] = true;
    }
    return -x.lambda.dot(nu);
}

}  // namespace hilda::studies
