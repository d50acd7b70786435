// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/watch/energy_balance.hpp"

#include <algorithm>
#include <cmath>
#include <exception>

namespace hilda::run {

namespace {

constexpr long first_node = 16;  // whose rise counts

/// Whether a constraint depends on time: ν ≠ 0 in x at one of a few times, or not defined there
bool moves_with_time(const dae::Model& model, lie::State x, Eigen::VectorXd& nu)
{
    for (const double dt : {0., 0.0137, 0.311, 1.73}) {
        x.t += dt;
        try {
            model.nu(x, nu);
        } catch (const std::exception&) {  // of a function of the user as well
            return true;
        }
        if (nu.size() > 0 && (nu.array() != 0).any()) return true;
    }
    return false;
}

}  // namespace

double power(const lie::Loads& loads, const lie::State& x)
{
    double sum = 0;
    for (size_t b = 0; b < x.body.size(); ++b)
        sum += loads.F[b].dot(x.body[b].rdot) + loads.n_bar[b].dot(x.body[b].omega_bar);
    return sum;
}

EnergyBalance::EnergyBalance(const dae::Model& model, const lie::State& x, double h)
    : model(model), h(h), loads(model.bodies()), nu(Eigen::VectorXd::Zero(model.rows())),
      pairs(model.bounded_pairs())
{
    for (const auto& force : model.forces()) {
        if (!force->is_passive()) not_passive.push_back(force.get());
        dissipates = dissipates || force->is_dissipative();
        if (force->internal_states() > 0) with_internal_energy.push_back(force.get());
    }
    for (const auto& group : model.near_forces().all_groups())
        dissipates = dissipates || group->example().is_dissipative();
    dissipates = dissipates || !pairs.empty() || !model.rigid_contacts().empty() ||
                 std::any_of(model.general_constraints().begin(), model.general_constraints().end(),
                             [](const auto& c) { return c->may_be_inactive(); });
    moves_early = moves_with_time(model, x, nu);
    for (const double m : model.mass().m) weight += m * std::max(1., model.gravity.norm());
}

double EnergyBalance::power_of_loads(const lie::State& x)
{
    loads.set_zero();
    record.potential = 0;
    for (const dae::Force* force : not_passive) {
        force->add(x, loads);
        record.potential += force->potential_energy(x);
    }
    return power(loads, x);
}

void EnergyBalance::add_work(const lie::State& x)
{
    const double dt = x.t - record.t;
    record.t = x.t;
    if (!x.applied_loads.empty()) record.with_applied_loads = 1;
    if (!not_passive.empty()) {
        record.loads.add(power_of_loads(x), dt);
        if (record.evaluations == 0) record.potential_start = record.potential;
    }
    if (nu.size() > 0) add_power_of_drivers(x, dt);
}

/// A driver may be at rest for a part of the run. The integral begins at the node before its first motion.
void EnergyBalance::add_power_of_drivers(const lie::State& x, double dt)
{
    model.nu(x, nu);
    if (!has_drivers()) {
        if ((nu.array() == 0).all()) return;
        record.drivers.add(0, dt);
    }
    record.drivers.add(-x.lambda.dot(nu), dt);
}

double EnergyBalance::internal_energy(const lie::State& x)
{
    double sum = 0;
    for (const dae::Force* force : with_internal_energy) sum += force->internal_energy(x);
    model.near_forces().visit(x, [&](const dae::Force& force, int) { sum += force.internal_energy(x); });
    if (!pairs.empty()) {
        model.update_pairs(x, pairs);
        for (const lie::BoundedPair& pair : pairs) sum += 0.5 * pair.K * pair.S.squaredNorm();
    }
    return sum;
}

void EnergyBalance::evaluate(const lie::State& x, long n)
{
    const lie::Mass& mass = model.mass();
    double T = 0, B = 0;
    for (size_t b = 0; b < x.body.size(); ++b) {
        const lie::Motion& body = x.body[b];
        T += mass.m[b] * body.rdot.squaredNorm() + body.omega_bar.dot(mass.J_bar[b] * body.omega_bar);
        B += mass.m[b] * body.rddot.squaredNorm() + body.omegadot_bar.dot(mass.J_bar[b] * body.omegadot_bar);
    }
    T *= 0.5, B *= 0.5 * h * h;
    const double V = model.potential_energy(x), U = internal_energy(x), E = T + V + U;
    const double without_work = E - record.work();
    record.last = E;
    record.kinetic_most = std::max(record.kinetic_most, T);
    record.size = std::max(record.size, T + std::abs(V) + U);
    record.step_error = std::max(record.step_error, B);
    if (record.evaluations++ == 0) {
        record.start = E;
        record.lowest = record.highest = without_work;
    }
    record.lowest = std::min(record.lowest, without_work);
    record.highest = std::max(record.highest, without_work);
    if (const double loss = record.highest - without_work; n >= first_node && loss > record.loss) {
        record.loss = loss;
        record.loss_t = x.t;
    }
    if (const double rise = without_work - record.lowest; n >= first_node && rise > record.rise) {
        record.rise = rise;
        record.rise_t = x.t;
    }
}

double EnergyBalance::floor() const
{
    constexpr double relative = 1e-8, length = 1e-9;  // [1], [m]
    return relative * record.size + length * weight;
}

}  // namespace hilda::run
