// SPDX-License-Identifier: GPL-3.0-or-later
/// The mass that brings a stack of three spheres down, over the rolling resistance (Fang 2022, Fig. 4.19a).
///
/// For each gap between the lower spheres and each η_r: the smallest mass of the upper sphere, in steps of a
/// gram, with which the stack collapses, by bisection between a quarter of a kilogram and four. What gives way is what
/// the lower spheres do on the ground when that mass comes down (Figs. 4.19c, e, g). --check sets what comes out beside
/// what must, with one cell at a fifth of the step, and exits with 6 where a demand is not met.

#include "studies/exit_codes.hpp"
#include "studies/experiments/chapter4/stack.hpp"
#include "studies/framework/acceptance.hpp"
#include "studies/framework/csv_table.hpp"
#include "studies/framework/pool.hpp"
#include "studies/framework/selection.hpp"
#include "studies/framework/study_output.hpp"
#include "studies/program/arguments.hpp"

#include "lie/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace hilda::studies {

namespace {

using nlohmann::ordered_json;

const std::string kind = "stacking";
constexpr double kilogram = 1000;               // [g]
constexpr int finer_by = 5;                     // the step of the cell that --check runs again
constexpr int lightest = 250, heaviest = 4000;  // a lighter sphere is unstable on dashpots of the mean mass

struct ParameterGrid {
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

/// The default first
const std::vector<ParameterGrid> grids = {{"dissertation", {0.20, 0.25, 0.30, 0.35, 0.40}, etas()},
                                          {"coarse", {0.20, 0.40}, {0.15, 0.21, 0.24, 0.60}}};

const ParameterGrid& grid(const StudyOptions& options)
{
    std::vector<std::string> names;
    for (const ParameterGrid& g : grids) names.push_back(g.name);
    const std::string name = options.grid.empty() ? names.front() : one_of("--grid", options.grid, names);
    return grids[std::find(names.begin(), names.end(), name) - names.begin()];
}

struct Cell {
    Stack stack;         ///< with the critical mass
    Fate light, heavy;   ///< of a gram less, and of the critical mass
    bool found = false;  ///< the critical mass lies between the lightest and the heaviest
    double published = std::nan("");
    int runs = 0, undecided = 0;

    double m_c() const { return found ? stack.top : std::nan(""); }
};

std::string in_gaps(double gap) { return fmt::format("{:.2f}R", gap); }

void bisect(Cell& cell, double h, double end)
{
    const auto with = [&](int grams) {
        cell.stack.top = grams / kilogram;
        contact::Scene of = scene(cell.stack);
        if (cell.runs == 0) of.check(h);
        const Fate f = fate(of, h, end);
        ++cell.runs;
        cell.undecided += f.is == Fate::undecided;
        return f;
    };
    int lower = lightest, upper = heaviest;
    cell.light = with(lower), cell.heavy = with(upper);
    if (cell.light.is == Fate::collapses || cell.heavy.is != Fate::collapses) return;
    while (upper - lower > 1) {
        const int middle = (lower + upper) / 2;
        const Fate f = with(middle);
        if (f.is == Fate::collapses)
            upper = middle, cell.heavy = f;
        else
            lower = middle, cell.light = f;
    }
    cell.stack.top = upper / kilogram;
    cell.found = true;
}

std::string is_regularised(const Cell& cell)
{
    const Fate& f = cell.heavy;
    return !cell.found           ? "-"
           : f.rolls && f.slides ? "both"
           : f.rolls             ? "rolling"
           : f.slides            ? "sliding"
                                 : "-";
}

/// Of the masses that FILE has too
struct Agreement {
    long compared = 0;
    double rms = 0, largest = 0;  ///< [kg]
};

Agreement agreement(const std::vector<Cell>& cells)
{
    Agreement a;
    for (const Cell& cell : cells) {
        const double difference = cell.m_c() - cell.published;
        if (std::isnan(difference)) continue;
        ++a.compared;
        a.rms += difference * difference;
        a.largest = std::max(a.largest, std::abs(difference));
    }
    a.rms = std::sqrt(a.rms / static_cast<double>(a.compared));
    return a;
}

/// The masses of a table with columns eta_r, m_c_gap_0.20R, ... into their cells
void read_published(std::vector<Cell>& cells, const std::string& file)
{
    const CsvTable table = read_csv_table(file);
    const std::vector<double> eta = table.values("eta_r");
    bool any = false;
    for (Cell& cell : cells) {
        const size_t column = table.column("m_c_gap_" + in_gaps(cell.stack.gap));
        for (size_t k = 0; k < eta.size(); ++k)
            if (std::abs(eta[k] - cell.stack.eta_r) < 1e-9)
                cell.published = table.rows[k][column], any = true;
    }
    if (!any) throw lie::InvalidInput(file + ": has no eta_r of this grid");
}

/// Of the curve of one gap
struct Curve {
    double peak_eta = std::nan(""), peak_mass = 0, plateau = std::nan("");  ///< plateau: of the largest η_r
};

Curve curve(const std::vector<Cell>& cells, double gap)
{
    Curve c;
    for (const Cell& cell : cells) {
        if (cell.stack.gap != gap) continue;
        if (cell.m_c() > c.peak_mass) c.peak_eta = cell.stack.eta_r, c.peak_mass = cell.m_c();
        c.plateau = cell.m_c();
    }
    return c;
}

Table as_table(const std::vector<Cell>& cells)
{
    Table table({{"gap"},
                 {"eta_r"},
                 {"critical_mass"},
                 {"gives_way"},
                 {"published"},
                 {"difference"},
                 {"t_stands"},
                 {"t_collapses"},
                 {"runs"},
                 {"undecided"}});
    for (const Cell& c : cells)
        table.add({c.stack.gap, c.stack.eta_r, c.m_c(), is_regularised(c), c.published, c.m_c() - c.published,
                   c.light.t, c.heavy.t, static_cast<double>(c.runs), static_cast<double>(c.undecided)});
    return table;
}

void print(const std::vector<Cell>& cells, const ParameterGrid& g, std::ostream& out)
{
    std::vector<Table::Column> columns = {{"eta_r", "{:.2f}"}};
    for (const double gap : g.gaps)
        columns.push_back({"gap " + in_gaps(gap), "{:.3f}"}), columns.push_back({"by"});
    Table table(columns);
    for (size_t e = 0; e < g.etas.size(); ++e) {
        std::vector<Table::Cell> row = {g.etas[e]};
        for (size_t k = 0; k < g.gaps.size(); ++k) {
            const Cell& cell = cells[k * g.etas.size() + e];
            row.emplace_back(cell.m_c());
            row.emplace_back(is_regularised(cell));
        }
        table.add(row);
    }
    table.print(out);
}

/// What a curve must show with either preset: peaks where the published ones are, and the masses that came out when the
/// published ones were reproduced
struct Known {
    double gap, peak_eta, plateau;
};
constexpr std::array<Known, 5> known = {{{0.20, 0.21, 1.840},
                                         {0.25, 0.22, 1.701},
                                         {0.30, 0.23, 1.579},
                                         {0.35, 0.23, 1.471},
                                         {0.40, 0.24, 1.374}}};
constexpr double same_mass = 0.005;  // [kg]: what the step and the preset change

const Known& known_of(double gap)
{
    return *std::find_if(known.begin(), known.end(), [&](const Known& k) { return k.gap == gap; });
}

/// The cell that is run with a fifth of the step too: at the peak of the middle gap, where rolling goes over into sliding
const Cell& tried_finer(const std::vector<Cell>& cells, const ParameterGrid& g)
{
    const Known& k = known_of(g.gaps[g.gaps.size() / 2]);
    return *std::find_if(cells.begin(), cells.end(),
                         [&](const Cell& c) { return c.stack.gap == k.gap && c.stack.eta_r == k.peak_eta; });
}

std::vector<Criterion> criteria(const std::vector<Cell>& cells, const ParameterGrid& g, const Cell& finer,
                                double h)
{
    std::vector<Criterion> all;
    for (const double gap : g.gaps) {
        const Known& must = known_of(gap);
        const Curve c = curve(cells, gap);
        all.push_back(
            criterion("eta_r of the largest mass, gap " + in_gaps(gap), c.peak_eta, must.peak_eta, 1e-9));
        all.push_back(
            criterion(fmt::format("mass at eta_r = {:.2f}, gap {} [kg]", g.etas.back(), in_gaps(gap)),
                      c.plateau, must.plateau, same_mass));
    }
    const Cell& coarse = tried_finer(cells, g);
    all.push_back(
        criterion(fmt::format("mass with h = {:g} s less that with h = {:g} s, gap {}, eta_r = {:.2f} [kg]",
                              h / finer_by, h, in_gaps(coarse.stack.gap), coarse.stack.eta_r),
                  finer.m_c() - coarse.m_c(), 0, same_mass));
    return all;
}

int stacking(const StudyOptions& options)
{
    std::vector<std::string> keys = {"rms", "largest", "undecided"};
    for (const double gap : grids.front().gaps)
        for (const char* what : {"peak_eta_", "peak_mass_", "plateau_"}) keys.push_back(what + in_gaps(gap));
    check_keys(kind, options, keys);
    refuse_models(kind, options);
    const double h = one_step(kind, options, 1e-4), end = options.end.value_or(10);
    const std::string preset = options.preset.empty() ? "dissertation" : options.preset;
    const ParameterGrid& g = grid(options);
    std::vector<Cell> cells;
    for (const double gap : g.gaps)
        for (const double eta : g.etas) {
            cells.emplace_back();
            cells.back().stack = {.gap = gap, .eta_r = eta, .dissertation = preset == "dissertation"};
        }
    if (!options.against.empty()) read_published(cells, options.against);
    Cell finer;
    finer.stack = tried_finer(cells, g).stack;
    const auto jobs = static_cast<long>(cells.size());
    Pool(options.jobs, options.quiet ? "" : kind, jobs + options.check).run([&](long k) {
        if (k < jobs)
            bisect(cells[k], h, end);
        else
            bisect(finer, h / finer_by, end);
    });

    StudyOutput output{.kind = kind};
    std::vector<Measured> came;
    output.json = {{"preset", preset}, {"h", h}, {"end", end}, {"grid", g.name}};
    output.text << fmt::format(
        "\nsmallest mass [kg] of the upper sphere that brings the stack down, and by what of the lower "
        "ones;\n"
        "{} friction, h = {:g} s\n",
        preset, h);
    print(cells, g, output.text);
    std::vector<Criterion> must;
    if (options.check) must = criteria(cells, g, finer, h);
    int undecided = 0;
    for (const Cell& c : cells) undecided += c.undecided;
    ordered_json curves = ordered_json::array();
    output.text << '\n';
    for (const double gap : g.gaps) {
        const Curve c = curve(cells, gap);
        output.text << fmt::format(
            "gap {}: largest at eta_r = {:.2f}, {:.3f} kg; at eta_r = {:.2f}, {:.3f} kg\n", in_gaps(gap),
            c.peak_eta, c.peak_mass, g.etas.back(), c.plateau);
        came.push_back({.of = "gap " + in_gaps(gap),
                        .value = {{"peak_eta_" + in_gaps(gap), c.peak_eta},
                                  {"peak_mass_" + in_gaps(gap), c.peak_mass},
                                  {"plateau_" + in_gaps(gap), c.plateau}}});
        curves.push_back({{"gap", gap},
                          {"peak_eta", number_or_null(c.peak_eta)},
                          {"peak_mass", c.peak_mass},
                          {"plateau", number_or_null(c.plateau)}});
    }
    if (undecided > 0)
        output.text << fmt::format(
            "{} runs neither stood nor collapsed within {:g} s; they count as standing\n", undecided, end);
    came.push_back({.of = kind, .value = {{"undecided", undecided}}});
    output.json.update({{"undecided", undecided}, {"curves", curves}});
    if (!options.against.empty()) {
        const Agreement a = agreement(cells);
        output.text << fmt::format("against {}: {} masses, rms {:.4f} kg, largest difference {:.3f} kg\n",
                                   options.against, a.compared, a.rms, a.largest);
        came.push_back({.of = options.against, .value = {{"rms", a.rms}, {"largest", a.largest}}});
        output.json["against"] = {
            {"file", options.against}, {"compared", a.compared}, {"rms", a.rms}, {"largest", a.largest}};
        must.push_back(between("against the file, rms [kg]", a.rms, 0, 0.01));
        must.push_back(between("against the file, largest [kg]", a.largest, 0, 0.02));
    }
    const bool passed = !options.check || evaluate(must, output.text, output.json);
    output.table = as_table(cells).csv();
    output.figures = {"stacking.png"};
    const int code = finish(options, output, {}, came);
    return code == exit_code::done && !passed ? exit_code::expectation_failed : code;
}

const bool registered = register_study(
    Study{.kind = kind,
          .answers = "critical mass of three stacked spheres over rolling resistance (Fig. 4.19)",
          .also = takes::preset | takes::against | takes::grid | takes::check,
          .run = stacking});

}  // namespace

}  // namespace hilda::studies
