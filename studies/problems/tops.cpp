// SPDX-License-Identifier: GPL-3.0-or-later
/// Two symmetric tops with closed-form solutions: a free top and a heavy top in steady precession.

#include "studies/framework/problem.hpp"

#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "reference/motions/closed_form.hpp"
#include "reference/solvers/reference_solution.hpp"

namespace hilda::studies {

namespace {

/// States of a single body, from its motion as a function of time
reference::ClosedForm one_body(std::function<lie::Motion(double)> at)
{
    return [at = std::move(at)](const std::vector<double>& instants) {
        lie::Trajectory run;
        for (const double t : instants) {
            lie::State x;
            x.t = t;
            x.body = {at(t)};
            run.row.push_back(x);
        }
        return run;
    };
}

lie::Trajectory free_flight(dae::Description& d, const std::vector<double>& instants)
{
    return reference::reference_solution(*d.model, d.x, instants, [&](const std::vector<double>& times) {
        const reference::FreeTop top(d.model->mass().J_bar[0].diagonal(), d.x.body[0], d.model->gravity,
                                     d.x.t);
        return one_body([&](double t) { return top.at(t); })(times);
    });
}

lie::Trajectory steady_precession(dae::Description& d, const std::vector<double>& instants)
{
    const lie::Motion& start = d.x.body[0];
    const lie::Mat3 J_bar = d.model->mass().J_bar[0];
    const reference::HeavyTop top{
        .m = d.model->mass().m[0],
        .J_1 = J_bar(0, 0),
        .J_3 = J_bar(2, 2),
        .l = start.r.norm(),
        .g = -d.model->gravity.z(),
        .theta = std::acos(start.A(2, 2)),
        .Omega = start.omega_bar.y() / std::sqrt(1 - start.A(2, 2) * start.A(2, 2))};
    return reference::reference_solution(*d.model, d.x, instants,
                                         one_body([&](double t) { return top.at(t - d.x.t); }));
}

const bool thrown = io::Registry<Problem>::add(
    {.name = "free_top",
     .what =
         "free symmetric top thrown upwards, three precessions of its axis in three seconds (closed form)",
     .model = R"({"hilda_model": 1, "name": "free_top",
  "note": "cylinder of radius 0.1 m and height 0.3 m; vertical angular momentum, axis inclined by 18.4 degrees; returns to its initial height after 3 s",
  "gravity": [0, 0, -9.81], "end": 3,
  "bodies": [
    {"name": "top", "mass": 2, "inertia": [0.02, 0.02, 0.01], "shape": {"cylinder": [0.1, 0.3], "axis": "z"},
      "r": [0, 0, 0], "axis_angle": [0, -1, 0, 0.3217505543966422],
      "r_dot": [0.5, 0, 14.715], "omega": [2, 0, 12]}
  ]
}
)",
     .reference_name = "closed form",
     .reference_solution = free_flight,
     .observable = {.body = "top", .component = "wx"}});

const bool on_its_tip = io::Registry<Problem>::add(
    {.name = "heavy_top",
     .what = "heavy symmetric top with a fixed tip, in steady precession at 2 rad/s (closed form)",
     .model = R"({"hilda_model": 1, "name": "heavy_top",
  "note": "disc of radius 0.2 m and thickness 0.06 m, 0.1 m from its tip; cos(nutation) = 0.8; spin for a precession of 2 rad/s",
  "gravity": [0, 0, -9.81], "end": 3,
  "bodies": [
    {"name": "top", "mass": 2, "inertia": [0.0206, 0.0206, 0.04], "shape": {"cylinder": [0.2, 0.06], "axis": "z"},
      "r": [0, -0.06, 0.08], "A": [[1, 0, 0], [0, 0.8, -0.6], [0, 0.6, 0.8]],
      "r_dot": [0.12, 0, 0], "omega": [0, 1.2, 26.149]}
  ],
  "constraints": [
    {"name": "tip", "type": "spherical", "body_i": "top", "body_j": "ground", "s_bar_p_i": [0, 0, -0.1]}
  ]
}
)",
     .reference_name = "closed form",
     .reference_solution = steady_precession,
     .observable = {.body = "top", .component = "rx"}});

}  // namespace

}  // namespace hilda::studies
