// SPDX-License-Identifier: GPL-3.0-or-later
/// Final state of a sphere pushed up an incline, over slope and rolling resistance (Fang 2022, Fig. 4.13).
///
/// Each cell of the grid is a run of 1 s. Its state follows from the modes of sliding and rolling friction at
/// the end (Table 4.4): 0 rest, 1 rolling, 2 rolling with slip, 3 slip without rolling. The boundaries
/// between the states are compared with the Coulomb bounds (Sec. A.7; rest limit with μ_k, see incline.hpp).
/// The default preset is `dissertation`, which reproduces the published figure. --check evaluates the
/// differences and returns exit code 6 if a criterion fails.

#include "studies/experiments/chapter4/incline.hpp"
#include "studies/framework/csv_table.hpp"
#include "studies/framework/study_context.hpp"
#include "studies/framework/table.hpp"

#include "lie/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <numbers>

namespace hilda::studies {

namespace {

constexpr double degree = std::numbers::pi / 180;
const std::array<const char*, 4> state_names = {"rest", "rolling", "rolling with slip", "slip"};

/// Values k / parts for k = from, from + by, ..., to
struct IntegerRange {
    int from, to, by, parts;

    std::vector<double> values() const
    {
        std::vector<double> all;
        for (int k = from; k <= to; k += by) all.push_back(static_cast<double>(k) / parts);
        return all;
    }
};

struct InclineGrid {
    std::string name;
    IntegerRange eta, angle;  ///< [1, degrees]
};

/// Grids of --grid; the first is the default. `published` is the grid of the published states, `dissertation`
/// the smaller one described in the text.
const std::vector<InclineGrid> grids = {{"published", {40, 120, 1, 200}, {10, 300, 1, 10}},
                                        {"dissertation", {20, 50, 1, 100}, {10, 300, 1, 10}},
                                        {"coarse", {20, 60, 5, 100}, {1, 30, 1, 1}}};

struct InclineCell {
    int state = -1;
    /// Velocity of the centre and R times the angular velocity at the end, positive up the slope [m/s]
    double v = 0, R_omega = 0;
};

/// States over η_r (rows) and slope (columns)
struct StateMap {
    std::vector<double> eta, angle;
    std::vector<InclineCell> cells;

    InclineCell& at(size_t e, size_t a) { return cells[e * angle.size() + a]; }
    const InclineCell& at(size_t e, size_t a) const { return cells[e * angle.size() + a]; }
};

void run(InclineCell& cell, const Incline& incline, double h, long steps)
{
    contact::Scene run_scene = scene(incline);
    for (long n = 0; n < steps; ++n) run_scene.step(h);
    cell = {.state = static_cast<int>(state_of(run_scene)),
            .v = run_scene.body[0].rdot.x(),
            .R_omega = Incline::R * (run_scene.body[0].A * run_scene.body[0].omega_bar).y()};
}

/// Boundary in row e: the slope midway between the last cell in one of `wanted_states` and the next cell
/// [degrees]; NaN if there is no such cell or no cell after it
double last_slope(const StateMap& map, size_t e, std::initializer_list<int> wanted_states)
{
    double at = std::nan("");
    for (size_t a = 0; a + 1 < map.angle.size(); ++a)
        if (std::find(wanted_states.begin(), wanted_states.end(), map.at(e, a).state) !=
                wanted_states.end() &&
            std::find(wanted_states.begin(), wanted_states.end(), map.at(e, a + 1).state) ==
                wanted_states.end())
            at = 0.5 * (map.angle[a] + map.angle[a + 1]);
    return at;
}

/// Range over the rows of the difference between the boundary of the map and the limit [degrees]
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
    Deviation rest_by_torque;         ///< for η_r <= 1/2
    double slip_from = std::nan("");  ///< smallest η_r with slip without rolling
};

Boundaries boundaries(const StateMap& map)
{
    Boundaries b;
    for (size_t e = 0; e < map.eta.size(); ++e) {
        const double eta = map.eta[e];
        for (size_t a = 0; a < map.angle.size(); ++a)
            if (map.at(e, a).state == 3 && std::isnan(b.slip_from)) b.slip_from = eta;
        const double rest = last_slope(map, e, {0}) - rest_limit(eta) / degree;
        b.rest.add(rest);
        if (eta <= 0.5) b.rest_by_torque.add(rest);
        b.rolling.add(last_slope(map, e, {0, 1}) - rolling_limit(eta) / degree);
    }
    return b;
}

/// Acceptance criteria: the boundaries agree with the Coulomb bounds. The resolution of a boundary is half a
/// cell. With the preset `balanced` a sphere keeps slipping where it sticks with the preset `dissertation`.
/// Therefore the rolling limit does not apply to `balanced`, and its rest limit applies only up to η_r = 1/2;
/// above, the slip determines whether the sphere comes to rest.
std::vector<Criterion> criteria(const StateMap& map, const Boundaries& b, bool dissertation)
{
    const double cell = map.angle[1] - map.angle[0], row = map.eta[1] - map.eta[0], half = 0.5 * cell;
    const Deviation& rest = dissertation ? b.rest : b.rest_by_torque;
    const std::string range_text = dissertation ? "" : " up to eta_r = 1/2";
    std::vector<Criterion> all = {
        criterion("rest limit minus atan(2 eta_r mu_k)" + range_text + ", smallest [deg]", rest.least, 0,
                  0.15 + half),
        criterion("rest limit minus atan(2 eta_r mu_k)" + range_text + ", largest [deg]", rest.most, 0,
                  0.15 + half)};
    if (dissertation)
        for (const auto& [which, value] :
             {std::pair("smallest", b.rolling.least), std::pair("largest", b.rolling.most)})
            all.push_back(between(fmt::format("rolling limit minus Sec. A.7, {} [deg]", which), value,
                                  -0.8 - half, 0.05 + half));
    all.push_back(between("smallest eta_r with slip without rolling, first row above 1/2", b.slip_from,
                          0.5 + 0.1 * row, 0.5 + 1.1 * row));
    return all;
}

/// Published states on the cells of the map; -1 for a cell that the file does not have
std::vector<int> read_published(const StateMap& map, const std::string& file)
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
        throw lie::InvalidInput(
            file +
            ": has no cell of this grid; the header row must contain slopes in degrees and the "
            "first column eta_r");
    return states;
}

struct StateAgreement {
    long compared = 0, same = 0;
    /// Cells that differ, and no neighbour in the published map has the computed state
    long not_adjacent = 0;
    std::array<std::array<long, 4>, 4> count = {};  ///< [published state][computed state]

    double percent() const { return 100 * static_cast<double>(same) / static_cast<double>(compared); }
};

StateAgreement agreement(const StateMap& map, const std::vector<int>& published)
{
    const auto rows = static_cast<long>(map.eta.size()), columns = static_cast<long>(map.angle.size());
    const auto has_neighbour = [&](long e, long a, int state) {
        for (long k = std::max(0L, e - 1); k <= std::min(rows - 1, e + 1); ++k)
            for (long l = std::max(0L, a - 1); l <= std::min(columns - 1, a + 1); ++l)
                if (published[k * columns + l] == state) return true;
        return false;
    };
    StateAgreement result;
    for (long e = 0; e < rows; ++e)
        for (long a = 0; a < columns; ++a) {
            const int reference_state = published[e * columns + a], state = map.at(e, a).state;
            if (reference_state < 0 || reference_state > 3) continue;
            ++result.compared;
            ++result.count[reference_state][state];
            result.same += reference_state == state;
            result.not_adjacent += reference_state != state && !has_neighbour(e, a, state);
        }
    return result;
}

std::string as_csv(const StateMap& map, const std::vector<int>& published)
{
    Table table({{"eta_r"}, {"angle_deg"}, {"state"}, {"published"}, {"v"}, {"R_omega"}});
    for (size_t e = 0; e < map.eta.size(); ++e)
        for (size_t a = 0; a < map.angle.size(); ++a) {
            const InclineCell& cell = map.at(e, a);
            const int reference_state = published.empty() ? -1 : published[e * map.angle.size() + a];
            table.add({map.eta[e], map.angle[a], cell.state,
                       reference_state < 0 ? std::nan("") : static_cast<double>(reference_state), cell.v,
                       cell.R_omega});
        }
    return table.csv();
}

void print(const StateMap& map, std::ostream& out)
{
    Table table({{"eta_r", "{:.3f}"},
                 {"rest up to [deg]", "{:.2f}"},
                 {"rest limit [deg]", "{:.2f}"},
                 {"rolling up to [deg]", "{:.2f}"},
                 {"limit Sec. A.7 [deg]", "{:.2f}"}});
    const size_t stride = std::max<size_t>(1, (map.eta.size() - 1) / 8);
    for (size_t e = 0; e < map.eta.size(); e += stride) {
        const double eta = map.eta[e];
        table.add({eta, last_slope(map, e, {0}), rest_limit(eta) / degree, last_slope(map, e, {0, 1}),
                   rolling_limit(eta) / degree});
    }
    table.print(out);
    std::array<long, 4> count = {};
    for (const InclineCell& cell : map.cells) ++count[cell.state];
    out << fmt::format("\n{} runs:", map.cells.size());
    for (size_t s = 0; s < state_names.size(); ++s)
        out << fmt::format("{} {} {}", s == 0 ? "" : ",", count[s], state_names[s]);
    out << '\n';
}

void print(const StateAgreement& a, const std::string& file, std::ostream& out)
{
    out << fmt::format(
        "comparison with {}: {:.3f} % of {} cells agree; {} differ, {} of them more than one cell from a "
        "boundary\n",
        file, a.percent(), a.compared, a.compared - a.same, a.not_adjacent);
    for (size_t reference_state = 0; reference_state < 4; ++reference_state)
        for (size_t state = 0; state < 4; ++state)
            if (reference_state != state && a.count[reference_state][state] > 0)
                out << fmt::format("  published {}, computed {}: {}\n", state_names[reference_state],
                                   state_names[state], a.count[reference_state][state]);
}

void incline_sweep(StudyContext& s)
{
    s.refuse_models();
    const StudyOptions& options = s.options;
    const double h = s.one_step(1e-4), end = options.end.value_or(1);
    const std::string preset = options.preset.empty() ? "dissertation" : options.preset;
    const InclineGrid& g = one_of_list("--grid", options.grid, grids);
    StateMap map{.eta = g.eta.values(), .angle = g.angle.values(), .cells = {}};
    map.cells.resize(map.eta.size() * map.angle.size());
    const auto incline = [&](size_t e, size_t a) {
        return Incline{
            .alpha = map.angle[a] * degree, .eta_r = map.eta[e], .dissertation = preset == "dissertation"};
    };
    scene(incline(map.eta.size() - 1, 0)).check(h);  // the largest rolling stiffness of the sweep
    const std::vector<int> published =
        options.against.empty() ? std::vector<int>() : read_published(map, options.against);
    const long steps = std::max(1L, std::lround(end / h));
    s.pool(map.cells.size()).run([&](long k) {
        run(map.cells[k], incline(k / map.angle.size(), k % map.angle.size()), h, steps);
    });

    const Boundaries b = boundaries(map);
    s.table = as_csv(map, published);
    s.figures = {"incline-sweep.png"};
    s.text << fmt::format(
        "\nfinal state of a sphere pushed up an incline at 0.5 m/s, after {:g} s; {} friction, h = {:g} s\n",
        end, preset, h);
    print(map, s.text);
    s.text << fmt::format(
        "boundary minus limit: rest {:+.2f} to {:+.2f} deg, rolling {:+.2f} to {:+.2f} deg; slip without "
        "rolling "
        "{}\n",
        b.rest.least, b.rest.most, b.rolling.least, b.rolling.most,
        std::isfinite(b.slip_from) ? fmt::format("from eta_r = {:.3f}", b.slip_from) : "does not occur");
    s.json = {{"preset", preset},
              {"h", h},
              {"end", end},
              {"grid", g.name},
              {"states", std::vector<std::string>(state_names.begin(), state_names.end())},
              {"rest_limit", {{"least", b.rest.least}, {"most", b.rest.most}}},
              {"rolling_limit", {{"least", b.rolling.least}, {"most", b.rolling.most}}},
              {"slip_from", b.slip_from}};
    s.measured = {{.of = s.name,
                   .value = {{"rest_limit", b.rest.largest()},
                             {"rolling_limit_least", b.rolling.least},
                             {"rolling_limit_most", b.rolling.most},
                             {"slip_from", b.slip_from}}}};
    std::vector<Criterion> checks = criteria(map, b, preset == "dissertation");
    if (!published.empty()) {
        const StateAgreement a = agreement(map, published);
        checks.push_back(between("agreement with the file [%]", a.percent(), 99.7, 100));
        print(a, options.against, s.text);
        s.measured.push_back(
            {.of = options.against,
             .value = {{"agreement", a.percent()}, {"far", static_cast<double>(a.not_adjacent)}}});
        s.json["against"] = {{"file", options.against},
                             {"compared", a.compared},
                             {"agreement", a.percent()},
                             {"far", a.not_adjacent}};
    }
    if (options.check) s.evaluate(checks);
}

const bool registered = io::Registry<Study>::add(
    {.name = "incline-sweep",
     .answers = "final state of a sphere pushed up an incline, over slope and rolling resistance (Fig. "
                "4.13); default "
                "preset: dissertation",
     .accepted = takes::preset | takes::against | takes::grid | takes::check,
     .keys = {"agreement", "far", "rest_limit", "rolling_limit_least", "rolling_limit_most", "slip_from"},
     .run = incline_sweep});

}  // namespace

}  // namespace hilda::studies
