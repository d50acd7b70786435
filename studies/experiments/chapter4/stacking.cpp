// SPDX-License-Identifier: GPL-3.0-or-later
/// Critical mass of a stack of three spheres over the rolling resistance (Fang 2022, Fig. 4.19a).
///
/// For each gap between the lower spheres and each η_r, the critical mass is the smallest mass of the upper
/// sphere for which the stack collapses. It is found by bisection between 0.25 kg and 4 kg to one gram. The
/// collapse mode is the motion of the lower spheres on the ground at the critical mass: rolling, sliding or
/// both (Figs. 4.19c, e, g). The default preset is `dissertation`. --check compares the results with
/// reference values, computes one cell again with a fifth of the step, and returns exit code 6 if a criterion
/// fails.

#include "studies/experiments/chapter4/stack.hpp"
#include "studies/framework/columns.hpp"
#include "studies/framework/csv_table.hpp"
#include "studies/framework/study_context.hpp"

#include "lie/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace hilda::studies {

namespace {

constexpr double kilogram = 1000;  // [g]
constexpr int refinement = 5;      // ratio of the steps of the cell that --check computes again
// Bounds of the bisection [g]. A lighter upper sphere is unstable with the normal damping of the mean mass.
constexpr int min_grams = 250, max_grams = 4000;

struct StackGrid {
    std::string name;
    std::vector<double> gaps, etas;
};

std::vector<double> etas()
{
    std::vector<double> all;
    for (int k = 15; k <= 30; ++k) all.push_back(k / 100.);
    for (int k = 35; k <= 60; k += 5) all.push_back(k / 100.);
    return all;
}

/// Grids of --grid; the first is the default
const std::vector<StackGrid> grids = {{"dissertation", {0.20, 0.25, 0.30, 0.35, 0.40}, etas()},
                                      {"coarse", {0.20, 0.40}, {0.15, 0.21, 0.24, 0.60}}};

struct StackCell {
    Stack stack = {};                           ///< the upper sphere has the critical mass
    StackOutcome below = {}, at_critical = {};  ///< outcomes one gram below and at the critical mass
    bool found = false;                         ///< the critical mass is within the bounds of the bisection
    double published = std::nan("");
    int runs = 0, undecided = 0;

    double m_c() const { return found ? stack.top : std::nan(""); }
};

std::string gap_text(double gap) { return fmt::format("{:.2f}R", gap); }

void bisect(StackCell& cell, double h, double end)
{
    const auto run_with = [&](int grams) {
        cell.stack.top = grams / kilogram;
        contact::Scene run_scene = scene(cell.stack);
        if (cell.runs == 0) run_scene.check(h);
        const StackOutcome f = run_until_decided(run_scene, h, end);
        ++cell.runs;
        cell.undecided += f.state == StackOutcome::undecided;
        return f;
    };
    int lower = min_grams, upper = max_grams;
    cell.below = run_with(lower), cell.at_critical = run_with(upper);
    if (cell.below.state == StackOutcome::collapses || cell.at_critical.state != StackOutcome::collapses)
        return;
    while (upper - lower > 1) {
        const int middle = (lower + upper) / 2;
        const StackOutcome f = run_with(middle);
        if (f.state == StackOutcome::collapses)
            upper = middle, cell.at_critical = f;
        else
            lower = middle, cell.below = f;
    }
    cell.stack.top = upper / kilogram;
    cell.found = true;
}

std::string collapse_mode(const StackCell& cell)
{
    const StackOutcome& f = cell.at_critical;
    return !cell.found           ? "-"
           : f.rolls && f.slides ? "both"
           : f.rolls             ? "rolling"
           : f.slides            ? "sliding"
                                 : "-";
}

/// Differences to the masses of the file
struct MassAgreement {
    long compared = 0;
    double rms = 0, largest = 0;  ///< [kg]
};

MassAgreement agreement(const std::vector<StackCell>& cells)
{
    MassAgreement a;
    for (const StackCell& cell : cells) {
        const double difference = cell.m_c() - cell.published;
        if (std::isnan(difference)) continue;
        ++a.compared;
        a.rms += difference * difference;
        a.largest = std::max(a.largest, std::abs(difference));
    }
    a.rms = std::sqrt(a.rms / static_cast<double>(a.compared));
    return a;
}

/// Reads published masses from a table with columns eta_r, m_c_gap_0.20R, ... into the cells
void read_published(std::vector<StackCell>& cells, const std::string& file)
{
    const CsvTable table = read_csv_table(file);
    const std::vector<double> eta = table.values("eta_r");
    bool any = false;
    for (StackCell& cell : cells) {
        const size_t column = table.column("m_c_gap_" + gap_text(cell.stack.gap));
        for (size_t k = 0; k < eta.size(); ++k)
            if (std::abs(eta[k] - cell.stack.eta_r) < 1e-9)
                cell.published = table.rows[k][column], any = true;
    }
    if (!any) throw lie::InvalidInput(file + ": has no eta_r of this grid");
}

/// Features of the curve of one gap
struct MassCurve {
    double peak_eta = std::nan(""), peak_mass = 0;
    double plateau = std::nan("");  ///< mass at the largest η_r [kg]
};

MassCurve curve(const std::vector<StackCell>& cells, double gap)
{
    MassCurve c;
    for (const StackCell& cell : cells) {
        if (cell.stack.gap != gap) continue;
        if (cell.m_c() > c.peak_mass) c.peak_eta = cell.stack.eta_r, c.peak_mass = cell.m_c();
        c.plateau = cell.m_c();
    }
    return c;
}

const Columns<StackCell> columns_of_cells = {
    {"gap", [](const StackCell& c) { return c.stack.gap; }},
    {"eta_r", [](const StackCell& c) { return c.stack.eta_r; }},
    {"critical_mass", &StackCell::m_c},
    {"collapse_mode", collapse_mode},
    {"published", &StackCell::published},
    {"difference", [](const StackCell& c) { return c.m_c() - c.published; }},
    {"t_stands", [](const StackCell& c) { return c.below.t; }},
    {"t_collapses", [](const StackCell& c) { return c.at_critical.t; }},
    {"runs", &StackCell::runs},
    {"undecided", &StackCell::undecided}};

void print(const std::vector<StackCell>& cells, const StackGrid& g, std::ostream& out)
{
    std::vector<Table::Column> columns = {{"eta_r", "{:.2f}"}};
    for (const double gap : g.gaps)
        columns.push_back({"gap " + gap_text(gap), "{:.3f}"}), columns.push_back({"mode"});
    Table table(columns);
    for (size_t e = 0; e < g.etas.size(); ++e) {
        std::vector<Table::Cell> row = {g.etas[e]};
        for (size_t k = 0; k < g.gaps.size(); ++k) {
            const StackCell& cell = cells[k * g.etas.size() + e];
            row.emplace_back(cell.m_c());
            row.emplace_back(collapse_mode(cell));
        }
        table.add(row);
    }
    table.print(out);
}

/// Reference values for both presets: the η_r of the published peaks, and the plateau masses [kg] computed
/// when the published curves were reproduced
struct ExpectedCurve {
    double gap, peak_eta, plateau;
};
constexpr std::array<ExpectedCurve, 5> expected_curves = {{{0.20, 0.21, 1.840},
                                                           {0.25, 0.22, 1.701},
                                                           {0.30, 0.23, 1.579},
                                                           {0.35, 0.23, 1.471},
                                                           {0.40, 0.24, 1.374}}};
constexpr double mass_tolerance = 0.005;  // [kg]; covers the influence of the step and of the preset

const ExpectedCurve& expected_curve(double gap)
{
    return *std::find_if(expected_curves.begin(), expected_curves.end(),
                         [&](const ExpectedCurve& k) { return k.gap == gap; });
}

/// The cell that is computed again with a smaller step: the peak of the middle gap, at the transition from
/// rolling to sliding
const StackCell& refined_cell_of(const std::vector<StackCell>& cells, const StackGrid& g)
{
    const ExpectedCurve& k = expected_curve(g.gaps[g.gaps.size() / 2]);
    return *std::find_if(cells.begin(), cells.end(), [&](const StackCell& c) {
        return c.stack.gap == k.gap && c.stack.eta_r == k.peak_eta;
    });
}

std::vector<Criterion> criteria(const std::vector<StackCell>& cells, const StackGrid& g,
                                const StackCell& refined, double h)
{
    std::vector<Criterion> all;
    for (const double gap : g.gaps) {
        const ExpectedCurve& expected = expected_curve(gap);
        const MassCurve c = curve(cells, gap);
        all.push_back(criterion("eta_r of the largest critical mass, gap " + gap_text(gap), c.peak_eta,
                                expected.peak_eta, 1e-9));
        all.push_back(criterion(
            fmt::format("critical mass at eta_r = {:.2f}, gap {} [kg]", g.etas.back(), gap_text(gap)),
            c.plateau, expected.plateau, mass_tolerance));
    }
    const StackCell& coarse = refined_cell_of(cells, g);
    all.push_back(criterion(
        fmt::format("critical mass with h = {:g} s minus that with h = {:g} s, gap {}, eta_r = {:.2f} [kg]",
                    h / refinement, h, gap_text(coarse.stack.gap), coarse.stack.eta_r),
        refined.m_c() - coarse.m_c(), 0, mass_tolerance));
    return all;
}

std::vector<std::string> keys()
{
    std::vector<std::string> all = {"rms", "largest", "undecided"};
    for (const double gap : grids.front().gaps)
        for (const char* what : {"peak_eta_", "peak_mass_", "plateau_"}) all.push_back(what + gap_text(gap));
    return all;
}

void stacking(StudyContext& s)
{
    s.refuse_models();
    const StudyOptions& options = s.options;
    const double h = s.one_step(1e-4), end = options.end.value_or(10);
    const std::string preset = options.preset.empty() ? "dissertation" : options.preset;
    const StackGrid& g = one_of_list("--grid", options.grid, grids);
    std::vector<StackCell> cells;
    for (const double gap : g.gaps)
        for (const double eta : g.etas)
            cells.push_back({.stack = {.gap = gap, .eta_r = eta, .dissertation = preset == "dissertation"}});
    if (!options.against.empty()) read_published(cells, options.against);
    StackCell refined{.stack = refined_cell_of(cells, g).stack};
    const auto jobs = static_cast<long>(cells.size());
    s.pool(cells.size() + options.check).run([&](long k) {
        if (k < jobs)
            bisect(cells[k], h, end);
        else
            bisect(refined, h / refinement, end);
    });

    s.json = {{"preset", preset}, {"h", h}, {"end", end}, {"grid", g.name}};
    s.text << fmt::format(
        "\ncritical mass [kg] of the upper sphere and collapse mode of the lower spheres; "
        "{} friction, h = {:g} s\n",
        preset, h);
    print(cells, g, s.text);
    std::vector<Criterion> checks;
    if (options.check) checks = criteria(cells, g, refined, h);
    int undecided = 0;
    for (const StackCell& c : cells) undecided += c.undecided;
    io::Json curves = io::Json::array();
    s.text << '\n';
    for (const double gap : g.gaps) {
        const MassCurve c = curve(cells, gap);
        s.text << fmt::format(
            "gap {0}: maximum {2:.3f} kg at eta_r = {1:.2f}; {4:.3f} kg at eta_r = {3:.2f}\n", gap_text(gap),
            c.peak_eta, c.peak_mass, g.etas.back(), c.plateau);
        s.measured.push_back({.of = "gap " + gap_text(gap),
                              .value = {{"peak_eta_" + gap_text(gap), c.peak_eta},
                                        {"peak_mass_" + gap_text(gap), c.peak_mass},
                                        {"plateau_" + gap_text(gap), c.plateau}}});
        curves.push_back(
            {{"gap", gap}, {"peak_eta", c.peak_eta}, {"peak_mass", c.peak_mass}, {"plateau", c.plateau}});
    }
    if (undecided > 0)
        s.text << fmt::format("{} runs were undecided after {:g} s; they count as stable\n", undecided, end);
    s.measured.push_back({.of = s.name, .value = {{"undecided", undecided}}});
    s.json.update({{"undecided", undecided}, {"curves", curves}});
    if (!options.against.empty()) {
        const MassAgreement a = agreement(cells);
        s.text << fmt::format(
            "comparison with {}: {} masses, rms difference {:.4f} kg, largest difference {:.3f} kg\n",
            options.against, a.compared, a.rms, a.largest);
        s.measured.push_back({.of = options.against, .value = {{"rms", a.rms}, {"largest", a.largest}}});
        s.json["against"] = {
            {"file", options.against}, {"compared", a.compared}, {"rms", a.rms}, {"largest", a.largest}};
        checks.push_back(between("rms difference to the file [kg]", a.rms, 0, 0.01));
        checks.push_back(between("largest difference to the file [kg]", a.largest, 0, 0.02));
    }
    if (options.check) s.evaluate(checks);
    s.table = columns_of_cells.csv(cells);
    s.figures = {"stacking.png"};
}

const bool registered = io::Registry<Study>::add(
    {.name = "stacking",
     .answers =
         "critical mass of a stack of three spheres over rolling resistance (Fig. 4.19); default preset: "
         "dissertation",
     .accepted = takes::preset | takes::against | takes::grid | takes::check,
     .keys = keys(),
     .run = stacking});

}  // namespace

}  // namespace hilda::studies
