// SPDX-License-Identifier: GPL-3.0-or-later
/// What a sphere that is pushed up an incline does in the end, over slope and rolling resistance (Fang 2022, Fig. 4.13).
///
/// Each cell is a run of 1 s. Its state is read from the modes of sliding and rolling friction at the end (Table
/// 4.4): 0 rest, 1 rolling, 2 rolling with slip, 3 slip without rolling. The boundaries are compared with those of the
/// Coulomb bounds alone (A.7; the rest limit with μ_k, see incline.hpp). --check demands that they agree, and exits with 6
/// where they do not.

#include "studies/exit_codes.hpp"
#include "studies/experiments/chapter4/incline.hpp"
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
#include <charconv>
#include <numbers>

namespace hilda::studies {

namespace {

using nlohmann::ordered_json;

const std::string kind = "incline-sweep";
constexpr double degree = std::numbers::pi / 180;
const std::array<const char*, 4> names = {"rest", "rolling", "rolling with slip", "slip"};

/// From, to and between, of whole numbers that are divided by `parts`
struct Range {
    int from, to, by, parts;

    std::vector<double> values() const
    {
        std::vector<double> all;
        for (int k = from; k <= to; k += by) all.push_back(static_cast<double>(k) / parts);
        return all;
    }
};

struct ParameterGrid {
    std::string name;
    Range eta, angle;  ///< [1, degrees]
};

/// The default first: the published states. The text of the dissertation has fewer.
const std::vector<ParameterGrid> grids = {{"published", {40, 120, 1, 200}, {10, 300, 1, 10}},
                                          {"dissertation", {20, 50, 1, 100}, {10, 300, 1, 10}},
                                          {"coarse", {20, 60, 5, 100}, {1, 30, 1, 1}}};

const ParameterGrid& grid(const StudyOptions& options)
{
    std::vector<std::string> known;
    for (const ParameterGrid& g : grids) known.push_back(g.name);
    const std::string name = options.grid.empty() ? known.front() : one_of("--grid", options.grid, known);
    return grids[std::find(known.begin(), known.end(), name) - known.begin()];
}

struct Cell {
    int state = -1;
    double v = 0, R_omega = 0;  ///< at the end, up the slope [m/s]
};

/// States over η_r (rows) and slope
struct Map {
    std::vector<double> eta, angle;
    std::vector<Cell> cells;

    Cell& at(size_t e, size_t a) { return cells[e * angle.size() + a]; }
    const Cell& at(size_t e, size_t a) const { return cells[e * angle.size() + a]; }
};

void run(Cell& cell, const Incline& incline, double h, long steps)
{
    contact::Scene of = scene(incline);
    for (long n = 0; n < steps; ++n) of.step(h);
    cell = {.state = static_cast<int>(motions(of)),
            .v = of.body[0].rdot.x(),
            .R_omega = Incline::R * (of.body[0].A * of.body[0].omega_bar).y()};
}

/// The slope halfway between the last cell of a row in one of `these` states and the cell after it [degrees]; NaN
/// where there is none, or none after it
double last_of(const Map& map, size_t e, std::initializer_list<int> these)
{
    double at = std::nan("");
    for (size_t a = 0; a + 1 < map.angle.size(); ++a)
        if (std::find(these.begin(), these.end(), map.at(e, a).state) != these.end() &&
            std::find(these.begin(), these.end(), map.at(e, a + 1).state) == these.end())
            at = 0.5 * (map.angle[a] + map.angle[a + 1]);
    return at;
}

/// Boundary of the map less the limit, over the rows [degrees]
struct Deviation {
    double least = std::nan(""), most = std::nan("");

    void add(double difference)
    {
        if (std::isnan(difference)) return;
        least = std::isnan(least) ? difference : std::min(least, difference);
        most = std::isnan(most) ? difference : std::max(most, difference);
    }
    double largest() const { return std::max(std::abs(least), std::abs(most)); }
};

struct Boundaries {
    Deviation rest, rolling;
    Deviation rest_by_torque;         ///< up to η_r = 1/2
    double slip_from = std::nan("");  ///< the smallest η_r with slip without rolling
};

Boundaries boundaries(const Map& map)
{
    Boundaries b;
    for (size_t e = 0; e < map.eta.size(); ++e) {
        const double eta = map.eta[e];
        for (size_t a = 0; a < map.angle.size(); ++a)
            if (map.at(e, a).state == 3 && std::isnan(b.slip_from)) b.slip_from = eta;
        const double rest = last_of(map, e, {0}) - rest_limit(eta) / degree;
        b.rest.add(rest);
        if (eta <= 0.5) b.rest_by_torque.add(rest);
        b.rolling.add(last_of(map, e, {0, 1}) - rolling_limit(eta) / degree);
    }
    return b;
}

/// What the map must show, by the bounds that Coulomb's law sets. A boundary is known to half a cell. Balanced friction
/// leaves a sphere slipping where the dissertation's has it stick: it has no rolling limit of its own, and beyond
/// η_r = 1/2 a sphere that slips decides on rest.
std::vector<Criterion> criteria(const Map& map, const Boundaries& b, bool dissertation)
{
    const double cell = map.angle[1] - map.angle[0], row = map.eta[1] - map.eta[0], half = 0.5 * cell;
    const Deviation& rest = dissertation ? b.rest : b.rest_by_torque;
    const std::string up_to = dissertation ? "" : " up to eta_r = 1/2";
    std::vector<Criterion> all = {
        criterion("rest limit less atan(2 eta_r mu_k)" + up_to + ", least [deg]", rest.least, 0, 0.15 + half),
        criterion("rest limit less atan(2 eta_r mu_k)" + up_to + ", most [deg]", rest.most, 0, 0.15 + half)};
    if (dissertation)
        for (const auto& [which, value] :
             {std::pair("least", b.rolling.least), std::pair("most", b.rolling.most)})
            all.push_back(between(fmt::format("rolling limit less A.7, {} [deg]", which), value, -0.8 - half,
                                  0.05 + half));
    all.push_back(between("slip without rolling from eta_r, the first above 1/2", b.slip_from,
                          0.5 + 0.1 * row, 0.5 + 1.1 * row));
    return all;
}

/// The published map on the same grid; -1 where it has no such cell
std::vector<int> read_published(const Map& map, const std::string& file)
{
    const CsvTable table = read_csv_table(file);
    std::vector<int> states(map.cells.size(), -1);
    const auto near = [](double a, double b) { return std::abs(a - b) < 1e-9; };
    std::vector<double> slopes;
    for (const std::string& name : table.columns) {
        double slope = std::nan("");
        std::from_chars(name.data(), name.data() + name.size(), slope);
        slopes.push_back(slope);
    }
    for (const std::vector<double>& row : table.rows)
        for (size_t e = 0; e < map.eta.size(); ++e) {
            if (!near(row[0], map.eta[e])) continue;
            for (size_t c = 1; c < slopes.size(); ++c)
                for (size_t a = 0; a < map.angle.size(); ++a)
                    if (near(slopes[c], map.angle[a]) && !std::isnan(row[c]))
                        states[e * map.angle.size() + a] = static_cast<int>(std::lround(row[c]));
        }
    if (std::all_of(states.begin(), states.end(), [](int s) { return s < 0; }))
        throw lie::InvalidInput(file +
                                ": has no cell of this grid: the first row must name slopes in degrees, the "
                                "first column eta_r");
    return states;
}

struct Agreement {
    long compared = 0, same = 0;
    long far = 0;  ///< differ, and no neighbour in the published map has our state
    std::array<std::array<long, 4>, 4> count = {};  ///< published, ours

    double percent() const { return 100 * static_cast<double>(same) / static_cast<double>(compared); }
};

Agreement agreement(const Map& map, const std::vector<int>& published)
{
    const auto rows = static_cast<long>(map.eta.size()), columns = static_cast<long>(map.angle.size());
    const auto beside = [&](long e, long a, int state) {
        for (long k = std::max(0L, e - 1); k <= std::min(rows - 1, e + 1); ++k)
            for (long l = std::max(0L, a - 1); l <= std::min(columns - 1, a + 1); ++l)
                if (published[k * columns + l] == state) return true;
        return false;
    };
    Agreement found;
    for (long e = 0; e < rows; ++e)
        for (long a = 0; a < columns; ++a) {
            const int theirs = published[e * columns + a], ours = map.at(e, a).state;
            if (theirs < 0 || theirs > 3) continue;
            ++found.compared;
            ++found.count[theirs][ours];
            found.same += theirs == ours;
            found.far += theirs != ours && !beside(e, a, ours);
        }
    return found;
}

std::string as_csv(const Map& map, const std::vector<int>& published)
{
    Table table({{"eta_r"}, {"angle_deg"}, {"state"}, {"published"}, {"v"}, {"R_omega"}});
    for (size_t e = 0; e < map.eta.size(); ++e)
        for (size_t a = 0; a < map.angle.size(); ++a) {
            const Cell& cell = map.at(e, a);
            const int theirs = published.empty() ? -1 : published[e * map.angle.size() + a];
            table.add({map.eta[e], map.angle[a], static_cast<double>(cell.state),
                       theirs < 0 ? std::nan("") : static_cast<double>(theirs), cell.v, cell.R_omega});
        }
    return table.csv();
}

void print(const Map& map, std::ostream& out)
{
    Table table({{"eta_r", "{:.3f}"},
                 {"at rest up to [deg]", "{:.2f}"},
                 {"limit", "{:.2f}"},
                 {"rolling up to [deg]", "{:.2f}"},
                 {"limit A.7", "{:.2f}"}});
    const size_t every = std::max<size_t>(1, (map.eta.size() - 1) / 8);
    for (size_t e = 0; e < map.eta.size(); e += every) {
        const double eta = map.eta[e];
        table.add({eta, last_of(map, e, {0}), rest_limit(eta) / degree, last_of(map, e, {0, 1}),
                   rolling_limit(eta) / degree});
    }
    table.print(out);
    std::array<long, 4> count = {};
    for (const Cell& cell : map.cells) ++count[cell.state];
    out << fmt::format("\n{} runs:", map.cells.size());
    for (size_t s = 0; s < names.size(); ++s)
        out << fmt::format("{} {} {}", s == 0 ? "" : ",", count[s], names[s]);
    out << '\n';
}

void print(const Agreement& a, const std::string& file, std::ostream& out)
{
    out << fmt::format(
        "against {}: {:.3f} % of {} cells; {} differ, {} of them further than a cell from a boundary\n", file,
        a.percent(), a.compared, a.compared - a.same, a.far);
    for (size_t theirs = 0; theirs < 4; ++theirs)
        for (size_t ours = 0; ours < 4; ++ours)
            if (theirs != ours && a.count[theirs][ours] > 0)
                out << fmt::format("  {} there, {} here: {}\n", names[theirs], names[ours],
                                   a.count[theirs][ours]);
}

int incline_sweep(const StudyOptions& options)
{
    check_keys(kind, options,
               std::vector<std::string>{"agreement", "far", "rest_limit", "rolling_limit_least",
                                        "rolling_limit_most", "slip_from"});
    refuse_models(kind, options);
    const double h = one_step(kind, options, 1e-4), end = options.end.value_or(1);
    const std::string preset = options.preset.empty() ? "dissertation" : options.preset;
    const ParameterGrid& g = grid(options);
    Map map{.eta = g.eta.values(), .angle = g.angle.values(), .cells = {}};
    map.cells.resize(map.eta.size() * map.angle.size());
    const auto incline = [&](size_t e, size_t a) {
        return Incline{
            .alpha = map.angle[a] * degree, .eta_r = map.eta[e], .dissertation = preset == "dissertation"};
    };
    scene(incline(map.eta.size() - 1, 0)).check(h);  // rolling is stiffest there
    const std::vector<int> published =
        options.against.empty() ? std::vector<int>() : read_published(map, options.against);
    const long steps = std::max(1L, std::lround(end / h));
    Pool(options.jobs, options.quiet ? "" : kind, static_cast<long>(map.cells.size())).run([&](long k) {
        run(map.cells[k], incline(k / map.angle.size(), k % map.angle.size()), h, steps);
    });

    const Boundaries b = boundaries(map);
    StudyOutput output{.kind = kind, .table = as_csv(map, published), .figures = {"incline-sweep.png"}};
    output.text << fmt::format(
        "\nfinal state of a sphere pushed up an incline at 0.5 m/s, after {:g} s; {} friction, h = {:g} s\n",
        end, preset, h);
    print(map, output.text);
    output.text << fmt::format(
        "less the limit: rest {:+.2f} to {:+.2f} deg, rolling {:+.2f} to {:+.2f} deg; slip without rolling "
        "{}\n",
        b.rest.least, b.rest.most, b.rolling.least, b.rolling.most,
        std::isfinite(b.slip_from) ? fmt::format("from eta_r = {:.3f}", b.slip_from) : "nowhere");
    output.json = {
        {"preset", preset},
        {"h", h},
        {"end", end},
        {"grid", g.name},
        {"states", names},
        {"rest_limit", {{"least", number_or_null(b.rest.least)}, {"most", number_or_null(b.rest.most)}}},
        {"rolling_limit",
         {{"least", number_or_null(b.rolling.least)}, {"most", number_or_null(b.rolling.most)}}},
        {"slip_from", number_or_null(b.slip_from)}};
    std::vector<Measured> came = {{.of = kind,
                                   .value = {{"rest_limit", b.rest.largest()},
                                             {"rolling_limit_least", b.rolling.least},
                                             {"rolling_limit_most", b.rolling.most},
                                             {"slip_from", b.slip_from}}}};
    std::vector<Criterion> must;
    if (options.check) must = criteria(map, b, preset == "dissertation");
    if (!published.empty()) {
        const Agreement a = agreement(map, published);
        must.push_back(between("agreement with the file [%]", a.percent(), 99.7, 100));
        print(a, options.against, output.text);
        came.push_back({.of = options.against,
                        .value = {{"agreement", a.percent()}, {"far", static_cast<double>(a.far)}}});
        output.json["against"] = {
            {"file", options.against}, {"compared", a.compared}, {"agreement", a.percent()}, {"far", a.far}};
    }
    const bool passed = !options.check || evaluate(must, output.text, output.json);
    const int code = finish(options, output, {}, came);
    return code == exit_code::done && !passed ? exit_code::expectation_failed : code;
}

const bool registered = register_study(
    Study{.kind = kind,
          .answers = "final state of a sphere on an incline over slope and rolling resistance (Fig. 4.13)",
          .also = takes::preset | takes::against | takes::grid | takes::check,
          .run = incline_sweep});

}  // namespace

}  // namespace hilda::studies
