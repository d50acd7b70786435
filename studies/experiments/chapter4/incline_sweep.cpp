// SPDX-License-Identifier: GPL-3.0-or-later
/// Final state of a sphere pushed up an incline, over slope and rolling resistance (Fang 2022, Fig. 4.13).
///
/// Each cell of the grid is a run of 1 s. Its state follows from the modes of sliding and rolling friction at
/// the end (Table 4.4): 0 rest, 1 rolling, 2 rolling with slip, 3 slip without rolling. The boundaries
/// between the states are compared with the Coulomb bounds (Sec. A.7; rest limit with μ_k, see incline.hpp).
/// The default preset is `dissertation`, which reproduces the published figure. --check evaluates the
/// differences and returns exit code 6 if a criterion fails.

#include "io/message.hpp"
#include "studies/experiments/chapter4/incline.hpp"
#include "studies/framework/columns.hpp"
#include "studies/framework/published.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>

namespace hilda::studies {

namespace {

constexpr double degree = std::numbers::pi / 180;
const std::vector<std::string> state_names = {"rest", "rolling", "rolling with slip", "slip"};

/// Values k / parts for k = from, from + by, ..., to
std::vector<double> range(int from, int to, int by, int parts)
{
    std::vector<double> all;
    for (int k = from; k <= to; k += by) all.push_back(static_cast<double>(k) / parts);
    return all;
}

struct InclineGrid {
    std::string name;
    std::vector<double> eta, angle;  ///< [1, degrees]
};

/// Grids of --grid; the first is the default. `published` is the grid of the published states, `dissertation`
/// the smaller one described in the text.
const std::vector<InclineGrid> grids = {{"published", range(40, 120, 1, 200), range(10, 300, 1, 10)},
                                        {"dissertation", range(20, 50, 1, 100), range(10, 300, 1, 10)},
                                        {"coarse", range(20, 60, 5, 100), range(1, 30, 1, 1)}};

struct InclineCell {
    double eta = 0, angle = 0;  ///< [1, degrees]
    double published = std::nan("");
    int state = 0;
    /// Velocity of the centre and R times the angular velocity at the end, positive up the slope [m/s]
    double v = 0, R_omega = 0;

    void transfer(io::Archive& a) { a.value(state), a.value(v), a.value(R_omega); }
};

const Columns<InclineCell> incline_columns = {
    {"eta_r", &InclineCell::eta},   {"angle_deg", &InclineCell::angle},
    {"state", &InclineCell::state}, {"published", &InclineCell::published},
    {"v", &InclineCell::v},         {"R_omega", &InclineCell::R_omega}};

/// States over η_r (rows) and slope (columns)
struct StateMap {
    const InclineGrid& grid;
    std::vector<InclineCell> cells;

    const InclineCell& at(size_t e, size_t a) const { return cells[e * grid.angle.size() + a]; }
};

Incline incline_of(const InclineCell& cell, bool dissertation)
{
    return {.alpha = cell.angle * degree, .eta_r = cell.eta, .dissertation = dissertation};
}

void run(InclineCell& cell, bool dissertation, double h, long steps)
{
    contact::Scene run_scene = scene(incline_of(cell, dissertation));
    for (long n = 0; n < steps; ++n) run_scene.step(h);
    cell.state = static_cast<int>(state_of(run_scene));
    cell.v = run_scene.body[0].rdot.x();
    cell.R_omega = Incline::R * (run_scene.body[0].A * run_scene.body[0].omega_bar).y();
}

/// A row of the map: boundaries between states and their limits [degrees], and whether there is slip without
/// rolling
struct Boundaries {
    double eta, rest, rest_limit, rolling, rolling_limit;
    bool slips;
};

const Columns<Boundaries> columns_of_boundaries = {
    {"", "eta_r", "{:.3f}", &Boundaries::eta},
    {"", "rest up to [deg]", "{:.2f}", &Boundaries::rest},
    {"", "rest limit [deg]", "{:.2f}", &Boundaries::rest_limit},
    {"", "rolling up to [deg]", "{:.2f}", &Boundaries::rolling},
    {"", "limit Sec. A.7 [deg]", "{:.2f}", &Boundaries::rolling_limit}};

std::vector<Boundaries> boundaries(const StateMap& map)
{
    const std::vector<double>& angle = map.grid.angle;
    // The slope midway between the last cell with a state up to `most` and the next cell; NaN if there is no
    // such cell or no cell after it
    const auto boundary = [&](size_t e, int most) {
        double at = std::nan("");
        for (size_t a = 0; a + 1 < angle.size(); ++a)
            if (map.at(e, a).state >= 0 && map.at(e, a).state <= most && map.at(e, a + 1).state > most)
                at = 0.5 * (angle[a] + angle[a + 1]);
        return at;
    };
    std::vector<Boundaries> all;
    for (size_t e = 0; e < map.grid.eta.size(); ++e) {
        const double eta = map.grid.eta[e];
        Boundaries& b = all.emplace_back(Boundaries{eta, boundary(e, 0), rest_limit(eta) / degree,
                                                    boundary(e, 1), rolling_limit(eta) / degree, false});
        for (size_t a = 0; a < angle.size(); ++a) b.slips = b.slips || map.at(e, a).state == 3;
    }
    return all;
}

/// Range of values, without NaN
struct Range {
    double least = std::nan(""), most = std::nan("");

    void add(double value) { least = std::fmin(least, value), most = std::fmax(most, value); }
    double largest() const { return std::max(std::abs(least), std::abs(most)); }
    io::Json json() const { return {{"least", least}, {"most", most}}; }
};

/// Differences between the boundaries of the map and the limits [degrees]
struct Deviations {
    Range rest, rolling;
    Range rest_by_torque;             ///< for η_r <= 1/2
    double slip_from = std::nan("");  ///< smallest η_r with slip without rolling
    long slipping_rows = 0;           ///< number of rows with slip without rolling
};

Deviations deviations(const std::vector<Boundaries>& rows)
{
    Deviations d;
    for (const Boundaries& b : rows) {
        d.rest.add(b.rest - b.rest_limit);
        if (b.eta <= 0.5) d.rest_by_torque.add(b.rest - b.rest_limit);
        d.rolling.add(b.rolling - b.rolling_limit);
        if (b.slips) d.slip_from = std::fmin(d.slip_from, b.eta), ++d.slipping_rows;
    }
    return d;
}

/// Acceptance criteria: the boundaries agree with the Coulomb bounds. The resolution of a boundary is half a
/// cell. With the preset `balanced` a sphere keeps slipping where it sticks with the preset `dissertation`.
/// Therefore the rolling limit does not apply to `balanced`, and its rest limit applies only up to η_r = 1/2;
/// above, the slip determines whether the sphere comes to rest. A grid that ends at η_r = 1/2 has no slip
/// without rolling.
std::vector<Criterion> criteria(const InclineGrid& g, const Deviations& d, bool dissertation)
{
    const double half = 0.5 * (g.angle[1] - g.angle[0]), row = g.eta[1] - g.eta[0];
    const Range& rest = dissertation ? d.rest : d.rest_by_torque;
    const std::string rest_limit =
        std::string("rest limit minus atan(2 eta_r mu_k)") + (dissertation ? "" : " up to eta_r = 1/2");
    std::vector<Criterion> all = {criterion(rest_limit + ", smallest [deg]", rest.least, 0, 0.15 + half),
                                  criterion(rest_limit + ", largest [deg]", rest.most, 0, 0.15 + half)};
    if (dissertation)
        for (const auto& [which, value] :
             {std::pair("smallest", d.rolling.least), {"largest", d.rolling.most}})
            all.push_back(between(fmt::format("rolling limit minus Sec. A.7, {} [deg]", which), value,
                                  -0.8 - half, 0.05 + half));
    if (g.eta.back() > 0.5 + 1e-9)
        all.push_back(between("smallest eta_r with slip without rolling, first row above 1/2", d.slip_from,
                              0.5 + 0.1 * row, 0.5 + 1.1 * row));
    else
        all.push_back(between("rows with slip without rolling, of a grid up to eta_r = 1/2",
                              static_cast<double>(d.slipping_rows), 0, 0));
    return all;
}

/// Compares the states with the published ones.
Criterion compare(StudyContext& s, const StateMap& map)
{
    const auto rows = static_cast<long>(map.grid.eta.size()),
               incline_columns = static_cast<long>(map.grid.angle.size());
    const auto has_neighbour = [&](long e, long a, int state) {
        for (long k = std::max(0L, e - 1); k <= std::min(rows - 1, e + 1); ++k)
            for (long l = std::max(0L, a - 1); l <= std::min(incline_columns - 1, a + 1); ++l)
                if (map.at(k, l).published == state) return true;
        return false;
    };
    long compared = 0, same = 0;
    long far = 0;  // cells that differ, and no neighbour in the published map has the computed state
    std::array<std::array<long, 4>, 4> count = {};  // [published state][computed state]
    for (long e = 0; e < rows; ++e)
        for (long a = 0; a < incline_columns; ++a) {
            const InclineCell& cell = map.at(e, a);
            if (!(cell.published >= 0 && cell.published <= 3) || cell.state < 0) continue;
            ++compared;
            ++count[static_cast<size_t>(cell.published)][cell.state];
            same += cell.published == cell.state;
            far += cell.published != cell.state && !has_neighbour(e, a, cell.state);
        }
    const double percent = 100 * static_cast<double>(same) / static_cast<double>(compared);
    const std::string& file = s.against;
    s.text << fmt::format(
        "comparison with {}: {:.3f} % of {} cells agree; {} differ, {} of them more than one cell from a "
        "boundary\n",
        file, percent, compared, compared - same, far);
    for (size_t published = 0; published < 4; ++published)
        for (size_t state = 0; state < 4; ++state)
            if (published != state && count[published][state] > 0)
                s.text << fmt::format("  published {}, computed {}: {}\n", state_names[published],
                                      state_names[state], count[published][state]);
    s.measure(file, {{"agreement", percent}, {"far", static_cast<double>(far)}});
    s.json["against"] = {{"file", file}, {"compared", compared}, {"agreement", percent}, {"far", far}};
    return between("agreement with the file [%]", percent, 99.7, 100);
}

void print(const StateMap& map, const std::vector<Boundaries>& rows, StudyText& out)
{
    std::vector<Boundaries> some;
    for (size_t e = 0; e < rows.size(); e += std::max<size_t>(1, (rows.size() - 1) / 8))
        some.push_back(rows[e]);
    columns_of_boundaries.print(out, some);
    out << "\n" + io::counted(static_cast<long>(map.cells.size()), "run") + ":";
    for (size_t state = 0; state < state_names.size(); ++state)
        out << fmt::format(
            "{} {} {}", state == 0 ? "" : ",",
            those(map.cells, [&](const auto& cell) { return cell.state == static_cast<int>(state); }).size(),
            state_names[state]);
    out << '\n';
}

void incline_sweep(StudyContext& s)
{
    const GridOptions o = grid_options(s, 1e-4, 1, grids);
    StateMap map{.grid = o.grid, .cells = {}};
    std::vector<std::pair<double, double>> places;
    for (const double eta : o.grid.eta)
        for (const double angle : o.grid.angle) {
            map.cells.push_back({.eta = eta, .angle = angle});
            places.emplace_back(eta, angle);
        }
    // the largest rolling stiffness of the sweep
    scene(incline_of(map.at(o.grid.eta.size() - 1, 0), o.dissertation())).check(o.h);
    const std::string& file = s.against;
    if (!file.empty()) {
        const PublishedGrid published{
            file, "", {}, "the header row must contain slopes in degrees and the first column eta_r"};
        const std::vector<double> states = published.values(places);
        for (size_t k = 0; k < states.size(); ++k) map.cells[k].published = std::round(states[k]);
    }
    const long steps = std::max(1L, std::lround(o.end / o.h));
    s.pool(map.cells.size())
        .run([&](long k) { run(map.cells[k], o.dissertation(), o.h, steps); },
             [&](io::Archive& a, long k) { map.cells[k].transfer(a); });

    const std::vector<Boundaries> rows = boundaries(map);
    const Deviations d = deviations(rows);
    s.table = incline_columns.csv(map.cells);
    s.figures = {"incline-sweep.png"};
    s.text << fmt::format(
        "\nfinal state of a sphere pushed up an incline at 0.5 m/s, after {:g} s; {} friction, h = {:g} s\n",
        o.end, o.preset, o.h);
    print(map, rows, s.text);
    s.text << fmt::format(
        "boundary minus limit: rest {:+.2f} to {:+.2f} deg, rolling {:+.2f} to {:+.2f} "
        "deg; slip without rolling {}\n",
        d.rest.least, d.rest.most, d.rolling.least, d.rolling.most,
        std::isfinite(d.slip_from) ? fmt::format("from eta_r = {:.3f}", d.slip_from) : "does not occur");
    s.json.update({{"states", state_names},
                   {"rest_limit", d.rest.json()},
                   {"rolling_limit", d.rolling.json()},
                   {"slip_from", d.slip_from}});
    s.measure(s.name, {{"rest_limit", d.rest.largest()},
                       {"rolling_limit_least", d.rolling.least},
                       {"rolling_limit_most", d.rolling.most},
                       {"slip_from", d.slip_from}});
    std::vector<Criterion> checks = criteria(o.grid, d, o.dissertation());
    if (!file.empty()) checks.push_back(compare(s, map));
    if (s.check) s.evaluate(checks);
}

const bool registered_incline_sweep = io::Registry<Study>::add(
    {.name = "incline-sweep",
     .answers = "final state of a sphere pushed up an incline, over slope and rolling resistance (Fig. "
                "4.13); default "
                "preset: dissertation",
     .options = {"--steps", "--end", "--preset", "--against", "--grid", "--check", "--shard"},
     .keys = {"agreement", "far", "rest_limit", "rolling_limit_least", "rolling_limit_most", "slip_from"},
     .files = {"incline-sweep.png"},
     .run = incline_sweep});

}  // namespace

}  // namespace hilda::studies
