// SPDX-License-Identifier: GPL-3.0-or-later
/// Constraint residual and orthogonality of A over a run.
///
/// For each problem, integrator and step: the largest constraint residual [m or rad] and the largest norm of
/// A^T A - I over all nodes. Acceptance criterion (--check): the residual is below 1e-8.

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "studies/framework/sweep.hpp"

namespace hilda::studies {

namespace {

struct InvariantsRun : Run {
    double residual = 0, orthogonality = 0;

    void transfer(io::Archive& a)
    {
        Run::transfer(a);
        a.value(residual), a.value(orthogonality);
    }
};

/// Updates the largest values of a run at each node.
class Invariants final : public lie::Observer {
public:
    explicit Invariants(InvariantsRun& run) : run(run) {}

    void accepted(const lie::State& x, long, int) override
    {
        run.residual = std::max(run.residual, run.c->started->model->largest_residual(x).value);
        for (const lie::Motion& body : x.body)
            run.orthogonality = std::max(run.orthogonality, lie::orthogonality_error(body.A));
    }

private:
    InvariantsRun& run;
};

void invariants(StudyContext& s)
{
    const std::vector<double> steps = s.steps({1e-2, 1e-3});
    const std::vector<Benchmark> benchmarks = s.benchmarks({"double_pendulum", "four_link"}, steps);
    Sweep<InvariantsRun> runs(benchmarks, s.fixed_step_schemes({"rA-full-1", "rA-half-1", "rA-half-2"}),
                              steps);
    runs.compute(s, [&](InvariantsRun& run) {
        Invariants observer(run);
        lie::Observer* observers[] = {&observer};
        march(run, s.settings, observers);
    });

    const Columns<InvariantsRun> columns = {column::problem.as("problem"),
                                            column::integrator,
                                            column::h,
                                            {"residual", "residual", &InvariantsRun::residual},
                                            {"orthogonality", "|A'A-I|", &InvariantsRun::orthogonality},
                                            column::status};
    columns.print(s.text, runs);
    s.results(columns, runs);
    s.json["runs"] = columns.array(runs, {"residual", "orthogonality"});
    s.figures = {"invariants.png"};
    std::vector<Criterion> criteria;
    for (const InvariantsRun& run : runs)
        criteria.push_back(between("residual of " + run.name(), run.residual, 0, 1e-8));
    s.evaluate(criteria);
}

const bool registered =
    io::Registry<Study>::add({.name = "invariants",
                              .answers = "constraint residual and orthogonality over a run",
                              .options = options_of_models({"--check"}),
                              .keys = {"residual", "orthogonality"},
                              .run = invariants});

}  // namespace

}  // namespace hilda::studies
