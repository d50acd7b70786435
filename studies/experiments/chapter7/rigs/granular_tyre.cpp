// SPDX-License-Identifier: GPL-3.0-or-later
/// Study granular-tyre: a single-wheel rig with a toroidal tyre on a bed of grains (Fang 2022, Sec. 7.2.6),
/// as a mechanism in co-simulation.
///
/// A carriage slides along a rail, a fork slides vertically on the carriage, and the tyre turns in the fork.
/// With imposed slip s the carriage and the axle are driven, v = ω r (1 - s). With free slip a motor with the
/// torque T_0 - c ω drives the axle, and nothing draws the carriage.
///
///     pull   = mean horizontal force of the grains on the tyre (DBP)
///     torque = mean driving torque of the axle
///     sinkage = z_init - (z - r), z_init the highest point of the settled bed              Fang (2022), Eq. 7.7
///     power  = torque ω - pull v, which is dissipated in the bed

#include "io/archive.hpp"
#include "studies/experiments/chapter7/rigs/rig.hpp"
#include "studies/framework/columns.hpp"
#include "studies/framework/study_context.hpp"

#include <fmt/format.h>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace hilda::studies {

namespace {

constexpr double g = 9.81, radius = 0.13,
                 tube = 0.035;          ///< of the tyre at its outer equator, of its tube [m]
constexpr double load = 10, omega = 1;  ///< weight of fork and tyre [N], imposed [rad/s]
constexpr double motor_torque = 1.7, motor_damping = 1.5;  ///< T_0 [N m], c [N m s]
constexpr long beds = 4;  ///< in which each test is run, with other random numbers
constexpr double start_x = 0.15, resting = 0.3, ramp = 0.1;  ///< [m], [s], [s]

struct TyreTest {
    double slip = 0;  ///< imposed; NaN: free slip
    double mu_r = 0.2;

    bool is_free() const { return std::isnan(slip); }
    std::string name() const
    {
        const std::string of = is_free() ? "free slip" : fmt::format("slip {:g}", slip);
        return mu_r > 0 ? of : of + " without rolling friction";
    }
};

struct Grid {
    std::string name;
    double length, width, duration;  ///< of the bed [m], of the motion [s]
    std::vector<TyreTest> tests;
};

const double none = std::nan("");

const std::vector<Grid> grids = {
    {"quick", 0.6, 0.14, 1.5, {{-0.3}, {0}, {0.3}, {0.6}, {0.3, 0}, {none}}},
    {"full",
     0.9,
     0.2,
     3,
     {{-0.5}, {-0.3}, {-0.1}, {0}, {0.1}, {0.3}, {0.5}, {0.7}, {0, 0}, {0.3, 0}, {0.7, 0}, {none}}}};

struct Result {
    TyreTest test;
    double slip = 0, v = 0, omega = 0;             ///< measured; [m/s], [rad/s]
    double pull = 0, load = 0, torque = 0;         ///< [N], [N], [N m]
    double sinkage = 0;                            ///< [m]
    double power = 0, energy_error = 0, work = 0;  ///< [W], [J], [J] on the grains from the start
    double pull_error = 0, torque_error = 0;       ///< standard errors of the means over the beds
    /// Rows t, pull, load, torque, sinkage: means over 0.05 s; rows x, z, speed of a grain and x, z of the
    /// axle at the end
    std::vector<double> motion = {}, grains = {};
};

void transfer(io::Archive& a, Result& r)
{
    for (double* x : {&r.slip, &r.v, &r.omega, &r.pull, &r.load, &r.torque, &r.sinkage, &r.power,
                      &r.energy_error, &r.work})
        a.value(*x);
    a.list(r.motion), a.list(r.grains);
}

/// Means of a test over its beds; the energy error of the largest magnitude; motion and grains of the first
/// bed
Result pooled(const std::vector<Result>& of_beds)
{
    constexpr double n = beds;
    const auto mean = [&](double Result::*x) {
        double sum = 0;
        for (const Result& r : of_beds) sum += r.*x;
        return sum / n;
    };
    const auto error = [&](double Result::*x) {
        double squares = 0;
        for (const Result& r : of_beds) squares += std::pow(r.*x - mean(x), 2);
        return std::sqrt(squares / (n * (n - 1)));
    };
    Result all = of_beds.front();
    for (double Result::*x : {&Result::slip, &Result::v, &Result::omega, &Result::pull, &Result::load,
                              &Result::torque, &Result::sinkage, &Result::power, &Result::work})
        all.*x = mean(x);
    for (const Result& r : of_beds)
        if (!(std::abs(r.energy_error) <= std::abs(all.energy_error))) all.energy_error = r.energy_error;
    all.pull_error = error(&Result::pull), all.torque_error = error(&Result::torque);
    return all;
}

/// Integral of a formula that rises linearly from 0 to 1 between `resting` and `resting + ramp`
std::string distance()
{
    const std::string s = fmt::format("min(max((t-{})/{},0),1)", resting, ramp);
    return fmt::format("({}*({})^2/2+max(t-{},0))", ramp, s, resting + ramp);
}

io::Json model(const TyreTest& test, const RigBed& bed, double axle, double end)
{
    const double y = bed.width / 2, above = 0.3, m_fork = 0.2 * load / g, m = 0.8 * load / g;
    const double J = 0.6 * m * radius * radius;
    const io::Json along_x = {1, 0, 0}, along_y = {0, 1, 0}, along_z = {0, 0, 1};
    io::Json constraints = {{{"name", "rail"},
                             {"type", "translational"},
                             {"body_i", "ground"},
                             {"body_j", "carriage"},
                             {"s_bar_p_i", {0, y, axle + above}},
                             {"axis_bar_i", along_x},
                             {"axis_bar_j", along_x}},
                            {{"name", "slider"},
                             {"type", "translational"},
                             {"body_i", "carriage"},
                             {"body_j", "fork"},
                             {"s_bar_p_i", {0, 0, -above}},
                             {"axis_bar_i", along_z},
                             {"axis_bar_j", along_z}},
                            {{"name", "axle"},
                             {"type", "revolute"},
                             {"body_i", "fork"},
                             {"body_j", "tyre"},
                             {"axis_bar_i", along_y},
                             {"axis_bar_j", along_y}}};
    io::Json forces = io::Json::array();
    if (test.is_free()) {
        const std::string torque = fmt::format("{}*min(max((t-{})/{},0),1)", motor_torque, resting, ramp);
        forces = {{{"name", "motor"},
                   {"type", "torque"},
                   {"body", "tyre"},
                   {"frame", "global"},
                   {"components", {0, torque, 0}}},
                  {{"name", "speed"},
                   {"type", "torsion-spring"},
                   {"body_i", "fork"},
                   {"body_j", "tyre"},
                   {"axis_bar_i", along_y},
                   {"axis_bar_j", along_y},
                   {"stiffness", 0},
                   {"damping", motor_damping},
                   {"free_angle", 0}}};
    } else {
        const double v = omega * radius * (1 - test.slip);
        constraints.push_back({{"name", "tow"},
                               {"type", "CD"},
                               {"body_i", "ground"},
                               {"body_j", "carriage"},
                               {"c", along_x},
                               {"f", fmt::format("{}+{}*{}", start_x, v, distance())}});
        constraints.push_back({{"name", "motor"},
                               {"type", "hinge-driver"},
                               {"body_i", "fork"},
                               {"body_j", "tyre"},
                               {"axis_bar_i", along_y},
                               {"axis_bar_j", along_y},
                               {"angle", fmt::format("{}*{}", omega, distance())}});
    }
    const io::Json at_axle = {start_x, y, axle};
    return {{"hilda_model", 1},
            {"name", "single-wheel rig"},
            {"gravity", {0, 0, -g}},
            {"end", end},
            {"bodies",
             {{{"name", "carriage"},
               {"mass", 1},
               {"inertia", {0.01, 0.01, 0.01}},
               {"r", {start_x, y, axle + above}}},
              {{"name", "fork"}, {"mass", m_fork}, {"inertia", {0.01, 0.01, 0.01}}, {"r", at_axle}},
              {{"name", "tyre"}, {"mass", m}, {"inertia", {0.5 * J, J, 0.5 * J}}, {"r", at_axle}}}},
            {"constraints", constraints},
            {"forces", forces}};
}

/// The torus, of 48 × 24 quadrilaterals
io::Json tyre(const RigBed& bed, double axle)
{
    constexpr int around = 24;
    io::Json::List profile;
    for (int k = 0; k <= around; ++k) {
        const double angle = -2 * std::numbers::pi * (k % around) / around;
        profile.push_back(io::Json::List{radius - tube + tube * std::cos(angle), tube * std::sin(angle)});
    }
    return {{"name", "tyre"},
            {"type", "mesh"},
            {"lathe", {{"profile", profile}, {"segments", 48}}},
            {"rotation", {-0.5 * std::numbers::pi, 0, 0}},
            {"r", {start_x, bed.width / 2, axle}}};
}

Result measure(const TyreTest& test, const RigRun& run, double top, double from)
{
    const auto mean = [&](const char* column) { return run.mean(std::string("tyre.") + column, from); };
    const std::vector<double> t = run.tools.values("t"), x = run.tools.values("tyre.x");
    std::size_t first = 0;
    while (!(t[first] > from)) ++first;
    Result r{.test = test};
    r.v = (x.back() - x[first]) / (t.back() - t[first]);
    r.pull = mean("Fx"), r.load = mean("Fz"), r.torque = -mean("Ty");
    r.omega = omega;
    if (test.is_free())
        r.omega = (motor_torque - r.torque) / motor_damping;  // of the motor, without acceleration
    r.slip = 1 - r.v / (r.omega * radius);
    r.sinkage = top - (mean("z") - radius);
    r.power = r.torque * r.omega - r.pull * r.v;
    r.energy_error = run.last("tyre.energy_error"), r.work = run.work_on_grains;
    const std::vector<double> Fx = run.tools.values("tyre.Fx"), Fz = run.tools.values("tyre.Fz"),
                              Ty = run.tools.values("tyre.Ty"), z = run.tools.values("tyre.z");
    constexpr double bin = 0.05;  // [s]
    for (std::size_t k = 0; k < t.size();) {
        const double end = bin * (std::floor(t[k] / bin + 1e-9) + 1);
        double sum[4] = {}, count = 0;
        for (; k < t.size() && t[k] < end - 1e-9; ++k, count += 1)
            sum[0] += Fx[k], sum[1] += Fz[k], sum[2] -= Ty[k], sum[3] += top - (z[k] - radius);
        r.motion.push_back(end);
        for (const double of : sum) r.motion.push_back(of / count);
    }
    for (std::size_t k = 0; k < run.x.size(); ++k)
        r.grains.insert(r.grains.end(), {run.x[k], run.z[k], run.speed[k], x.back(), z.back()});
    return r;
}

const Columns<Result> columns{{{"slip", "slip", "{:.3f}", [](const Result& r) { return r.slip; }},
                               {"imposed", [](const Result& r) { return r.test.is_free() ? 0L : 1L; }},
                               {"mu_r", "mu_r", "{:.2g}", [](const Result& r) { return r.test.mu_r; }},
                               {"v", "v [m/s]", "{:.4f}", &Result::v},
                               {"omega", "omega [rad/s]", "{:.3f}", &Result::omega},
                               {"pull", "pull [N]", "{:.3f}", &Result::pull},
                               {"pull_error", "+- [N]", "{:.2f}", &Result::pull_error},
                               {"load", "load [N]", "{:.3f}", &Result::load},
                               {"torque", "torque [N m]", "{:.4f}", &Result::torque},
                               {"torque_error", "+- [N m]", "{:.3f}", &Result::torque_error},
                               {"sinkage", "sinkage [m]", "{:.4f}", &Result::sinkage},
                               {"power", "power [W]", "{:.4f}", &Result::power},
                               {"work", "work [J]", "{:.4f}", &Result::work},
                               {"energy_error", "error [J]", "{:.1e}", &Result::energy_error}}};

/// Slip at which the line through the points (slip, y) is zero for the first time; NaN if it is nowhere
double zero(const std::vector<double>& slip, const std::vector<double>& y)
{
    for (std::size_t k = 1; k < y.size(); ++k)
        if (y[k - 1] < 0 && y[k] >= 0)
            return slip[k - 1] - y[k - 1] * (slip[k] - slip[k - 1]) / (y[k] - y[k - 1]);
    return std::nan("");
}

/// Value at a slip of the line through the points (slip, y)
double value_at(double at, const std::vector<double>& slip, const std::vector<double>& y)
{
    for (std::size_t k = 1; k < y.size(); ++k)
        if (slip[k - 1] <= at && at <= slip[k])
            return y[k - 1] + (at - slip[k - 1]) / (slip[k] - slip[k - 1]) * (y[k] - y[k - 1]);
    return std::nan("");
}

/// The parabola a x² + b x + c through points (x, y) by least squares, which averages their scatter
struct Parabola {
    Parabola(const std::vector<double>& x, const std::vector<double>& y)
    {
        Eigen::MatrixX3d powers(x.size(), 3);
        for (Eigen::Index k = 0; k < powers.rows(); ++k) {
            const double of = x[static_cast<std::size_t>(k)];
            powers.row(k) << of * of, of, 1;
        }
        const Eigen::Map<const Eigen::VectorXd> values(y.data(), powers.rows());
        const Eigen::Vector3d all = powers.colPivHouseholderQr().solve(values);
        a = all[0], b = all[1], c = all[2];
    }
    double vertex() const { return -b / (2 * a); }
    /// The zero at which it rises; NaN if there is none
    double rising_zero() const { return 2 * c / (-b - std::sqrt(b * b - 4 * a * c)); }

    double a = 0, b = 0, c = 0;
};

std::vector<Criterion> criteria(const std::vector<Result>& results)
{
    std::vector<double> slip, pull, torque, sinkage;
    double load_error = 0, least_power = std::numeric_limits<double>::infinity(), mismatch = 0;
    double smooth_sinkage = 0, smooth_pull = 0, rough_sinkage = 0, rough_pull = 0;
    Result free;
    for (const Result& r : results) {
        load_error = std::max(load_error, std::abs(r.load / load - 1));
        least_power = std::min(least_power, r.power);
        mismatch = std::max(mismatch, std::abs(r.energy_error / r.work));
        if (r.test.is_free())
            free = r;
        else if (r.test.mu_r > 0)
            slip.push_back(r.test.slip), pull.push_back(r.pull), torque.push_back(r.torque),
                sinkage.push_back(r.sinkage);
    }
    double least_rise = std::numeric_limits<double>::infinity(), least_torque_rise = least_rise;
    for (std::size_t k = 1; k < slip.size(); ++k) {
        least_rise = std::min(least_rise, pull[k] - pull[k - 1]);
        least_torque_rise = std::min(least_torque_rise, torque[k] - torque[k - 1]);
    }
    for (const Result& r : results) {
        if (r.test.is_free() || r.test.mu_r > 0) continue;
        smooth_sinkage += r.sinkage, smooth_pull += r.pull;
        rough_sinkage += value_at(r.test.slip, slip, sinkage),
            rough_pull += value_at(r.test.slip, slip, pull);
    }
    const Parabola of_pull(slip, pull), of_sinkage(slip, sinkage);
    constexpr double infinite = std::numeric_limits<double>::infinity();
    return {
        between("smallest rise of the pull from one slip to the next [N]", least_rise, 0, infinite),
        between("slip at which the pull changes sign", zero(slip, pull), -0.1, 0.3),
        between("smallest rise of the torque from one slip to the next [N m]", least_torque_rise, 0,
                infinite),
        between("slip of the least sinkage, of the parabola by least squares", of_sinkage.vertex(), -0.3,
                0.3),
        between("sinkage at the largest slip over that at 0", sinkage.back() / value_at(0, slip, sinkage), 1,
                2),
        between("largest difference of the vertical force and the load, relative", load_error, 0, 0.02),
        between("least power torque omega - pull v [W]", least_power, 0, infinite),
        between("sinkage without rolling friction over that with it", smooth_sinkage / rough_sinkage, 1, 3),
        between("pull without rolling friction minus that with it [N]", smooth_pull - rough_pull, -infinite,
                0),
        between("pull with free slip [N]", free.pull, -0.05 * load, 0.05 * load),
        between("free slip minus the imposed slip without pull, of the parabola by least squares",
                free.slip - of_pull.rising_zero(), -0.1, 0.1),
        between("largest energy error over the work on the grains", mismatch, 0, 0.02)};
}

void run_study(StudyContext& s)
{
    const Grid& grid = one_of_list("--grid", s.grid, grids);
    s.json["grid"] = grid.name;
    const RigBed soil{.length = grid.length,
                      .width = grid.width,
                      .depth = 0.105,
                      .R = 7.5e-3,
                      .k = 1e6,
                      .h = 5e-5,
                      .periodic = true};
    constexpr long substeps = 4;
    Rigs rigs(s);
    const double end = resting + grid.duration, from = resting + 0.5 * grid.duration;
    std::vector<double> top(beds);
    const auto bed_number = [&](long number) {
        RigBed bed = soil;
        bed.number = number + 1;
        return bed;
    };
    const auto settle = [&] {
        for (long k = 0; k < beds; ++k) top[static_cast<std::size_t>(k)] = rigs.settle(bed_number(k));
    };
    s.job(settle, [&](io::Archive& a) { a.list(top); });
    std::vector<std::vector<Result>> runs(grid.tests.size());
    for (std::vector<Result>& of_beds : runs) of_beds.resize(top.size());
    const auto run_of = [&](long k) -> Result& {
        return runs[static_cast<std::size_t>(k / beds)][static_cast<std::size_t>(k % beds)];
    };
    const auto job = [&](long k) {
        const TyreTest test = grid.tests[static_cast<std::size_t>(k / beds)];
        RigBed bed = bed_number(k % beds);
        bed.mu_r = test.mu_r;
        const double highest = top[static_cast<std::size_t>(k % beds)], axle = highest + radius + 1e-3;
        io::Json pair;
        pair["body"] = "tyre";
        const RigRun run =
            rigs.run(fmt::format("{} bed {}", test.name(), bed.number), bed, model(test, bed, axle, end),
                     io::Json::List{tyre(bed, axle)}, pair, substeps, end);
        run_of(k) = measure(test, run, highest, from);
    };
    s.jobs(static_cast<long>(runs.size()) * beds, job,
           [&](io::Archive& a, long k) { transfer(a, run_of(k)); });
    std::vector<Result> results;
    for (std::size_t k = 0; k < runs.size(); ++k) {
        for (Result& r : runs[k]) r.test = grid.tests[k];
        results.push_back(pooled(runs[k]));
    }
    Table motion({{"slip"}, {"imposed"}, {"mu_r"}, {"t"}, {"pull"}, {"load"}, {"torque"}, {"sinkage"}}),
        grains({{"slip"}, {"imposed"}, {"mu_r"}, {"x"}, {"z"}, {"speed"}, {"tyre_x"}, {"tyre_z"}});
    for (const Result& r : results) {
        const std::vector<Table::Cell> key = {r.slip, r.test.is_free() ? 0L : 1L, r.test.mu_r};
        add_rows(motion, key, r.motion, 5), add_rows(grains, key, r.grains, 5);
    }
    s.files = {{"motion.csv", motion.csv()}, {"grains.csv", grains.csv()}};
    s.table = columns.csv(results);
    s.text << "A tyre of " << radius << " m on a bed of grains, load " << load << " N\n\n";
    columns.print(s.text, results);
    s.evaluate(criteria(results));
    s.figures = {s.name + ".png"};
}

const bool registered_granular_tyre = io::Registry<Study>::add(
    {.name = "granular-tyre",
     .answers = "single-wheel rig with a tyre, imposed and free slip, in co-simulation (Figs. 7.20, 7.25)",
     .options = {"--check", "--grid", "--shard"},
     .files = {"motion.csv", "grains.csv", "granular-tyre.png"},
     .run = run_study});

}  // namespace

}  // namespace hilda::studies
