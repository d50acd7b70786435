// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/reproduction.hpp"

namespace hilda::studies {

namespace {

using Words = std::vector<std::string>;

/// An experiment of study friction
Reproduction friction(const std::string& experiment, Words figures, const std::string& title,
                      const std::string& shows)
{
    return {.name = "friction-" + experiment,
            .chapter = 4,
            .figures = std::move(figures),
            .title = title,
            .shows = shows,
            .study = "friction",
            .arguments = {"--problem", experiment, "--check"},
            .page = "friction.md"};
}

/// A validation of grains
Reproduction grains(const std::string& validation, Words figures, const std::string& title,
                    const std::string& shows, const std::string& reduced)
{
    return {.name = "granular-" + validation,
            .chapter = 7,
            .figures = std::move(figures),
            .title = title,
            .shows = shows,
            .study = "granular-" + validation,
            .arguments = {"--check"},
            .full = {"--grid", "full"},
            .reduced = reduced,
            .page = "granular-" + validation + ".md"};
}

std::vector<Reproduction> chapter_3()
{
    const std::string finest = "5e-4";
    const auto total = [](const std::string& what, const std::string& column, const std::string& problem,
                          double value) {
        return ReproductionCheck{.what = what + ", " + problem,
                                 .column = column,
                                 .where = {{"problem", problem}},
                                 .least = value,
                                 .most = value};
    };
    return {
        {.name = "mechanisms",
         .chapter = 3,
         .figures = {"3.3", "Table 3.1"},
         .title = "Mechanisms",
         .shows = "Double pendulum, slider-crank and four-link at four times; their constraints and degrees "
                  "of freedom.",
         .study = "snapshots",
         .arguments = {},
         .page = "snapshots.md",
         .checks = {total("constraint rows", "rows", "double_pendulum", 10),
                    total("constraint rows", "rows", "slider_crank", 18),
                    total("constraint rows", "rows", "four_link", 18),
                    total("degrees of freedom", "degrees_of_freedom", "double_pendulum", 2),
                    total("degrees of freedom", "degrees_of_freedom", "slider_crank", 0),
                    total("degrees of freedom", "degrees_of_freedom", "four_link", 0)}},
        {.name = "order-1",
         .chapter = 3,
         .figures = {"3.4"},
         .title = "Error over step, schemes of first order",
         .shows = "Error of the half-implicit and the fully implicit scheme over the step: z of "
                  "bar 2 of the double pendulum, velocities of slider-crank and four-link. Slope 1.",
         .study = "convergence",
         .arguments = {"--integrator", "rA-full-1,rA-half-1", "--problem",
                       "double_pendulum,slider_crank,four_link"},
         .quick = {"--steps", "4e-3,2e-3,1e-3,5e-4"},
         .full = {"--steps", "1e-2,5e-3,2e-3,1e-3,5e-4,2e-4,1e-4,5e-5,2e-5,1e-5"},
         .reduced = "four steps from 4e-3 s to 5e-4 s instead of ten from 1e-2 s to 1e-5 s",
         .page = "convergence.md",
         .checks = {{.what = "order of the half-implicit scheme on the double pendulum, h = 5e-4 s",
                     .column = "order_observable",
                     .where = {{"problem", "double_pendulum"}, {"integrator", "rA-half-1"}, {"h", finest}},
                     .least = 0.85,
                     .most = 1.15},
                    {.what = "order of the fully implicit scheme on the double pendulum, h = 5e-4 s",
                     .column = "order_observable",
                     .where = {{"problem", "double_pendulum"}, {"integrator", "rA-full-1"}, {"h", finest}},
                     .least = 0.85,
                     .most = 1.15}}},
        {.name = "energy",
         .chapter = 3,
         .figures = {"3.5"},
         .title = "Energy of the double pendulum",
         .shows =
             "The fully implicit scheme loses energy, the half-implicit scheme does not (planar motion).",
         .study = "energy",
         .arguments = {"--problem", "double_pendulum", "--integrator", "rA-full-1,rA-half-1"},
         .quick = {"--end", "30"},
         .full = {"--end", "100"},
         .reduced = "30 s instead of 100 s",
         .page = "energy.md",
         .checks =
             {{.what = "change of energy of the half-implicit scheme over the largest kinetic energy",
               .column = "max_drift_relative",
               .where = {{"integrator", "rA-half-1"}},
               .least = 0,
               .most = 0.01},
              {.what =
                   "change of energy of the fully implicit scheme at the end over the largest kinetic energy",
               .column = "end_drift_relative",
               .where = {{"integrator", "rA-full-1"}},
               .least = -1,
               .most = -0.05}}},
        {.name = "order-2",
         .chapter = 3,
         .figures = {"3.6", "3.7", "3.8"},
         .title = "Error over step, half-implicit schemes of first and second order",
         .shows = "Errors of r, A, the velocity and the angular velocity of one body at the end of the run. "
                  "Slopes 1 and 2.",
         .study = "convergence",
         .arguments = {"--integrator", "rA-half-1,rA-half-2", "--problem",
                       "double_pendulum,slider_crank,four_link"},
         .quick = {"--steps", "4e-3,2e-3,1e-3,5e-4"},
         .full = {"--steps", "1e-2,5e-3,2e-3,1e-3,5e-4,2e-4,1e-4"},
         .reduced = "four steps from 4e-3 s to 5e-4 s instead of seven from 1e-2 s to 1e-4 s",
         .page = "convergence.md",
         .checks = {{.what = "order of r at the end, first-order scheme, double pendulum, h = 5e-4 s",
                     .column = "order_r_end",
                     .where = {{"problem", "double_pendulum"}, {"integrator", "rA-half-1"}, {"h", finest}},
                     .least = 0.85,
                     .most = 1.15},
                    {.what = "order of r at the end, second-order scheme, double pendulum, h = 5e-4 s",
                     .column = "order_r_end",
                     .where = {{"problem", "double_pendulum"}, {"integrator", "rA-half-2"}, {"h", finest}},
                     .least = 1.8,
                     .most = 2.2}}},
        {.name = "iterations",
         .chapter = 3,
         .figures = {"3.9", "3.11", "3.12", "3.13"},
         .title = "Newton iterations per step",
         .shows =
             "Iterations over the step: half-implicit and fully implicit scheme, first and second order.",
         .study = "iterations",
         .arguments = {"--integrator", "rA-full-1,rA-half-1,rA-half-2"},
         .quick = {"--steps", "1e-2,1e-3"},
         .full = {"--steps", "1e-2,1e-3,1e-4"},
         .reduced = "without the step 1e-4 s",
         .page = "iterations.md",
         .checks =
             {{.what = "iterations of the half-implicit over those of the fully implicit scheme, h = 1e-2 s",
               .column = "iterations_per_step",
               .where = {{"integrator", "rA-half-1"}, {"h", "1e-2"}},
               .least = 0.7,
               .most = 1.0,
               .relative_to = "rA-full-1"},
              {.what = "iterations of the second-order over those of the first-order scheme",
               .column = "iterations_per_step",
               .where = {{"integrator", "rA-half-2"}},
               .least = 0.95,
               .most = 1.05,
               .relative_to = "rA-half-1"}}},
        {.name = "timing",
         .chapter = 3,
         .figures = {"3.10"},
         .title = "CPU time over step",
         .shows = "CPU time of the half-implicit and the fully implicit scheme.",
         .study = "timing",
         .arguments = {"--integrator", "rA-full-1,rA-half-1"},
         .quick = {"--steps", "1e-2,1e-3", "--repeats", "3"},
         .reduced = "without the smallest steps; three repetitions instead of five",
         .page = "timing.md",
         .checks = {{.what = "CPU time of a step, half-implicit over fully implicit scheme",
                     .column = "ratio_to_full",
                     .where = {{"integrator", "rA-half-1"}},
                     .least = 0.4,
                     .most = 1.25}},
         .timed = true},
        {.name = "scaling",
         .chapter = 3,
         .figures = {"3.15"},
         .title = "CPU time over the number of bars",
         .shows = "CPU time of a step of the pendulum of N bars, half-implicit and fully implicit scheme.",
         .study = "scaling",
         .arguments = {},
         .quick = {"--bars", "1,2,4,8,16,32,64", "--repeats", "3"},
         .reduced = "up to 64 bars instead of 1024 (the dissertation: 32); three repetitions instead of five",
         .page = "scaling.md",
         .checks = {{.what = "CPU time of a step, half-implicit over fully implicit scheme",
                     .column = "ratio_to_full",
                     .where = {{"integrator", "rA-half-1"}},
                     .least = 0.4,
                     .most = 1.25}},
         .timed = true}};
}

std::vector<Reproduction> chapter_4()
{
    return {
        friction("brick", {"4.6"}, "Brick on an incline of 0.18 rad",
                 "Slip and friction force with and without damping."),
        friction("brick-angles", {"4.7"}, "Brick on three inclines",
                 "Inclines of atan mu_k, atan mu_s and 0.25 rad."),
        friction("disk", {"4.9"}, "Rolling disk",
                 "Positions, velocities, accelerations and friction of a disk that slides and then rolls."),
        friction("disk-damping", {"4.10"}, "Rolling disk with other dampings",
                 "The disk of Fig. 4.9 with other damping."),
        friction("rolling-models", {"4.11"}, "Rolling resistance at rest",
                 "Constant torque and history model of rolling resistance at rest."),
        friction("incline", {"4.12"}, "Sphere up an incline of 35 degrees",
                 "Sliding, rolling and return of a sphere; snapshots."),
        {.name = "incline-sweep",
         .chapter = 4,
         .figures = {"4.13"},
         .title = "Final states of a sphere on an incline",
         .shows = "Rest, rolling or sliding over the slope and the rolling resistance.",
         .study = "incline-sweep",
         .arguments = {"--check"},
         .quick = {"--grid", "coarse"},
         .full = {"--grid", "published"},
         .reduced = "a coarse grid of slopes and coefficients instead of the 23571 published states",
         .page = "incline-sweep.md"},
        friction("spin", {"4.14", "4.15"}, "Spinning sphere",
                 "Spin of a sphere that comes to rest, heuristic model; snapshots."),
        friction("spin-hertz", {"4.16"}, "Spinning spheres of steel and glass",
                 "Spin that comes to rest, Hertz model."),
        friction("ellipsoid", {"4.17"}, "Ellipsoid that falls over",
                 "Motion of an ellipsoid that stands upright at the start; snapshots."),
        friction("spin-ellipsoid", {"4.18", "Table 4.7"}, "Spinning ellipsoid",
                 "Spin on the pole and on the side; spinning torque over the curvature."),
        {.name = "stacking",
         .chapter = 4,
         .figures = {"4.19"},
         .title = "Critical mass of three stacked spheres",
         .shows =
             "Largest mass of the upper sphere that the lower spheres carry, over the rolling resistance; "
             "snapshots.",
         .study = "stacking",
         .arguments = {"--check"},
         .quick = {"--grid", "coarse"},
         .full = {"--grid", "dissertation"},
         .reduced = "a coarse grid instead of the 110 published masses",
         .page = "stacking.md"}};
}

std::vector<Reproduction> chapter_5()
{
    return {
        {.name = "evolving-contact",
         .chapter = 5,
         .figures = {"5.2", "5.3", "5.4", "5.5", "5.6"},
         .title = "Ball in an ellipsoidal bowl",
         .shows = "Trajectories of the contact points, residuals of the constraints, and the normal force.",
         .study = "evolving-contact",
         .arguments = {"--check"},
         .page = "evolving-contact.md"},
        {.name = "evolving-friction",
         .chapter = 5,
         .figures = {"5.7", "5.8"},
         .title = "Ball in a bowl with friction",
         .shows =
             "Trajectory of the contact point, forces, rolling torque and velocities for eta_r = 0 to 0.3.",
         .study = "evolving-friction",
         .arguments = {"--check"},
         .page = "evolving-friction.md"}};
}

std::vector<Reproduction> chapters_7_and_8()
{
    return {
        grains("head-on", {"7.2"}, "Head-on collision",
               "Rebound velocity over the coefficient of restitution.",
               "fewer instants of contact within a step"),
        grains("brick", {"7.4"}, "Sliding brick", "Sliding distance over the coefficient of friction.",
               "the incremental law for coefficients of 0.4 and above only"),
        grains("oblique", {"7.6"}, "Oblique impact",
               "Tangential restitution and spin after an oblique impact, over the angle.",
               "each fifth degree instead of each degree"),
        grains("stacking", {"7.7"}, "Critical mass of three stacked grains",
               "Critical mass over the rolling friction.", "fewer coefficients of rolling friction and gaps"),
        grains("waves", {"7.9", "7.10"}, "Force on the floor under a lattice",
               "Profiles of the force on the floor under a point load.",
               "fewer stiffnesses, and a shorter load"),
        grains("shear", {"7.12"}, "Direct shear of grains",
               "Shear stress over the shear displacement and the normal stress.",
               "grains of 4 mm radius instead of 3 mm, and 6 mm of displacement instead of 10 mm"),
        grains("cratering", {"7.14"}, "Crater of a ball in a bed of grains",
               "Depth of the crater over the scaled height of fall.",
               "grains of 2 mm radius instead of 1 mm, and fewer balls"),
        grains("low-velocity-cratering", {"7.15", "7.16", "7.17", "7.18"},
               "Impact of a sphere at low velocity",
               "Depth, duration and peak acceleration over the speed, the rolling friction and the gravity.",
               "two speeds and rolling frictions, and one impact in reduced gravity"),
        grains("drum", {"7.19"}, "Grains in a rotating drum",
               "Flow of the grains, coloured by their speed, over the Froude number.",
               "grains of 1 mm radius instead of 0.5 mm, and fewer speeds"),
        grains("wheel", {"7.21", "7.22", "7.23", "7.25"}, "Single wheel on grains",
               "Pull, driving torque and sinkage over the slip, in plane strain; in the full grid also of a "
               "cylinder with end faces and of a tyre.",
               "a narrower bed, four slips instead of nine, one bed instead of four, and no cylinder with "
               "end faces and "
               "no tyre"),
        grains("tyre", {"7.20"}, "Single-wheel rig with a tyre on grains",
               "Pull, driving torque and sinkage over the imposed slip, and the free slip under a torque, in "
               "co-simulation.",
               "a shorter and narrower bed, half the duration, and four slips instead of eight"),
        {.name = "contact-methods",
         .chapter = 8,
         .figures = {"Sec. 8.2"},
         .title = "Evolving contact, DVI and DEM",
         .shows = "Not in the dissertation, which names this comparison as future work: error over CPU time.",
         .study = "contact-methods",
         .arguments = {},
         .quick = {"--problem", "bowl"},
         .reduced = "one of four scenes, the ball sliding in a bowl",
         .page = "contact-methods.md",
         .checks = {{.what = "largest position error of evolving contact, ball in a bowl, h = 0.01 s [m]",
                     .column = "error",
                     .where = {{"part", "bowl"}, {"method", "evolving"}, {"h", "0.01"}},
                     .least = 0,
                     .most = 1e-4}},
         .timed = true}};
}

std::vector<Reproduction> all()
{
    std::vector<Reproduction> list;
    for (auto chapter : {chapter_3(), chapter_4(), chapter_5(), chapters_7_and_8()})
        list.insert(list.end(), chapter.begin(), chapter.end());
    return list;
}

}  // namespace

const std::vector<Reproduction>& reproductions()
{
    static const std::vector<Reproduction> list = all();
    return list;
}

}  // namespace hilda::studies
