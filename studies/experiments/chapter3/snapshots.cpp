// SPDX-License-Identifier: GPL-3.0-or-later
/// Pictures of models at several times: their bodies, joints and springs, and the paths of their bodies and
/// contact points.
///
/// The default models are the mechanisms of the dissertation (Fang 2022, Fig. 3.3). study.csv contains the
/// number of bodies, of constraint rows by type, and of degrees of freedom (Table 3.1). poses.csv,
/// contacts.csv and shapes.json contain what is drawn (SnapshotTables).

#include "dae/constraints/cd.hpp"
#include "dae/constraints/d.hpp"
#include "dae/constraints/dp1.hpp"
#include "dae/constraints/dp2.hpp"
#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "run/frames/model_frames.hpp"
#include "run/frames/tables.hpp"
#include "studies/framework/acceptance.hpp"
#include "studies/framework/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

namespace {

constexpr int snapshots = 4;      // evenly distributed from the start to the end
constexpr int path_points = 301;  // a multiple of snapshots - 1, plus 1
constexpr double mechanisms_end =
    0.75;  // of the default models: three quarters of a revolution of the crank [s]

struct SnapshotRun : Run {
    int bodies = 0, CD = 0, DP1 = 0, DP2 = 0, D = 0, other_rows = 0, degrees_of_freedom = 0;
    run::SnapshotTables tables = {};

    int rows() const { return CD + DP1 + DP2 + D + other_rows; }
    void transfer(io::Archive& a)
    {
        Run::transfer(a);
        a.value(bodies), a.value(CD), a.value(DP1), a.value(DP2), a.value(D), a.value(other_rows);
        a.value(degrees_of_freedom);
        tables.transfer(a);
    }
};

/// Counts the constraint rows by type. Contacts count at the start.
void count_rows(SnapshotRun& run, const dae::Model& model, const lie::State& start)
{
    run.bodies = static_cast<int>(model.all_bodies().size());
    for (const dae::Model::Row& row : model.all_rows()) {
        const dae::Block* block = row.block.get();
        ++(dynamic_cast<const dae::CD*>(block) != nullptr    ? run.CD
           : dynamic_cast<const dae::DP1*>(block) != nullptr ? run.DP1
           : dynamic_cast<const dae::DP2*>(block) != nullptr ? run.DP2
           : dynamic_cast<const dae::D*>(block) != nullptr   ? run.D
                                                             : run.other_rows);
    }
    const run::RowsOfGeneralConstraints general = run::rows_of_general_constraints(model, start);
    run.other_rows += general.of_others + general.of_contacts;
    run.degrees_of_freedom = 6 * run.bodies - static_cast<int>(model.active_rows().size()) -
                             general.of_others - general.of_contacts;
}

void compute(SnapshotRun& run, const lie::Settings& settings)
{
    const dae::Description& d = *run.c->started;
    count_rows(run, *d.model, d.x);
    run::ModelFrames frames(*d.model, run::EvenSelection(path_points, std::lround(run.c->end / run.h)));
    lie::Observer* observers[] = {&frames};
    march(run, settings, observers);
    std::vector<std::string> bodies;
    for (const dae::Body& body : d.model->all_bodies()) bodies.push_back(body.name);
    std::vector<std::string> contacts;
    for (const run::ContactOutputs::Contact& c : run::ContactOutputs(*d.model).contacts)
        contacts.push_back(c.name);
    std::vector<double> shown;
    for (int k = 0; k < snapshots; ++k) shown.push_back(d.x.t + run.c->end * k / (snapshots - 1));
    run.tables = run::snapshot_tables(frames.snapshots, run.c->problem.name, bodies, contacts, shown);
}

/// Table 3.1
std::vector<Criterion> criteria_of_mechanisms(const std::vector<SnapshotRun>& runs)
{
    struct Published {
        const char* problem;
        int rows, degrees_of_freedom;
    };
    std::vector<Criterion> all;
    for (const Published& p :
         {Published{"double_pendulum", 10, 2}, {"slider_crank", 18, 0}, {"four_link", 18, 0}})
        for (const SnapshotRun& run : runs) {
            if (run.c->problem.name != p.problem) continue;
            CriteriaOf of{.of = std::string(", ") + p.problem, .list = all};
            of.equals("constraint rows", run.rows(), p.rows, 0);
            of.equals("degrees of freedom", run.degrees_of_freedom, p.degrees_of_freedom, 0);
        }
    return all;
}

void draw_snapshots(StudyContext& s)
{
    const bool mechanisms = s.problems.empty();
    const std::vector<double> steps = {s.one_step(1e-3)};
    const std::vector<Benchmark> all = s.benchmarks(
        {"double_pendulum", "slider_crank", "four_link"}, steps,
        [&](const dae::Description& d) { return mechanisms ? mechanisms_end : end_of_model(d); });
    const Schemes schemes = s.fixed_step_schemes({"rA-half-1"});
    if (schemes.size() > 1) s.refuse("--integrator takes one integrator here");
    Sweep<SnapshotRun> runs(all, schemes, steps);
    runs.compute(s, [&](SnapshotRun& run) { compute(run, s.settings); });

    const Columns<SnapshotRun> columns = {
        column::problem,
        column::integrator,
        column::h,
        column::end,
        {"bodies", "bodies", "{:.0f}", &SnapshotRun::bodies},
        {"CD", "CD", "{:.0f}", &SnapshotRun::CD},
        {"DP1", "DP1", "{:.0f}", &SnapshotRun::DP1},
        {"DP2", "DP2", "{:.0f}", &SnapshotRun::DP2},
        {"D", "D", "{:.0f}", &SnapshotRun::D},
        {"other_rows", "other", "{:.0f}", &SnapshotRun::other_rows},
        {"rows", "rows", "{:.0f}", &SnapshotRun::rows},
        {"degrees_of_freedom", "degrees of freedom", "{:.0f}", &SnapshotRun::degrees_of_freedom},
        column::status};
    s.text << "\nbodies, constraint rows by type, degrees of freedom (Table 3.1)\n";
    columns.print(
        s.text, those(runs, [](const SnapshotRun&) { return true; }),
        {"problem", "bodies", "CD", "DP1", "DP2", "D", "other_rows", "rows", "degrees_of_freedom", "status"});
    s.json["runs"] = columns.array(runs, {"bodies", "rows", "degrees_of_freedom"});
    std::vector<run::SnapshotTables> tables;
    for (const SnapshotRun& run : runs) {
        tables.push_back(run.tables);
        s.figures.push_back("snapshots-" + run.c->problem.name + ".png");
    }
    s.files = run::snapshot_files("", tables);
    s.results(columns, runs);
    if (s.check) s.evaluate(criteria_of_mechanisms(runs));
}

const bool registered_snapshots = io::Registry<Study>::add(
    {.name = "snapshots",
     .answers = "pictures of models at four times: bodies, joints, paths (Fig. 3.3); bodies and constraints "
                "(Table 3.1)",
     .options = options_of_models({"--check", "--strict", "--shard"}),
     .keys = {"bodies", "CD", "DP1", "DP2", "D", "other_rows", "rows", "degrees_of_freedom"},
     .files = {"poses.csv", "contacts.csv", "shapes.json", "snapshots-PROBLEM.png"},
     .run = draw_snapshots});

}  // namespace

}  // namespace hilda::studies
