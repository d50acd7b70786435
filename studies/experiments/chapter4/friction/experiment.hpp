// SPDX-License-Identifier: GPL-3.0-or-later
/// Friction experiments (Fang 2022, Sec. 4.4): short runs of free bodies in contact, and their acceptance
/// criteria.

#pragma once

#include "contact/scenes/scene.hpp"
#include "io/registry.hpp"
#include "studies/running/vtk.hpp"

#include <functional>
#include <string>
#include <vector>

namespace hilda::studies::friction {

/// Samples of a run, one row for each node; the first column is t [s].
class Series {
public:
    Series() = default;
    explicit Series(std::vector<std::string> columns) : columns(std::move(columns)) {}

    void add(std::initializer_list<double> row) { values.insert(values.end(), row); }
    size_t rows() const { return columns.empty() ? 0 : values.size() / columns.size(); }
    /// Index of a column; columns.size() if there is no such column
    size_t column_index(const std::string& column) const;
    double at(size_t row, size_t column) const { return values[row * columns.size() + column]; }
    double at(size_t row, const std::string& column) const { return at(row, column_index(column)); }
    double last(const std::string& column) const { return at(rows() - 1, column); }
    /// All values of a column
    std::vector<double> all(const std::string& column) const;
    /// Time [s] of the first row with t >= from that satisfies the condition; NaN if there is none
    double first_time(const std::function<bool(size_t row)>& condition, double from = 0) const;

    std::vector<std::string> columns;
    std::vector<double> values;
};

/// Snapshots of a run at `count` nodes: the first, the last and evenly distributed nodes between
struct Frames {
    int count = 0;
    Snapshots snapshots = {};
};

/// Integrates a scene with step h [s] to `end` [s] and records a row for every node.
///
/// `row` is called after each step for the node at the start of the step: `before` are the bodies at that
/// node, and scene.pair contains the contact loads at that node. Snapshots are stored in `frames` unless it
/// is nullptr.
Series sample(contact::Scene& scene, double h, double end, Frames* frames, std::vector<std::string> columns,
              const std::function<void(Series&, const std::vector<contact::Motion>& before)>& row);

/// One run of an experiment
struct ExperimentRun {
    std::string name;
    std::function<Series(Frames*)> compute;
    bool check_only = false;  ///< run only with --check
};

/// Acceptance criterion of an experiment: |measured - required| <= tolerance
struct Check {
    std::string what;
    double measured = 0, required = 0, tolerance = 0;
    std::string source;  ///< origin of the required value: closed form, published run, ...

    bool passed() const { return std::abs(measured - required) <= tolerance; }
};

/// The series of an experiment, by the names of the runs
class Results {
public:
    Results(const std::vector<ExperimentRun>& runs, const std::vector<Series>& series)
        : runs(runs), series(series)
    {}
    /// nullptr for a run that was not selected or failed
    const Series* find(const std::string& run) const;

private:
    const std::vector<ExperimentRun>& runs;
    const std::vector<Series>& series;
};

/// An experiment: name, figure of the dissertation, description, runs and criteria
struct Experiment {
    std::string name, figure, what;
    std::vector<ExperimentRun> (*runs)() = nullptr;
    void (*checks)(const Results&, std::vector<Check>& out) = nullptr;
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
/// Friction law with these parameters
std::shared_ptr<const contact::FrictionModel> law(const contact::FrictionParameters& p,
                                                  const std::string& name = "slide-roll-spin");

/// A surface in the body frame
template <class Surface, class... Args>
contact::Shape shape(Args... args)
{
    return {.surface = std::make_shared<Surface>(args...)};
}

/// Motion with position r [m] and velocity rdot [m/s], without rotation
contact::Motion at(const lie::Vec3& r, const lie::Vec3& rdot = lie::Vec3::Zero());
/// Mass and moment of inertia 2/5 m R² of a homogeneous sphere
contact::Inertia solid_sphere(double m, double R);

}  // namespace hilda::studies::friction
