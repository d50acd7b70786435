// SPDX-License-Identifier: GPL-3.0-or-later
/// Critical mass of a stack of three spheres over the rolling resistance (Fang 2022, Fig. 4.19a).
///
/// For each gap between the lower spheres and each η_r, the critical mass is the smallest mass of the upper
/// sphere for which the stack collapses. It is found by bisection between 0.25 kg and 4 kg to one gram. The
/// collapse mode is the motion of the lower spheres on the ground at the critical mass: rolling, sliding or
/// both (Figs. 4.19c, e, g). Snapshots show stacks one gram lighter, which stand, and 0.01 kg heavier than
/// these, which collapse. The default preset is `dissertation`. --check compares the results with reference
/// values, computes one cell again with a fifth of the step, and returns exit code 6 if a criterion fails.

#include "io/message.hpp"
#include "studies/experiments/chapter4/stack_snapshots.hpp"
#include "studies/framework/columns.hpp"
#include "studies/framework/published.hpp"

#include <fmt/format.h>

#include <map>

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
const std::vector<StackGrid> stack_grids = {{"dissertation", {0.20, 0.25, 0.30, 0.35, 0.40}, etas()},
                                            {"coarse", {0.20, 0.40}, {0.15, 0.21, 0.24, 0.60}}};

struct StackCell {
    Stack stack = {};                           ///< the upper sphere has the critical mass
    StackOutcome below = {}, at_critical = {};  ///< outcomes one gram below and at the critical mass
    bool found = false;                         ///< the critical mass is within the bounds of the bisection
    double published = std::nan("");
    int runs = 0, undecided = 0;

    void transfer(io::Archive& a)
    {
        a.value(stack.top), a.value(below), a.value(at_critical);
        a.value(found), a.value(runs), a.value(undecided);
    }
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

/// The cells of one gap, and features of their curve
struct MassCurve {
    std::string gap;
    std::vector<const StackCell*> cells;
    double peak_eta = std::nan(""), peak_mass = 0;
    double plateau = std::nan("");  ///< mass at the largest η_r [kg]
};

std::vector<MassCurve> curves_of(const std::vector<StackCell>& cells, const StackGrid& g)
{
    std::vector<MassCurve> all;
    for (const double gap : g.gaps) {
        MassCurve& c = all.emplace_back(MassCurve{
            gap_text(gap), those(cells, [&](const StackCell& cell) { return cell.stack.gap == gap; })});
        for (const StackCell* cell : c.cells)
            if (cell->m_c() > c.peak_mass) c.peak_eta = cell->stack.eta_r, c.peak_mass = cell->m_c();
        c.plateau = c.cells.back()->m_c();
    }
    return all;
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

void print(const std::vector<MassCurve>& curves, StudyText& out)
{
    std::vector<Table::Column> columns = {{"eta_r", "{:.2f}"}};
    for (const MassCurve& c : curves)
        columns.push_back({"gap " + c.gap, "{:.3f}"}), columns.push_back({"mode"});
    Table table(columns);
    for (size_t e = 0; e < curves.front().cells.size(); ++e) {
        std::vector<Table::Cell> row = {curves.front().cells[e]->stack.eta_r};
        for (const MassCurve& c : curves)
            row.insert(row.end(), {c.cells[e]->m_c(), collapse_mode(*c.cells[e])});
        table.add(row);
    }
    table.print(out);
}

/// Reference values for both presets, by gap: the η_r of the published peaks, and the plateau masses [kg]
/// computed when the published curves were reproduced
struct ExpectedCurve {
    double peak_eta, plateau;
};
const std::map<double, ExpectedCurve> expected_curves = {{0.20, {0.21, 1.840}},
                                                         {0.25, {0.22, 1.701}},
                                                         {0.30, {0.23, 1.579}},
                                                         {0.35, {0.23, 1.471}},
                                                         {0.40, {0.24, 1.374}}};
constexpr double mass_tolerance = 0.005;  // [kg]; covers the influence of the step and of the preset

/// The cell that is computed again with a smaller step: the peak of the middle gap, at the transition from
/// rolling to sliding
const StackCell& refined_cell_of(const std::vector<StackCell>& cells, const StackGrid& g)
{
    const double gap = g.gaps[g.gaps.size() / 2], eta_r = expected_curves.at(gap).peak_eta;
    return *those(cells, [&](const StackCell& c) {
                return c.stack.gap == gap && c.stack.eta_r == eta_r;
            }).front();
}

std::vector<Criterion> criteria(const std::vector<MassCurve>& curves, const StackCell& coarse,
                                const StackCell& refined, double h)
{
    std::vector<Criterion> all;
    for (const MassCurve& c : curves) {
        const StackCell& last = *c.cells.back();
        const ExpectedCurve& expected = expected_curves.at(last.stack.gap);
        all.push_back(criterion("eta_r of the largest critical mass, gap " + c.gap, c.peak_eta,
                                expected.peak_eta, 1e-9));
        all.push_back(
            criterion(fmt::format("critical mass at eta_r = {:.2f}, gap {} [kg]", last.stack.eta_r, c.gap),
                      c.plateau, expected.plateau, mass_tolerance));
    }
    all.push_back(criterion(
        fmt::format("critical mass with h = {:g} s minus that with h = {:g} s, gap {}, eta_r = {:.2f} [kg]",
                    h / refinement, h, gap_text(coarse.stack.gap), coarse.stack.eta_r),
        refined.m_c() - coarse.m_c(), 0, mass_tolerance));
    return all;
}

std::vector<std::string> keys()
{
    std::vector<std::string> all = {"rms", "largest", "undecided"};
    for (const double gap : stack_grids.front().gaps)
        for (const char* what : {"peak_eta_", "peak_mass_", "plateau_"}) all.push_back(what + gap_text(gap));
    return all;
}

/// Compares the masses with those of the file.
void compare(StudyContext& s, const std::vector<StackCell>& cells, std::vector<Criterion>& checks)
{
    long compared = 0;
    double squares = 0, largest = 0;  // of the differences [kg]
    for (const StackCell& cell : cells) {
        const double difference = cell.m_c() - cell.published;
        if (std::isnan(difference)) continue;
        ++compared;
        squares += difference * difference;
        largest = std::max(largest, std::abs(difference));
    }
    const double rms = std::sqrt(squares / static_cast<double>(compared));
    s.text << fmt::format(
        "comparison with {}: {} masses, rms difference {:.4f} kg, largest difference {:.3f} kg\n", s.against,
        compared, rms, largest);
    s.json["against"] = {{"file", s.against}, {"compared", compared}};
    s.json["against"].update(s.measure(s.against, {{"rms", rms}, {"largest", largest}}));
    checks.push_back(between("rms difference to the file [kg]", rms, 0, 0.01));
    checks.push_back(between("largest difference to the file [kg]", largest, 0, 0.02));
}

/// A pair of figures: the heaviest stack that stands, and the same with 0.01 kg more on top      Fig. 4.19
/// b-g
struct Pictured {
    double eta_r;
    std::string stable, collapsing;  ///< letters of the figures
};
const std::vector<Pictured> pictured = {{0.16, "b", "c"}, {0.23, "d", "e"}, {0.35, "f", "g"}};
constexpr double pictured_gap = 0.3, added_mass = 0.01;  // over R; [kg]

void add_snapshots(StudyContext& s, const std::vector<StackCell>& cells, double h, double end)
{
    std::vector<run::SnapshotTables> tables;
    for (size_t k = 0; k < pictured.size(); ++k) {
        if (!cells[k].found) continue;
        Stack stack = cells[k].stack;
        stack.top -= 1 / kilogram;
        for (const bool heavier : {false, true}) {
            const std::string& letter = heavier ? pictured[k].collapsing : pictured[k].stable;
            if (heavier) stack.top += added_mass;
            const StackSnapshots of = stack_snapshots(stack, letter, h, heavier ? end : cells[k].below.t);
            s.json["snapshots"].push_back({{"run", letter},
                                           {"gap", stack.gap},
                                           {"eta_r", stack.eta_r},
                                           {"top_mass", stack.top},
                                           {"t", of.t},
                                           {"collapses", of.collapses},
                                           {"roll_saturates", of.roll_saturates},
                                           {"slide_saturates", of.slide_saturates}});
            tables.push_back(of.tables);
        }
    }
    s.files = run::snapshot_files("", tables);
    if (!tables.empty()) s.figures.emplace_back("stacking-snapshots.png");
}

void stacking(StudyContext& s)
{
    const GridOptions o = grid_options(s, 1e-4, 10, stack_grids);
    std::vector<StackCell> cells;
    std::vector<std::pair<double, double>> places;  // η_r, gap
    for (const double gap : o.grid.gaps)
        for (const double eta : o.grid.etas) {
            cells.push_back({.stack = {.gap = gap, .eta_r = eta, .dissertation = o.dissertation()}});
            places.emplace_back(eta, gap);
        }
    const std::string& file = s.against;
    if (!file.empty()) {
        const PublishedGrid published{file, "eta_r", [](double gap) { return "m_c_gap_" + gap_text(gap); },
                                      "column eta_r must contain values of the grid"};
        const std::vector<double> masses = published.values(places);
        for (size_t k = 0; k < cells.size(); ++k) cells[k].published = masses[k];
    }
    const StackCell& coarse = refined_cell_of(cells, o.grid);
    StackCell refined{.stack = coarse.stack};
    std::vector<StackCell> of_figures;
    for (const Pictured& p : pictured)
        of_figures.push_back(
            {.stack = {.gap = pictured_gap, .eta_r = p.eta_r, .dissertation = o.dissertation()}});
    const long grid_cells = static_cast<long>(cells.size()),
               figure_cells = static_cast<long>(of_figures.size());
    const auto cell = [&](long k) -> StackCell& {
        if (k < grid_cells) return cells[k];
        return k < grid_cells + figure_cells ? of_figures[k - grid_cells] : refined;
    };
    s.pool(cells.size() + of_figures.size() + s.check)
        .run([&](long k) { bisect(cell(k), &cell(k) == &refined ? o.h / refinement : o.h, o.end); },
             [&](io::Archive& a, long k) { cell(k).transfer(a); });

    const std::vector<MassCurve> curves = curves_of(cells, o.grid);
    s.text << fmt::format(
        "\ncritical mass [kg] of the upper sphere and collapse mode of the lower spheres; "
        "{} friction, h = {:g} s\n",
        o.preset, o.h);
    print(curves, s.text);
    int undecided = 0;
    for (const StackCell& c : cells) undecided += c.undecided;
    s.json["undecided"] = undecided;
    s.text << '\n';
    for (const MassCurve& c : curves) {
        s.text << fmt::format(
            "gap {0}: maximum {2:.3f} kg at eta_r = {1:.2f}; {4:.3f} kg at eta_r = {3:.2f}\n", c.gap,
            c.peak_eta, c.peak_mass, o.grid.etas.back(), c.plateau);
        s.measure("gap " + c.gap, {{"peak_eta_" + c.gap, c.peak_eta},
                                   {"peak_mass_" + c.gap, c.peak_mass},
                                   {"plateau_" + c.gap, c.plateau}});
        s.json["curves"].push_back({{"gap", c.cells.front()->stack.gap},
                                    {"peak_eta", c.peak_eta},
                                    {"peak_mass", c.peak_mass},
                                    {"plateau", c.plateau}});
    }
    if (undecided > 0)
        s.text << fmt::format("{} undecided after {:g} s; {} as stable\n",
                              io::counted(undecided, "run was", "runs were"), o.end,
                              undecided == 1 ? "it counts" : "they count");
    s.measure(s.name, {{"undecided", undecided}});
    std::vector<Criterion> checks;
    if (s.check) checks = criteria(curves, coarse, refined, o.h);
    if (!file.empty()) compare(s, cells, checks);
    if (s.check) s.evaluate(checks);
    s.table = columns_of_cells.csv(cells);
    s.figures = {"stacking.png"};
    add_snapshots(s, of_figures, o.h, o.end);
}

const bool registered_stacking = io::Registry<Study>::add(
    {.name = "stacking",
     .answers =
         "critical mass of a stack of three spheres over rolling resistance (Fig. 4.19); default preset: "
         "dissertation",
     .options = {"--steps", "--end", "--preset", "--against", "--grid", "--check", "--shard"},
     .keys = keys(),
     .files = {"poses.csv", "contacts.csv", "shapes.json", "stacking.png", "stacking-snapshots.png"},
     .run = stacking});

}  // namespace

}  // namespace hilda::studies
