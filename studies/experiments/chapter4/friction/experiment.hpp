// SPDX-License-Identifier: GPL-3.0-or-later
/// The experiments on friction: short runs of free bodies in contact, with what must come out of them.

#pragma once

#include "contact/scenes/scene.hpp"
#include "studies/running/vtk.hpp"

#include <functional>
#include <string>
#include <vector>

namespace hilda::studies::friction {

/// Samples of a run, a row for each node; the first column is t [s].
class Series {
public:
    Series() = default;
    explicit Series(std::vector<std::string> columns) : columns(std::move(columns)) {}

    void add(std::initializer_list<double> row) { values.insert(values.end(), row); }
    size_t rows() const { return columns.empty() ? 0 : values.size() / columns.size(); }
    /// The place of a column; columns.size() where there is none
    size_t place(const std::string& column) const;
    double at(size_t row, size_t column) const { return values[row * columns.size() + column]; }
    double at(size_t row, const std::string& column) const { return at(row, place(column)); }
    double last(const std::string& column) const { return at(rows() - 1, column); }
    /// All values of a column
    std::vector<double> all(const std::string& column) const;
    /// t of the first row from `from` s on of which this holds, NaN for none
    double when(const std::function<bool(size_t row)>& holds, double from = 0) const;

    std::vector<std::string> columns;
    std::vector<double> values;
};

/// Snapshots of a run at `count` of its nodes, the first, the last and evenly between
struct Frames {
    int count = 0;
    Snapshots snapshots = {};
};

/// Samples a column set at every node while a scene is stepped: what `row` says of the node that the step left, whose
/// loads are then in scene.pair; `before` is the scene's bodies at that node. Frames too, unless nullptr.
Series sample(contact::Scene& scene, double h, double end, Frames* frames, std::vector<std::string> columns,
              const std::function<void(Series&, const std::vector<contact::Motion>& before)>& row);

struct ExperimentRun {
    std::string name;
    std::function<Series(Frames*)> go;
    bool for_check = false;  ///< only its numbers are wanted, with --check
};

/// What came out, and what should have
struct Check {
    std::string what;
    double measured = 0, required = 0, tolerance = 0;
    std::string by;  ///< closed form, published run, ...

    bool passed() const { return std::abs(measured - required) <= tolerance; }
};

/// The series of an experiment, by the names of their runs
class Results {
public:
    Results(const std::vector<ExperimentRun>& runs, const std::vector<Series>& series)
        : runs(runs), series(series)
    {}
    /// nullptr for a run that was left out or failed
    const Series* find(const std::string& run) const;

private:
    const std::vector<ExperimentRun>& runs;
    const std::vector<Series>& series;
};

struct Experiment {
    std::string name, figure, what;
    std::vector<ExperimentRun> (*runs)() = nullptr;
    void (*checks)(const Results&, std::vector<Check>& out) = nullptr;
    bool in_space = false;  ///< its bodies are worth being looked at
};

const std::vector<Experiment>& experiments();
bool register_experiment(Experiment experiment);

/// Friction of a preset from the same parameters: "dissertation" or "balanced"
contact::FrictionParameters preset(const std::string& name, const contact::FrictionParameters& p);
inline const std::vector<std::string> presets = {"dissertation", "balanced"};
std::shared_ptr<const contact::FrictionModel> law(const contact::FrictionParameters& p,
                                                  const std::string& name = "slide-roll-spin");

/// A shape at the origin of its body
template <class Surface, class... Of>
contact::Shape shape(Of... of)
{
    return {.surface = std::make_shared<Surface>(of...)};
}

contact::Motion at(const lie::Vec3& r, const lie::Vec3& rdot = lie::Vec3::Zero());
contact::Inertia solid_sphere(double m, double R);

}  // namespace hilda::studies::friction
