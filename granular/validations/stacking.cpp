// SPDX-License-Identifier: GPL-3.0-or-later
/// Critical mass of the upper sphere of a stack, over the coefficient of rolling friction.
///                                                                       Fang (2022), Fig. 7.7
///
/// The dissertation does not state the coefficient of friction. μ = 0.158 follows from the critical masses
/// for large μ_r, where the lower spheres slide and do not roll. These plateau values, for all five gaps, are
/// in the author's public data (GPU_postprocessing, pyramid_stack.csv) and are checked here.

#include "granular/validations/three_spheres.hpp"
#include "granular/validations/validation.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace hilda::granular {

namespace {

constexpr double mu = 0.158, inf = std::numeric_limits<double>::infinity();

struct RollingModel {
    std::string name;
    StackRun run;
    double lever_ground;  ///< lever of the rolling torque bound at the ground, over R; 1/2 between spheres
};
const std::array<RollingModel, 3> rolling_models = {
    RollingModel{"constant torque, R/2", {.rolling = StackRolling::half_radius}, 0.5},
    RollingModel{"EPSD, R/2", {.rolling = StackRolling::epsd, .ground = 0.5}, 0.5},
    RollingModel{"EPSD, R*", {.rolling = StackRolling::epsd}, 1}};

struct Plateau {
    double gap, mass;  ///< [kg]
};
constexpr std::array<Plateau, 5> expected_plateaus = {
    {{0.20, 1.00}, {0.25, 0.94}, {0.30, 0.90}, {0.35, 0.85}, {0.40, 0.81}}};

std::vector<double> all_mu_r(bool full)
{
    if (!full) return {0.07, 0.10, 0.13, 0.16, 0.20, 0.40};
    std::vector<double> all;
    for (int k = 7; k <= 20; ++k) all.push_back(k / 100.);
    all.insert(all.end(), {0.3, 0.4});
    return all;
}

/// Minimum that propagates NaN
double min_or_nan(double a, double b) { return -max_or_nan(-a, -b); }

/// One curve, critical mass over μ_r
struct Curve {
    std::vector<double> mu_r, mass;

    double plateau() const { return mass.back(); }
    /// μ_r at which the curve is 0.01 kg below its plateau, by linear interpolation
    double knee() const
    {
        const double level = plateau() - 0.01;
        for (std::size_t k = 1; k < mass.size(); ++k)
            if (mass[k] >= level && mass[k - 1] < level)
                return mu_r[k - 1] +
                       (mu_r[k] - mu_r[k - 1]) * (level - mass[k - 1]) / (mass[k] - mass[k - 1]);
        return mu_r.front();
    }
    /// Smallest increase between neighbouring points below the knee [kg]
    double least_rise() const
    {
        double least = mass[1] - mass[0];
        for (std::size_t k = 1; k < mass.size() && mu_r[k] <= knee(); ++k)
            least = min_or_nan(least, mass[k] - mass[k - 1]);
        return least;
    }
};

std::string of_gap(const std::string& what, double gap)
{
    return what + ", gap " + std::to_string(gap).substr(0, 4) + " R";
}

/// Coefficient of friction at which the interpolated critical mass is `mass`; NaN if it is not reached
double friction_at(const std::vector<double>& mus, const std::vector<double>& masses, double mass)
{
    for (std::size_t k = 1; k < mus.size(); ++k)
        if (masses[k] >= mass)
            return mus[k - 1] + (mus[k] - mus[k - 1]) * (mass - masses[k - 1]) / (masses[k] - masses[k - 1]);
    return std::nan("");
}

class Stacking {
public:
    explicit Stacking(const ValidationOptions& options)
        : options(options), mu_r(all_mu_r(options.full)), models(rolling_models)
    {
        for (RollingModel& m : models) {
            m.run.device = options.device;
            m.run.kept = options.kept;
            m.run.ended = [&options, name = m.name](const World& world) { options.include(name, world); };
        }
    }

    ValidationResult run()
    {
        for (const Plateau& p : expected_plateaus)
            if (options.full || std::lround(100 * p.gap) % 10 == 0) plateaus.push_back(p);
        find_masses();
        check_curves();
        find_friction();
        check_bisection();
        return {.tables = {study, friction}, .checks = checks};
    }

private:
    void find_masses()
    {
        std::vector<Stack> stacks;
        for (const Plateau& p : plateaus)
            for (const double r : mu_r) stacks.push_back({p.gap, mu, r});
        for (std::size_t m = 0; m < models.size(); ++m) {
            masses[m] = critical_masses(stacks, models[m].run,
                                        [&](double share) { options.progress(0.25 * (double(m) + share)); });
            for (std::size_t k = 0; k < stacks.size(); ++k) {
                const Stack& s = stacks[k];
                study.rows.push_back({models[m].name, s.gap, s.mu_r, s.mu, masses[m][k],
                                      static_limit(s, models[m].lever_ground, 0.5)});
            }
        }
    }

    Curve curve(std::size_t model, std::size_t gap) const
    {
        const auto first = masses[model].begin() + static_cast<std::ptrdiff_t>(gap * mu_r.size());
        return {mu_r, {first, first + static_cast<std::ptrdiff_t>(mu_r.size())}};
    }

    void check_curves()
    {
        double difference = 0, max_ratio = 0, increase = inf, min_ratio = inf;
        for (std::size_t k = 0; k < plateaus.size(); ++k) {
            const auto [gap, mass] = plateaus[k];
            const Curve c = curve(0, k), same = curve(1, k), longer = curve(2, k);
            checks.push_back({of_gap("plateau [kg]", gap), c.plateau(), 0.97 * mass, 1.03 * mass});
            checks.push_back({of_gap("mu_r of the knee", gap), c.knee(), 0.13, 0.17});
            checks.push_back(
                {of_gap("smallest increase below the knee [kg]", gap), c.least_rise(), 0.005, 1});
            increase = min_or_nan(increase, longer.mass[0] - c.mass[0]);
            for (std::size_t j = 0; j < mu_r.size(); ++j) {
                difference = max_or_nan(difference, std::abs(same.mass[j] - c.mass[j]));
                const double ratio = c.mass[j] / static_limit({gap, mu, mu_r[j]}, 0.5, 0.5);
                min_ratio = min_or_nan(min_ratio, ratio), max_ratio = max_or_nan(max_ratio, ratio);
            }
        }
        checks.push_back({"smallest mass over the static limit", min_ratio, 0.9, 1.05});
        checks.push_back({"largest mass over the static limit", max_ratio, 0.9, 1.05});
        checks.push_back(
            {"EPSD with R*: smallest increase of the mass at mu_r = 0.07 [kg]", increase, 0.01, 3});
        checks.push_back({"EPSD with the same bounds: largest difference [kg]", difference, 0, 0.0301});
    }

    void find_friction()
    {
        const std::vector<double> mus = {0.15, 0.155, 0.16, 0.165};
        std::vector<Stack> stacks;
        for (const Plateau& p : plateaus)
            for (const double m : mus) stacks.push_back({p.gap, m, 0.4});
        const std::vector<double> found = critical_masses(
            stacks, models[0].run, [&](double share) { options.progress(0.75 + 0.1 * share); });
        for (std::size_t k = 0; k < stacks.size(); ++k)
            friction.rows.push_back({stacks[k].gap, stacks[k].mu, found[k], static_limit(stacks[k], 0.5, 0.5),
                                     plateaus[k / mus.size()].mass});
        for (std::size_t k = 0; k < plateaus.size(); ++k) {
            const auto first = found.begin() + static_cast<std::ptrdiff_t>(k * mus.size());
            const double at =
                friction_at(mus, {first, first + static_cast<std::ptrdiff_t>(mus.size())}, plateaus[k].mass);
            checks.push_back({of_gap("mu at the plateau mass", plateaus[k].gap), at, 0.99 * mu, 1.01 * mu});
        }
    }

    /// Checks that masses above the critical mass collapse and masses below it do not, and that half the step
    /// gives the same critical mass within one increment.
    void check_bisection()
    {
        std::vector<Stack> stacks;
        std::vector<double> mass;
        int expected = 0, fell = 0;
        for (std::size_t k = 0; k < plateaus.size(); ++k)
            for (std::size_t j = 0; j < mu_r.size(); j += 2)
                for (const double off : {-0.1, -0.03, 0.02, 0.1}) {
                    stacks.push_back({plateaus[k].gap, mu, mu_r[j]});
                    mass.push_back(masses[0][k * mu_r.size() + j] + off);
                    expected += off > 0;
                }
        const std::vector<double> z = heights(stacks, mass, models[0].run);
        int wrong = 0;
        for (std::size_t k = 0; k < z.size(); ++k) {
            const bool collapsed = z[k] < collapse_height;
            fell += collapsed;
            wrong += collapsed != (k % 4 >= 2);
        }
        checks.push_back({"number of collapsed stacks", double(fell), double(expected), double(expected)});
        checks.push_back({"number of stacks on the wrong side of the critical mass", double(wrong), 0, 0});
        options.progress(0.9);

        StackRun finer = models[0].run;
        finer.h /= 2;
        const double coarse[] = {masses[0][1], masses[0][mu_r.size() - 1]};
        const std::vector<double> fine =
            critical_masses({{plateaus[0].gap, mu, mu_r[1]}, {plateaus[0].gap, mu, mu_r.back()}}, finer,
                            [&](double share) { options.progress(0.9 + 0.1 * share); });
        for (int k = 0; k < 2; ++k)
            checks.push_back(
                {std::string("change with half the step, ") + (k == 0 ? "rolling" : "sliding") + " [kg]",
                 std::abs(fine[k] - coarse[k]), 0, 0.0101});
    }

    const ValidationOptions& options;
    std::vector<double> mu_r;
    std::vector<Plateau> plateaus;
    std::array<RollingModel, 3> models;
    std::array<std::vector<double>, 3> masses;
    ValidationTable study{"study", {"rolling", "gap", "mu_r", "mu", "critical_mass", "static_limit"}, {}},
        friction{"friction", {"gap", "mu", "critical_mass", "static_limit", "required"}, {}};
    std::vector<ValidationCheck> checks;
};

const bool registered_stacking =
    io::Registry<Validation>::add({"stacking", "critical mass of the upper of three spheres (Fig. 7.7)",
                                   [](const ValidationOptions& options) { return Stacking(options).run(); }});

}  // namespace

}  // namespace hilda::granular
