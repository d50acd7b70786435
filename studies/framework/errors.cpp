// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/errors.hpp"

#include "dae/model.hpp"

namespace hilda::studies {

namespace {

using lie::State;

int observed_body(const dae::Model& model, const Observable& observable)
{
    if (observable.component.size() != 2 ||
        std::string("rvw").find(observable.component[0]) == std::string::npos ||
        std::string("xyz").find(observable.component[1]) == std::string::npos)
        lie::reject("studies::errors", "the component of an observable must be one of rx … wz",
                    "'" + observable.component + "'");
    return observable.body.empty() ? model.bodies() - 1 : model.find(observable.body);
}

/// Squared norms of the difference of a state and the reference solution (nullptr: zero), summed over the
/// bodies from first to last
struct SquaredNorms {
    double r = 0, A = 0, v = 0, omega = 0;
    SquaredNorms(const State& x, const State* reference_solution, int first, int last)
    {
        static const lie::Motion zero = [] {
            lie::Motion m;
            m.A.setZero();
            return m;
        }();
        for (int b = first; b <= last; ++b) {
            const lie::Motion& to = reference_solution != nullptr ? reference_solution->body[b] : zero;
            r += (x.body[b].r - to.r).squaredNorm();
            A += (x.body[b].A - to.A).squaredNorm();
            v += (x.body[b].rdot - to.rdot).squaredNorm();
            omega += (x.body[b].omega_bar - to.omega_bar).squaredNorm();
        }
    }
};

/// |ΔQ|² / |Q|²; 0 if the reference solution has no constraint loads
double load_error(const dae::Model& model, const State& x, const State& reference_solution)
{
    const auto a = dae::reactions(model, x), b = dae::reactions(model, reference_solution);
    double difference = 0, size = 0;
    for (size_t k = 0; k < a.size(); ++k) {
        difference += (a[k].F - b[k].F).squaredNorm() + (a[k].T - b[k].T).squaredNorm();
        size += b[k].F.squaredNorm() + b[k].T.squaredNorm();
    }
    return size > 0 ? difference / size : 0;
}

}  // namespace

double component(const State& x, int body, const std::string& name)
{
    const lie::Motion& b = x.body[body];
    const lie::Vec3& vector = name[0] == 'r' ? b.r : name[0] == 'v' ? b.rdot : b.omega_bar;
    return vector[name[1] - 'x'];
}

Difference difference(const State& x, const State& reference_solution)
{
    const SquaredNorms all(x, &reference_solution, 0, static_cast<int>(x.body.size()) - 1);
    return {std::sqrt(all.r), std::sqrt(all.A), std::sqrt(all.v), std::sqrt(all.omega)};
}

Errors errors(const dae::Model& model, const lie::Trajectory& run, const std::vector<long>& at,
              const lie::Trajectory& reference_solution, const Instants& instants,
              const Observable& observable)
{
    const int body = observed_body(model, observable);
    Errors out;
    int with_loads = 0, nodes = 0;
    for (size_t k = 0; k < at.size(); ++k) {
        if (at[k] == 0) continue;
        const State &x = run.row[k], &exact = reference_solution.row[at[k]];
        const double z =
            component(x, body, observable.component) - component(exact, body, observable.component);
        out.value[norm::observable] += z * z;
        ++nodes;
        if (at[k] == instants.count) {
            const SquaredNorms end(x, &exact, body, body);
            out.value[norm::r_end] = std::sqrt(end.r), out.value[norm::A_end] = std::sqrt(end.A);
            out.value[norm::v_end] = std::sqrt(end.v), out.value[norm::omega_end] = std::sqrt(end.omega);
        }
        if (at[k] % instants.stride != 0) continue;
        const SquaredNorms all(x, &exact, 0, model.bodies() - 1);
        out.value[norm::r] += all.r, out.value[norm::A] += all.A, out.value[norm::v] += all.v,
            out.value[norm::omega] += all.omega;
        ++out.instants;
        if (at[k] == instants.count) continue;
        out.value[norm::Q] += load_error(model, x, exact);
        ++with_loads;
    }
    for (const int n : {norm::r, norm::A, norm::v, norm::omega})
        out.value[n] = std::sqrt(out.value[n] / out.instants);
    out.value[norm::Q] = std::sqrt(out.value[norm::Q] / with_loads);
    out.value[norm::observable] = std::sqrt(out.value[norm::observable] / nodes);
    return out;
}

Errors sizes(const dae::Model& model, const lie::Trajectory& reference_solution, const Instants& instants,
             const Observable& observable)
{
    const int body = observed_body(model, observable);
    Errors out;
    int rows = 0;
    for (long k = 1; k <= instants.count; ++k) {
        const SquaredNorms all(reference_solution.row[k], nullptr, 0, model.bodies() - 1);
        out.value[norm::r] += all.r, out.value[norm::A] += all.A, out.value[norm::v] += all.v,
            out.value[norm::omega] += all.omega;
        const double z = component(reference_solution.row[k], body, observable.component);
        out.value[norm::observable] += z * z;
        ++rows;
    }
    for (const int n : {norm::r, norm::A, norm::v, norm::omega, norm::observable})
        out.value[n] = std::sqrt(out.value[n] / rows);
    for (int n = 0; n < 4; ++n) out.value[norm::r_end + n] = out.value[norm::r + n];
    out.value[norm::Q] = 1;
    return out;
}

}  // namespace hilda::studies
