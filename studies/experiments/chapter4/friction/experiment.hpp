// SPDX-License-Identifier: GPL-3.0-or-later
/// Friction experiments (Fang 2022, Sec. 4.4): short runs of one body on a plane, and their acceptance
/// criteria.

#pragma once

#include "contact/scenes/scene.hpp"
#include "io/registry.hpp"
#include "run/frames/vtk.hpp"
#include "studies/framework/curve.hpp"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace hilda::studies::friction {

/// A node of a run: the body, and the loads and springs of its contact at this node
struct Node {
    contact::Scene& scene;
    const contact::Motion& body;
    contact::Scene::Pair& pair;
    const contact::Wrench& wrench = pair.wrench;
    contact::Deflections& springs = pair.history.deflections;
    const lie::Vec3 omega = body.A * body.omega_bar;  ///< global [rad/s]
};

/// A body in contact with the plane z = 0 of a second body, and the quantities recorded at every node
struct BodyOnPlane {
    std::string name;
    contact::Inertia inertia = {};
    contact::Motion start = {};
    contact::Shape shape = {};
    lie::Vec3 gravity = {0, 0, -9.8};  ///< [m/s²]
    std::shared_ptr<const contact::NormalLaw> normal = {};
    contact::FrictionParameters friction = {};
    std::string friction_law = "slide-roll-spin";
    contact::Motion plane = {};
    double h = 1e-4, end = 1;            ///< [s]
    bool above_stability_limit = false;  ///< no check of the step
    std::vector<std::string> columns = {};
    std::function<void(Curve&, Node)> record = {};
};

/// Snapshots of a run: at `count` nodes, the first, the last and evenly distributed nodes between, and at the
/// nodes nearest to `times` [s]
struct Frames {
    int count = 0;
    std::vector<double> times = {};
    run::Snapshots snapshots = {};
};

/// Adds a frame at the time of the scene, with the contacts that have a normal force. `bodies`: the motions
/// at this time; those of the scene may be a step later, as simulate() has them
void add_frame(run::Snapshots& to, const contact::Scene& scene, const std::vector<contact::Motion>& bodies);

/// Integrates with the step h to the end. The record of a node is made after the step from this node, which
/// computes the contact loads at it. Snapshots are stored in each of `frames`.
Curve simulate(const BodyOnPlane& setup, std::span<Frames> frames = {});

/// One run of an experiment
struct ExperimentRun {
    std::string name;
    std::function<BodyOnPlane()> setup;
    bool check_only = false;  ///< run only with --check
    /// Times [s] of the snapshots of the dissertation; empty: the run has none
    std::vector<double> snapshots = {};
};

using Measure = std::function<double(const Curve&)>;

/// Acceptance criterion of a run: |measured - required| <= tolerance. It is left out if the run was not
/// selected or failed. A criterion without a run belongs to no curve.
struct Expected {
    std::string run = {}, what;
    Measure measure = {};
    double required = 0, tolerance = 0;
    std::string source;  ///< origin of the required value: closed form, published run, ...
};

/// The value of the last row, and the number of rows in which a quantity is 1
Measure last(const std::string& column);
Measure count(const std::string& column);
/// Rate of a quantity in the last step of h [s]
Measure last_rate(const std::string& column, double h);
/// Time [s] of the first row with t >= from in which the quantity satisfies the condition
Measure first(const std::string& column, bool (*condition)(double), double from = 0);

/// An experiment: name, figure of the dissertation, description, runs and criteria
struct Experiment {
    std::string name, figure, what;
    std::vector<ExperimentRun> runs = {};
    std::vector<Expected> expected = {};
    bool has_frames = false;  ///< the experiment writes frames with --vtk
};

/// All experiments, sorted by name; a file adds one by register_experiment.
inline const std::vector<Experiment>& experiments() { return io::Registry<Experiment>::all(); }
inline bool register_experiment(Experiment experiment)
{
    return io::Registry<Experiment>::add(std::move(experiment));
}

/// Friction parameters with the choices of a preset: "dissertation" or "balanced"
contact::FrictionParameters preset(const std::string& name, const contact::FrictionParameters& p);
inline const std::vector<std::string> presets = {"dissertation", "balanced"};

/// A surface in the body frame
template <class Surface, class... Args>
contact::Shape shape(Args... args)
{
    return {.surface = std::make_shared<Surface>(args...)};
}
/// A constant normal force [N]
inline auto given_force(double N) { return std::make_shared<contact::GivenForce>(N); }

/// Motion with position r [m] and velocity rdot [m/s], without rotation
contact::Motion at(const lie::Vec3& r, const lie::Vec3& rdot = lie::Vec3::Zero());
/// Mass and moment of inertia 2/5 m R² of a homogeneous sphere
contact::Inertia solid_sphere(double m, double R);

}  // namespace hilda::studies::friction
