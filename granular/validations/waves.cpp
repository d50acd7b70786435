// SPDX-License-Identifier: GPL-3.0-or-later
/// Response of the floor forces of a lattice to a point load on its top (Fang 2022, Figs. 7.9 and 7.10;
/// Goldenberg and Goldhirsch 2005, Nature 435, 188).
///
/// The dissertation gives a stiffness of 30000 mg/R, its author's program 3000 mg/R. The first value belongs
/// to the law scaled with √(δ/R), the second to the linear law. Both laws are computed.

#include "granular/validations/lattice.hpp"
#include "granular/validations/validation.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

namespace {

/// Largest load that is checked, over m g. Without friction a load of 300 m g pushes the sphere through the
/// layers.
constexpr double max_checked_force = 100;

std::string name_of(Stiffness s) { return s == Stiffness::scaled ? "scaled" : "linear"; }

double sum(const std::array<double, lattice::widest>& of)
{
    double all = 0;
    for (const double x : of) all += x;
    return all;
}

/// Profile of the increase of the floor forces, over F
struct Profile {
    LoadCase of;
    std::array<double, lattice::widest> share;  ///< by position
    double centre, peak,
        at;  ///< value at the middle; largest value within 20 spheres of it, and its distance in spheres
    double total;
    double asymmetry;  ///< largest difference between the two sides, over the peak
    double weight;     ///< floor force before the load, over the weight of the lattice
    double balance;    ///< forces of floor and sides over weight and load, minus 1

    Profile(const LoadCase& of, const LatticeResponse& p) : of(of), share(p.share(of.F))
    {
        const int c = lattice::middle;
        centre = peak = share[c], at = 0, asymmetry = 0;
        for (int k = 1; k <= c; ++k) {
            asymmetry = max_or_nan(asymmetry, std::abs(share[c + k] - share[c - k]));
            const double both = (share[c + k] + share[c - k]) / 2;
            if (k <= 20 && both > peak) peak = both, at = k;
        }
        asymmetry /= peak;
        total = sum(share);
        weight = sum(p.before.floor) / lattice::spheres;
        balance = (sum(p.after.floor) + p.after.upper_layers + p.after.sides) / (lattice::spheres + of.F) - 1;
    }
};

std::string named(const std::string& what, const LoadCase& of)
{
    return what + ", " + name_of(of.stiffness) + ", mu = " + std::to_string(of.mu).substr(0, 3) +
           ", F = " + std::to_string(std::lround(of.F)) + " mg";
}

std::vector<LoadCase> load_cases(bool full)
{
    const std::vector<double> forces =
        full ? std::vector<double>{5, 10, 20, 50, 100, 150} : std::vector<double>{5, 20};
    std::vector<LoadCase> all;
    for (const Stiffness s : {Stiffness::scaled, Stiffness::linear})
        for (const double mu : {0., 0.1, 0.2})
            for (const double F : forces) all.push_back({s, mu, F});
    return all;
}

const Profile& find(const std::vector<Profile>& all, Stiffness s, double mu, double F)
{
    return *std::find_if(all.begin(), all.end(), [&](const Profile& p) {
        return p.of.stiffness == s && p.of.mu == mu && p.of.F == F;
    });
}

std::vector<ValidationCheck> check(const std::vector<Profile>& all)
{
    std::vector<ValidationCheck> checks;
    double total = 0, weight = 0, asymmetry = 0, balance = 0;
    for (const Profile& p : all) {
        if (p.of.F > max_checked_force) continue;
        total = max_or_nan(total, std::abs(p.total - 1)), weight = max_or_nan(weight, std::abs(p.weight - 1));
        asymmetry = max_or_nan(asymmetry, p.asymmetry), balance = max_or_nan(balance, std::abs(p.balance));
    }
    checks.push_back({"increase of the floor force over F, less 1", total, 0, 0.015});
    checks.push_back({"floor force without load over the weight, less 1", weight, 0, 0.002});
    checks.push_back({"forces of floor and sides over weight and F, less 1", balance, 0, 2e-4});
    checks.push_back({"asymmetry over the peak", asymmetry, 0, 0.02});
    for (const Stiffness s : {Stiffness::scaled, Stiffness::linear}) {
        const Profile& rough = find(all, s, 0.2, 5);
        checks.push_back({named("distance of the peak from the middle", rough.of), rough.at, 0, 1});
        checks.push_back({named("peak", rough.of), rough.peak, 0.06, 0.07});
        const Profile &smooth = find(all, s, 0, 20), &between = find(all, s, 0.1, 20),
                      &rougher = find(all, s, 0.2, 20);
        for (const double F : {5., 20.}) {
            const Profile& p = find(all, s, 0, F);
            checks.push_back({named("middle", p.of), p.centre, -1, 0.03});
            checks.push_back({named("distance of the peak from the middle", p.of), p.at, 5, 7});
        }
        checks.push_back(
            {named("middle, increase over mu = 0", between.of), between.centre - smooth.centre, 1e-3, 1});
        checks.push_back(
            {named("middle, increase over mu = 0.1", rougher.of), rougher.centre - between.centre, 1e-3, 1});
    }
    return checks;
}

ValidationResult waves(const ValidationOptions& options)
{
    const std::vector<LoadCase> of = load_cases(options.full);
    LatticeRun run{.h = 5e-5,  // 2e-5 s changes the shares by 2e-4 at most
                   .device = options.device,
                   .ended = [&](const World& world) { options.include("all lattices", world); },
                   .kept = options.kept};
    if (!options.full) run.ramp = 0.5;
    std::vector<LatticeResponse> pressed;
    options.kept.part([&] { pressed = run_lattices(of, run, options.progress); },
                      [&](io::Archive& a) { a.list(pressed); });

    ValidationTable study{
        "study",
        {"stiffness", "mu", "F", "centre", "peak", "distance", "floor", "sides", "asymmetry", "weight",
         "kinetic_before", "kinetic_after", "settled", "held", "sunk"},
        {}},
        profiles{"profiles", {"stiffness", "mu", "F", "position", "share", "weight"}, {}};
    std::vector<Profile> all;
    for (std::size_t n = 0; n < of.size(); ++n) {
        const LatticeResponse& now = pressed[n];
        const Profile& p = all.emplace_back(of[n], now);
        const std::string name = name_of(of[n].stiffness);
        study.rows.push_back({name, of[n].mu, of[n].F, p.centre, p.peak, p.at, p.total,
                              (now.after.sides - now.before.sides) / of[n].F, p.asymmetry, p.weight,
                              now.before.kinetic, now.after.kinetic, now.settled, now.held,
                              now.displacement});
        for (int k = 0; k < lattice::widest; ++k)
            profiles.rows.push_back(
                {name, of[n].mu, of[n].F, double(k - lattice::middle), p.share[k], now.before.floor[k]});
    }
    return {.tables = {study, profiles}, .checks = check(all)};
}

const bool registered_waves = io::Registry<Validation>::add(
    {"waves", "floor forces of a lattice of spheres under a point load (Figs. 7.9, 7.10)", waves});

}  // namespace

}  // namespace hilda::granular
