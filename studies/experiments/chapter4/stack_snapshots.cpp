// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/experiments/chapter4/stack_snapshots.hpp"

#include "studies/experiments/chapter4/friction/experiment.hpp"

namespace hilda::studies {

namespace {

constexpr double last_drop = 0.5, counted_drop = 0.1;  // descents of the upper sphere, over R
constexpr int interval = 50;                           // steps between the frames of a path

}  // namespace

StackSnapshots stack_snapshots(const Stack& stack, const std::string& run, double h, double end)
{
    contact::Scene of = scene(stack);
    run::Snapshots snapshots;
    for (const contact::Scene::Pair& p : of.pair) {
        snapshots.add_surface(p.i, p.contact.i);
        snapshots.add_surface(p.j, p.contact.j);
    }
    StackSnapshots result{.stack = stack};
    const double start = of.body[stacked::top].r.z();
    for (long n = 0;; ++n) {
        const double t = of.t, drop = (start - of.body[stacked::top].r.z()) / Stack::R;
        result.collapses = drop > counted_drop;
        const bool is_last = t >= end || drop > last_drop;
        const std::vector<contact::Motion> bodies = of.body;
        of.step(h);  // computes the contacts of this node
        const double after = of.t;
        of.t = t;
        if (n % interval == 0 || is_last) friction::add_frame(snapshots, of, bodies);
        if (is_last) break;
        of.t = after;
        if (result.collapses) continue;
        const contact::Deflections& ground = of.pair[stacked::right_ground].history.deflections;
        result.roll_saturates |= ground.roll_i.slipping;
        result.slide_saturates |= ground.slide.slipping;
    }
    result.t = of.t;
    result.tables =
        run::snapshot_tables(snapshots, run, {"left", "right", "top", "ground"},
                             {"top-left", "top-right", "left-ground", "right-ground"}, {0, result.t});
    return result;
}

}  // namespace hilda::studies
