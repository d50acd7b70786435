// SPDX-License-Identifier: GPL-3.0-or-later
/// The list of `hilda reproduce`. The criteria of an entry are those of its study, --check.
#include "studies/program/repeating/reproduction.hpp"

#include <sstream>

namespace hilda::studies {

const std::vector<Reproduction>& reproductions()
{
    // name, chapter, figures, title, what they show, study with its arguments, those of --quick, those of
    // --full, what --quick leaves out, whether it measures time
    static const std::vector<Reproduction> all = {
        {"mechanisms", 3, "Fig. 3.3, Table 3.1", "Mechanisms",
         "Double pendulum, slider-crank and four-link at four times; their constraints and degrees of "
         "freedom.",
         "snapshots --check"},
        {"order-1", 3, "Fig. 3.4", "Error over step, schemes of first order",
         "Error of the half-implicit and the fully implicit scheme over the step: z of bar 2 of the double "
         "pendulum, velocities of slider-crank and four-link. Slope 1.",
         "convergence --check --integrator rA-full-1,rA-half-1 --problem "
         "double_pendulum,slider_crank,four_link",
         "--steps 4e-3,2e-3,1e-3,5e-4", "--steps 1e-2,5e-3,2e-3,1e-3,5e-4,2e-4,1e-4,5e-5,2e-5,1e-5",
         "four steps from 4e-3 s to 5e-4 s instead of ten from 1e-2 s to 1e-5 s"},
        {"energy", 3, "Fig. 3.5", "Energy of the double pendulum",
         "The fully implicit scheme loses energy, the half-implicit scheme does not (planar motion).",
         "energy --check --problem double_pendulum --integrator rA-full-1,rA-half-1", "--end 30", "--end 100",
         "30 s instead of 100 s"},
        {"order-2", 3, "Figs. 3.6, 3.7, 3.8",
         "Error over step, half-implicit schemes of first and second order",
         "Errors of r, A, the velocity and the angular velocity of one body at the end of the run. Slopes 1 "
         "and "
         "2.",
         "convergence --check --integrator rA-half-1,rA-half-2 --problem "
         "double_pendulum,slider_crank,four_link",
         "--steps 4e-3,2e-3,1e-3,5e-4", "--steps 1e-2,5e-3,2e-3,1e-3,5e-4,2e-4,1e-4",
         "four steps from 4e-3 s to 5e-4 s instead of seven from 1e-2 s to 1e-4 s"},
        {"iterations", 3, "Figs. 3.9, 3.11, 3.12, 3.13", "Newton iterations per step",
         "Iterations over the step: half-implicit and fully implicit scheme, first and second order.",
         "iterations --check --integrator rA-full-1,rA-half-1,rA-half-2", "--steps 1e-2,1e-3",
         "--steps 1e-2,1e-3,1e-4", "without the step 1e-4 s"},
        {"timing", 3, "Fig. 3.10", "CPU time over step",
         "CPU time of the half-implicit and the fully implicit scheme.",
         "timing --check --integrator rA-full-1,rA-half-1", "--steps 1e-2,1e-3 --repeats 3", "",
         "without the smallest steps; three repetitions instead of five", true},
        {"scaling", 3, "Fig. 3.15", "CPU time over the number of bars",
         "CPU time of a step of the pendulum of N bars, half-implicit and fully implicit scheme.",
         "scaling --check", "--bars 1,2,4,8,16,32,64 --repeats 3", "",
         "up to 64 bars instead of 1024 (the dissertation: 32); three repetitions instead of five", true},
        {"friction-brick", 4, "Fig. 4.6", "Brick on an incline of 0.18 rad",
         "Slip and friction force with and without damping.", "friction --check --problem brick"},
        {"friction-brick-angles", 4, "Fig. 4.7", "Brick on three inclines",
         "Inclines of atan mu_k, atan mu_s and 0.25 rad.", "friction --check --problem brick-angles"},
        {"friction-disk", 4, "Fig. 4.9", "Rolling disk",
         "Positions, velocities, accelerations and friction of a disk that slides and then rolls.",
         "friction --check --problem disk"},
        {"friction-disk-damping", 4, "Fig. 4.10", "Rolling disk with other dampings",
         "The disk of Fig. 4.9 with other damping.", "friction --check --problem disk-damping"},
        {"friction-rolling-models", 4, "Fig. 4.11", "Rolling resistance at rest",
         "Constant torque and history model of rolling resistance at rest.",
         "friction --check --problem rolling-models"},
        {"friction-incline", 4, "Fig. 4.12", "Sphere up an incline of 35 degrees",
         "Sliding, rolling and return of a sphere; snapshots.", "friction --check --problem incline"},
        {"incline-sweep", 4, "Fig. 4.13", "Final states of a sphere on an incline",
         "Rest, rolling or sliding over the slope and the rolling resistance.", "incline-sweep --check",
         "--grid coarse", "--grid published",
         "a coarse grid of slopes and coefficients instead of the 23571 published states"},
        {"friction-spin", 4, "Figs. 4.14, 4.15", "Spinning sphere",
         "Spin of a sphere that comes to rest, heuristic model; snapshots.",
         "friction --check --problem spin"},
        {"friction-spin-hertz", 4, "Fig. 4.16", "Spinning spheres of steel and glass",
         "Spin that comes to rest, Hertz model.", "friction --check --problem spin-hertz"},
        {"friction-ellipsoid", 4, "Fig. 4.17", "Ellipsoid that falls over",
         "Motion of an ellipsoid that stands upright at the start; snapshots.",
         "friction --check --problem ellipsoid"},
        {"friction-spin-ellipsoid", 4, "Fig. 4.18, Table 4.7", "Spinning ellipsoid",
         "Spin on the pole and on the side; spinning torque over the curvature.",
         "friction --check --problem spin-ellipsoid"},
        {"stacking", 4, "Fig. 4.19", "Critical mass of three stacked spheres",
         "Largest mass of the upper sphere that the lower spheres carry, over the rolling resistance; "
         "snapshots.",
         "stacking --check", "--grid coarse", "--grid dissertation",
         "a coarse grid instead of the 110 published masses"},
        {"evolving-contact", 5, "Figs. 5.2, 5.3, 5.4, 5.5, 5.6", "Ball in an ellipsoidal bowl",
         "Trajectories of the contact points, residuals of the constraints, and the normal force.",
         "evolving-contact --check"},
        {"evolving-friction", 5, "Figs. 5.7, 5.8", "Ball in a bowl with friction",
         "Trajectory of the contact point, forces, rolling torque and velocities for eta_r = 0 to 0.3.",
         "evolving-friction --check"},
        {"granular-head-on", 7, "Fig. 7.2", "Head-on collision",
         "Rebound velocity over the coefficient of restitution.", "granular-head-on --check", "",
         "--grid full", "fewer instants of contact within a step"},
        {"granular-brick", 7, "Fig. 7.4", "Sliding brick",
         "Sliding distance over the coefficient of friction.", "granular-brick --check", "", "--grid full",
         "the incremental law for coefficients of 0.4 and above only"},
        {"granular-oblique", 7, "Fig. 7.6", "Oblique impact",
         "Tangential restitution and spin after an oblique impact, over the angle.",
         "granular-oblique --check", "", "--grid full", "each fifth degree instead of each degree"},
        {"granular-stacking", 7, "Fig. 7.7", "Critical mass of three stacked grains",
         "Critical mass over the rolling friction.", "granular-stacking --check", "", "--grid full",
         "fewer coefficients of rolling friction and gaps"},
        {"granular-waves", 7, "Figs. 7.9, 7.10", "Force on the floor under a lattice",
         "Profiles of the force on the floor under a point load.", "granular-waves --check", "",
         "--grid full", "fewer stiffnesses, and a shorter load"},
        {"granular-shear", 7, "Fig. 7.12", "Direct shear of grains",
         "Shear stress over the shear displacement and the normal stress.", "granular-shear --check", "",
         "--grid full", "grains of 4 mm radius instead of 3 mm, and 6 mm of displacement instead of 10 mm"},
        {"granular-cratering", 7, "Fig. 7.14", "Crater of a ball in a bed of grains",
         "Depth of the crater over the scaled height of fall.", "granular-cratering --check", "",
         "--grid full", "grains of 2 mm radius instead of 1 mm, and fewer balls"},
        {"granular-low-velocity-cratering", 7, "Figs. 7.15, 7.16, 7.18", "Impact of a sphere at low velocity",
         "Depth, duration and peak acceleration over the speed, the rolling friction and the gravity.",
         "granular-low-velocity-cratering --check", "", "--grid full",
         "two speeds and rolling frictions, and one impact in reduced gravity"},
        {"granular-drum", 7, "Fig. 7.19", "Grains in a rotating drum",
         "Flow of the grains, coloured by their speed, over the Froude number.", "granular-drum --check", "",
         "--grid full", "grains of 1 mm radius instead of 0.5 mm, and fewer speeds"},
        {"granular-wheel", 7, "Figs. 7.21, 7.23, 7.25", "Single wheel on grains",
         "Pull, driving torque and sinkage over the slip, in plane strain; in the full grid also of a "
         "cylinder "
         "with end faces and of a tyre.",
         "granular-wheel --check", "", "--grid full",
         "a narrower bed, four slips instead of nine, one bed instead of four, and no cylinder with end "
         "faces "
         "and no tyre"},
        {"granular-tyre", 7, "Fig. 7.20", "Single-wheel rig with a tyre on grains",
         "Pull, driving torque and sinkage over the imposed slip, and the free slip under a torque, in "
         "co-simulation.",
         "granular-tyre --check", "", "--grid full",
         "a shorter and narrower bed, half the duration, and four slips instead of eight"},
        {"contact-methods", 8, "Sec. 8.2", "Evolving contact, DVI and DEM",
         "Not in the dissertation, which names this comparison as future work: error over CPU time.",
         "contact-methods --check", "--problem bowl", "", "one of four scenes, the ball sliding in a bowl",
         true},
    };
    return all;
}

std::vector<std::string> Reproduction::words(bool of_full) const
{
    std::istringstream in("hilda study " + study + ' ' + (of_full ? full : quick));
    std::vector<std::string> all;
    for (std::string word; in >> word;) all.push_back(word);
    return all;
}

}  // namespace hilda::studies
