// SPDX-License-Identifier: GPL-3.0-or-later
/// Time of the parts of a step of the N-bar pendulum: loads, constraints, variation of the constraints, and
/// assembly, factorisation and solution of the saddle system, by KLU or condensed.

#include "lie/solver/saddle.hpp"
#include "studies/benchmarks/chain.hpp"

#include <benchmark/benchmark.h>

namespace {

using namespace hilda;

void over_bars(benchmark::internal::Benchmark* b)
{
    for (const int bars : {2, 8, 64, 256, 1024}) b->Arg(bars);
    b->Unit(benchmark::kMicrosecond);
}

void loads(benchmark::State& timer)
{
    const dae::Description& d = studies::chain(timer.range(0));
    lie::Loads out(d.model->bodies());
    for (auto _ : timer) d.model->loads(d.x, out);
}
BENCHMARK(loads)->Apply(over_bars);

void constraints(benchmark::State& timer)
{
    const dae::Description& d = studies::chain(timer.range(0));
    Eigen::VectorXd out(d.model->rows());
    for (auto _ : timer) d.model->phi(d.x, out);
}
BENCHMARK(constraints)->Apply(over_bars);

void variation(benchmark::State& timer)
{
    const dae::Description& d = studies::chain(timer.range(0));
    lie::Rows out = d.model->pattern();
    for (auto _ : timer) d.model->variation(d.x, out);
}
BENCHMARK(variation)->Apply(over_bars);

template <lie::LinearSolver solver>
void assemble_and_factor(benchmark::State& timer)
{
    const dae::Description& d = studies::chain(timer.range(0));
    lie::Saddle K(*d.model, lie::Metric::mass, solver);
    for (auto _ : timer) K.assemble(d.x);
}
BENCHMARK(assemble_and_factor<lie::LinearSolver::klu>)->Apply(over_bars);
BENCHMARK(assemble_and_factor<lie::LinearSolver::condensed>)->Apply(over_bars);

template <lie::LinearSolver solver>
void solve(benchmark::State& timer)
{
    const dae::Description& d = studies::chain(timer.range(0));
    lie::Saddle K(*d.model, lie::Metric::mass, solver);
    K.assemble(d.x);
    const Eigen::VectorXd right_side = Eigen::VectorXd::Random(K.size());
    Eigen::VectorXd z = right_side;
    for (auto _ : timer) {
        z = right_side;
        K.solve(z);
    }
}
BENCHMARK(solve<lie::LinearSolver::klu>)->Apply(over_bars);
BENCHMARK(solve<lie::LinearSolver::condensed>)->Apply(over_bars);

void multiply(benchmark::State& timer)
{
    const dae::Description& d = studies::chain(timer.range(0));
    lie::Saddle K(*d.model);
    K.assemble(d.x);
    const Eigen::VectorXd z = Eigen::VectorXd::Random(K.size());
    Eigen::VectorXd out(K.size());
    for (auto _ : timer) K.multiply(z, out);
}
BENCHMARK(multiply)->Apply(over_bars);

}  // namespace
